"""Arithmetic on short rows, ``out[i, :] += factor other[j, :]`` in one operation, and on small matrices.

A loop over ``range(dim)`` costs 1.3 to 2 times as much: numba multiplies by a row length that is known at run
time alone, checks indices, and leaves components in separate registers. Here a row is one vector, of the
length of a tuple. ``out`` and ``other`` are C-contiguous, of shape ``(n, len(spacing))``. Determinant and
inverse are written out: a library call costs more than the arithmetic.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.np import arrayobj

from mpmfw.kernels._jit import device, intrinsic
from mpmfw.kernels.types import Float, Floats

_arrayobj: Any = arrayobj  # numba has no annotations here


def _row_pointer(
    context: Any, builder: Any, array_type: Any, array: Any, index_type: Any, index: Any, width: int
) -> Any:
    """Address of row ``index``, as one vector."""
    data = _arrayobj.make_array(array_type)(context, builder, array).data
    first = builder.mul(
        context.cast(builder, index, index_type, types.intp), ir.Constant(ir.IntType(64), width)
    )
    return builder.bitcast(builder.gep(data, [first]), ir.VectorType(ir.DoubleType(), width).as_pointer())


def _repeated(builder: Any, value: Any, width: int) -> Any:
    """``value`` in every component of a vector."""
    vector = ir.Constant(ir.VectorType(ir.DoubleType(), width), ir.Undefined)
    for lane in range(width):
        vector = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), lane))
    return vector


def _emit(context: Any, builder: Any, signature: Any, args: Any, *, accumulate: bool) -> Any:
    """Code of both operations."""
    width = len(signature.args[5])
    target = _row_pointer(context, builder, signature.args[0], args[0], signature.args[1], args[1], width)
    source = _row_pointer(context, builder, signature.args[3], args[3], signature.args[4], args[4], width)
    factor = context.cast(builder, args[2], signature.args[2], types.float64)
    value = builder.fmul(_repeated(builder, factor, width), builder.load(source, align=8))
    if accumulate:
        value = builder.fadd(builder.load(target, align=8), value)
    builder.store(value, target, align=8)
    return context.get_dummy_value()


def _check(out: Any, other: Any) -> None:
    """Refuse arrays whose rows are not contiguous doubles."""
    for array in (out, other):
        if not (isinstance(array, types.Array) and array.layout == "C" and array.dtype == types.float64):
            raise TypeError(f"rows of {array}: expected a C-contiguous array of float64")


@intrinsic
def add_scaled_row(_typing: Any, out: Any, i: Any, factor: Any, other: Any, j: Any, spacing: Any) -> Any:
    """``out[i, :] += factor * other[j, :]``; the length of ``spacing`` is that of a row.

    ``out`` and ``other`` are of shape (n, dim), ``i`` and ``j`` not negative. An array that is not
    C-contiguous or not of float64 is a ``TypeError`` at compilation."""
    _check(out, other)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _emit(context, builder, signature, args, accumulate=True)

    return types.void(out, i, factor, other, j, spacing), codegen


@intrinsic
def set_scaled_row(_typing: Any, out: Any, i: Any, factor: Any, other: Any, j: Any, spacing: Any) -> Any:
    """``out[i, :] = factor * other[j, :]``; the length of ``spacing`` is that of a row.

    ``out`` and ``other`` are of shape (n, dim), ``i`` and ``j`` not negative. An array that is not
    C-contiguous or not of float64 is a ``TypeError`` at compilation."""
    _check(out, other)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _emit(context, builder, signature, args, accumulate=False)

    return types.void(out, i, factor, other, j, spacing), codegen


@device
def determinant(a: Floats, spacing: tuple[float, ...]) -> Float:
    """det a; the length of ``spacing`` is the dimension."""
    if len(spacing) == 2:
        return a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    return (
        a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
        - a[0, 1] * (a[1, 0] * a[2, 2] - a[1, 2] * a[2, 0])
        + a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0])
    )


@device
def invert(a: Floats, out: Floats, spacing: tuple[float, ...]) -> Float:
    """Write a⁻¹ to ``out`` and return det a; a singular matrix gives inf or nan, as in NumPy."""
    det = determinant(a, spacing)
    if len(spacing) == 2:
        out[0, 0] = a[1, 1] / det
        out[0, 1] = -a[0, 1] / det
        out[1, 0] = -a[1, 0] / det
        out[1, 1] = a[0, 0] / det
    else:
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            for m in range(3):
                n, o = (m + 1) % 3, (m + 2) % 3
                out[m, i] = (a[j, n] * a[k, o] - a[j, o] * a[k, n]) / det
    return det
