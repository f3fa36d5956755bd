"""Arithmetic on short rows, ``out[i, :] += factor other[j, :]`` in one operation, and on small matrices.

A loop over ``range(dim)`` costs 1.3 to 2 times as much: numba multiplies by a row length that is known at run
time alone, checks indices, and leaves components in separate registers. Here a row is one vector, of the
length of a tuple. ``out`` and ``other`` are C-contiguous, of shape ``(n, len(spacing))``. Determinant and
inverse are written out: a library call costs more than the arithmetic.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, types
from numba.np import arrayobj

from mpmfw.kernels._jit import device, intrinsic
from mpmfw.kernels.types import Float, Floats

_arrayobj: Any = arrayobj  # numba has no annotations here
_cgutils: Any = cgutils
_INT = ir.IntType(64)


def _row_at(context: Any, builder: Any, signature: Any, args: Any, k: int, index: Any, width: int) -> Any:
    """Address of row ``index`` of array ``args[k]``, as one vector."""
    data = _arrayobj.make_array(signature.args[k])(context, builder, args[k]).data
    first = builder.mul(index, _INT(width))
    return builder.bitcast(builder.gep(data, [first]), ir.VectorType(ir.DoubleType(), width).as_pointer())


def _row_of(context: Any, builder: Any, signature: Any, args: Any, k: int, width: int) -> Any:
    """Address of row ``args[k + 1]`` of array ``args[k]``."""
    index = context.cast(builder, args[k + 1], signature.args[k + 1], types.intp)
    return _row_at(context, builder, signature, args, k, index, width)


def _repeated(builder: Any, value: Any, width: int) -> Any:
    """``value`` in every component of a vector."""
    vector = ir.Constant(ir.VectorType(ir.DoubleType(), width), ir.Undefined)
    for lane in range(width):
        vector = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), lane))
    return vector


def of_floats(builder: Any, operation: str, *values: Any) -> Any:
    """One of LLVM's own operations on floats, or on vectors of the same length."""
    kind = values[0].type
    length = f"v{kind.count}" if isinstance(kind, ir.VectorType) else ""
    signature = ir.FunctionType(kind, [kind] * len(values))
    name = f"llvm.{operation}.{length}f64"
    return builder.call(_cgutils.get_or_insert_function(builder.module, signature, name), values)


def fused(builder: Any, a: Any, b: Any, c: Any) -> Any:
    """``a * b + c`` of vectors, in one operation where the processor has it."""
    return of_floats(builder, "fmuladd", a, b, c)


def _emit(context: Any, builder: Any, signature: Any, args: Any, *, accumulate: bool) -> Any:
    """Code of both operations."""
    width = len(signature.args[5])
    target = _row_of(context, builder, signature, args, 0, width)
    source = _row_of(context, builder, signature, args, 3, width)
    factor = context.cast(builder, args[2], signature.args[2], types.float64)
    factors, values = _repeated(builder, factor, width), builder.load(source, align=8)
    if accumulate:
        value = fused(builder, factors, values, builder.load(target, align=8))
    else:
        value = builder.fmul(factors, values)
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


def _chosen(builder: Any, vector: Any, components: list[int]) -> Any:
    """Vector of some components of another."""
    mask = ir.Constant(ir.VectorType(ir.IntType(32), len(components)), components)
    return builder.shuffle_vector(vector, vector, mask)


