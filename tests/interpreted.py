"""Kernels as Python runs them, with constants other than those that numba has compiled."""

import functools
from types import FunctionType, SimpleNamespace

import numpy as np

from mpmfw.kernels import arithmetic, scratch

#: What :mod:`mpmfw.kernels.scratch` gives on the stack; NaN until it is written.
ON_THE_HEAP = SimpleNamespace(
    vector=lambda like: np.full(len(like), np.nan),
    integers=lambda like: np.full(len(like), -(2**62)),
    matrix=lambda rows, columns: np.full((len(rows), len(columns)), np.nan),
)


def _set_scaled_row(out, i, factor, other, j, _spacing):
    out[i] = factor * other[j]


def _add_scaled_row(out, i, factor, other, j, _spacing):
    out[i] += factor * other[j]


def _add_outer_product(out, a, i, b, j, _spacing):
    out += np.outer(a[i], b[j])


def _divide(out, number, _spacing):
    out /= number


def _multiply_by_hats(out, factor, at, d, node, spacing):
    corners = slice(2 ** len(spacing))
    out[corners] = factor[corners] * np.maximum(1.0 - np.abs(at[d, corners] - node), 0.0)


#: In place of what emits its own code.
IN_PYTHON = [
    (scratch, ON_THE_HEAP),
    (arithmetic.set_scaled_row, _set_scaled_row),
    (arithmetic.add_scaled_row, _add_scaled_row),
    (arithmetic.add_outer_product, _add_outer_product),
    (arithmetic.divide, _divide),
    (arithmetic.multiply_by_hats, _multiply_by_hats),
]


def interpreted(kernel, **constants):
    """The function that was compiled to ``kernel``, and all that it calls, with these constants in place of
    the modules' own.

    Slow: for a few dozen points. Division by zero gives inf, as in kernels.
    """
    made = {}
    met = set()

    def in_python(compiled):
        function = compiled.py_func
        if function not in made:
            names = dict(function.__globals__)
            made[function] = FunctionType(
                function.__code__, names, function.__name__, function.__defaults__, function.__closure__
            )
            for name in function.__code__.co_names:
                if name not in names:
                    continue
                value = names[name]
                if name in constants:
                    names[name] = constants[name]
                    met.add(name)
                elif hasattr(value, "py_func"):
                    names[name] = in_python(value)
                else:
                    names[name] = next((other for one, other in IN_PYTHON if value is one), value)
        return made[function]

    function = in_python(kernel)
    assert met == set(constants), f"{kernel.__name__} reads none of {set(constants) - met}"

    @functools.wraps(kernel.py_func)
    def call(*arguments):
        with np.errstate(all="ignore"):
            return function(*arguments)

    return call