@intrinsic
def add_outer_product(_typing: Any, out: Any, a: Any, i: Any, b: Any, j: Any, spacing: Any) -> Any:
    """``out[d, e] += a[i, d] * b[j, e]``: in the plane the whole matrix in one operation, in space a row.

    ``out`` is of shape (dim, dim), all else as in :func:`add_scaled_row`."""
    _check(out, a)
    _check(out, b)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        dim = len(signature.args[5])
        rows = 2 if dim == 2 else 1
        left, right = (
            builder.load(_row_of(context, builder, signature, args, k, dim), align=8) for k in (1, 3)
        )
        right = _chosen(builder, right, [e for _ in range(rows) for e in range(dim)])
        for first in range(0, dim, rows):
            target = _row_at(context, builder, signature, args, 0, _INT(first // rows), rows * dim)
            factor = _chosen(builder, left, [first + d for d in range(rows) for _ in range(dim)])
            value = fused(builder, factor, right, builder.load(target, align=8))
            builder.store(value, target, align=8)
        return context.get_dummy_value()

    return types.void(out, a, i, b, j, spacing), codegen


@intrinsic
def add_to_rows(
    _typing: Any, out: Any, i: Any, factors: Any, k: Any, other: Any, j: Any, spacing: Any, rows: Any
) -> Any:
    """``out[i + c, :] += factors[k, c] * other[j, :]`` of ``len(rows)`` adjacent rows c, by four numbers.

    ``factors`` is of shape (n, len(rows)), all else as in :func:`add_scaled_row`."""
    _check(out, other)
    _check(factors, factors)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        dim, count = len(signature.args[6]), len(signature.args[7])
        factor = builder.load(_row_of(context, builder, signature, args, 2, count), align=8)
        row = builder.load(_row_of(context, builder, signature, args, 4, dim), align=8)
        target = builder.bitcast(
            _row_of(context, builder, signature, args, 0, dim), ir.DoubleType().as_pointer()
        )
        for first in range(0, count * dim, 4):
            part = range(first, min(first + 4, count * dim))
            vector = ir.VectorType(ir.DoubleType(), len(part)).as_pointer()
            place = builder.bitcast(builder.gep(target, [_INT(first)]), vector)
            left = _chosen(builder, factor, [number // dim for number in part])
            right = _chosen(builder, row, [number % dim for number in part])
            builder.store(fused(builder, left, right, builder.load(place, align=8)), place, align=8)
        return context.get_dummy_value()

    return types.void(out, i, factors, k, other, j, spacing, rows), codegen


@intrinsic
def divide(_typing: Any, out: Any, number: Any, spacing: Any) -> Any:
    """``out[d, e] /= number`` in one operation; one after the other, divisions take four times as long."""
    _check(out, out)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        size = len(signature.args[2]) ** 2
        target = _row_at(context, builder, signature, args, 0, _INT(0), size)
        divisor = _repeated(builder, context.cast(builder, args[1], signature.args[1], types.float64), size)
        builder.store(builder.fdiv(builder.load(target, align=8), divisor), target, align=8)
        return context.get_dummy_value()

    return types.void(out, number, spacing), codegen


@intrinsic
def copy_matrix(_typing: Any, out: Any, i: Any, other: Any, j: Any, spacing: Any) -> Any:
    """``out[i] = other[j]`` of matrices (n, dim, dim) in one operation; one matrix (dim, dim) has index 0."""
    _check(out, other)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        size = len(signature.args[4]) ** 2
        target, source = (_row_of(context, builder, signature, args, k, size) for k in (0, 2))
        builder.store(builder.load(source, align=8), target, align=8)
        return context.get_dummy_value()

    return types.void(out, i, other, j, spacing), codegen


@intrinsic
def multiply_by_hats(_typing: Any, out: Any, factor: Any, at: Any, d: Any, node: Any, spacing: Any) -> Any:
    """``out[c] = factor[c] * max(1 − abs(at[d, c] − node), 0)`` of 2**dim corners c in one operation.

    ``out`` and ``factor`` (8,) and ``at`` (dim, 8) are C-contiguous."""
    _check(out, factor)
    _check(out, at)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        width = 2 ** len(signature.args[5])
        vector = ir.VectorType(ir.DoubleType(), width)
        row = _row_of(context, builder, signature, args, 2, 8)
        position = builder.load(builder.bitcast(row, vector.as_pointer()), align=8)
        centre = _repeated(builder, context.cast(builder, args[4], signature.args[4], types.float64), width)
        difference = builder.fsub(position, centre)
        one, zero = ir.Constant(vector, [1.0] * width), ir.Constant(vector, [0.0] * width)
        hat = builder.fsub(one, of_floats(builder, "fabs", difference))
        hat = builder.select(builder.fcmp_ordered(">", zero, hat), zero, hat)
        target, source = (_row_at(context, builder, signature, args, k, _INT(0), width) for k in (0, 1))
        builder.store(builder.fmul(builder.load(source, align=8), hat), target, align=8)
        return context.get_dummy_value()

    return types.void(out, factor, at, d, node, spacing), codegen


@device
def multiply(a: Floats, b: Floats, out: Floats, spacing: tuple[float, ...]) -> None:
    """out = a b, all of them (dim, dim)."""
    for d in range(len(spacing)):
        set_scaled_row(out, d, a[d, 0], b, 0, spacing)
        for e in range(1, len(spacing)):
            add_scaled_row(out, d, a[d, e], b, e, spacing)


@device
def set_to_motion(out: Floats, factor: float, a: Floats, spacing: tuple[float, ...]) -> None:
    """out = 1 + factor a, both of them (dim, dim)."""
    for d in range(len(spacing)):
        for e in range(len(spacing)):
            out[d, e] = factor * a[d, e] + (1.0 if d == e else 0.0)


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
def adjugate(a: Floats, out: Floats, spacing: tuple[float, ...]) -> Float:
    """Write det(a) a⁻¹ to ``out`` and return det a."""
    if len(spacing) == 2:
        out[0, 0], out[0, 1], out[1, 0], out[1, 1] = a[1, 1], -a[0, 1], -a[1, 0], a[0, 0]
    else:
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            for m in range(3):
                n, o = (m + 1) % 3, (m + 2) % 3
                out[m, i] = a[j, n] * a[k, o] - a[j, o] * a[k, n]
    return determinant(a, spacing)


@device
def invert(a: Floats, out: Floats, spacing: tuple[float, ...]) -> Float:
    """Write a⁻¹ to ``out`` and return det a; a singular matrix gives inf or nan, as in NumPy."""
    det = adjugate(a, out, spacing)
    divide(out, det, spacing)
    return det
