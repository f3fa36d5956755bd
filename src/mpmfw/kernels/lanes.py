"""Numbers of several points at once, one in each lane of the processor's vectors.

A kernel reads as for one point: ``a * b + c`` of such numbers, or of one and a float, is one operation for
all of them. Each result is what floats give, to the bit, so that points may be put together in any way.
"""

from __future__ import annotations

import math
import operator
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import extending, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.np import arrayobj

from mpmfw.kernels import arithmetic
from mpmfw.kernels._jit import device, intrinsic
from mpmfw.kernels.scratch import stack_array
from mpmfw.kernels.types import Lanes

# numba's annotations differ between versions.
_arrayobj: Any = arrayobj
_extending: Any = extending
_PrimitiveModel: Any = extending.models.PrimitiveModel
_Template: Any = AbstractTemplate
_Type: Any = types.Type
_infer_global: Any = infer_global
_signature: Any = signature

#: Number of lanes: that of doubles in the vectors of most processors.
WIDTH = 4

#: As long as there are lanes: the number of scratch matrices whose numbers go to lanes.
LANES = (0.0,) * WIDTH

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_INDEX = ir.IntType(32)


class LanesType(_Type):  # type: ignore[misc]
    """Type of the numbers in all lanes."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


_lanes = LanesType()


@_extending.register_model(LanesType)
class _Model(_PrimitiveModel):  # type: ignore[misc]
    """A vector of the processor."""

    def __init__(self, manager: Any, kind: LanesType) -> None:
        super().__init__(manager, kind, _VECTOR)


def _in_lanes(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """A number in every lane, or what is in lanes."""
    if isinstance(kind, LanesType):
        return value
    number = context.cast(builder, value, kind, types.float64)
    vector = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, _INDEX(0))
    return _chosen(builder, vector, vector, (0,) * WIDTH)


def _define(operation: Any, name: str) -> None:
    """Let an operator take lanes, and lanes and a number."""

    class Template(_Template):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:  # noqa: ARG002
            fits = all(isinstance(kind, (LanesType, types.Number, types.IntegerLiteral)) for kind in args)
            return _signature(_lanes, *args) if fits and _lanes in args else None

    _infer_global(operation)(Template)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        values = [_in_lanes(context, builder, *each) for each in zip(sig.args, args, strict=True)]
        return getattr(builder, name)(*values)

    for kinds in ((_lanes,), (_lanes, _lanes), (_lanes, types.Number), (types.Number, _lanes)):
        _extending.lower_builtin(operation, *kinds)(lower)


for _operation, _name in (
    *((operator.add, "fadd"), (operator.iadd, "fadd"), (operator.sub, "fsub"), (operator.neg, "fneg")),
    *((operator.mul, "fmul"), (operator.imul, "fmul"), (operator.truediv, "fdiv")),
):
    _define(_operation, _name)


@intrinsic
def matrix(_typing: Any, rows: Any, columns: Any) -> Any:
    """Scratch matrix of lanes, of shape ``(len(rows), len(columns))``."""

    def codegen(context: Any, builder: Any, sig: Any, _args: Any) -> Any:
        return stack_array(context, builder, sig.return_type, tuple(len(arg) for arg in sig.args))

    return types.Array(_lanes, 2, "C", aligned=False)(rows, columns), codegen


def _chosen(builder: Any, a: Any, b: Any, components: tuple[int, ...]) -> Any:
    """Vector of some components of two others."""
    mask = ir.Constant(ir.VectorType(_INDEX, len(components)), components)
    return builder.shuffle_vector(a, b, mask)


def _transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """The columns of four rows of up to four numbers."""
    a, b, c, d = [_chosen(builder, row, row, tuple(k % row.type.count for k in range(4))) for row in rows]
    even = [_chosen(builder, pair[0], pair[1], (0, 4, 2, 6)) for pair in ((a, b), (c, d))]
    odd = [_chosen(builder, pair[0], pair[1], (1, 5, 3, 7)) for pair in ((a, b), (c, d))]
    halves = ((even, (0, 1, 4, 5)), (odd, (0, 1, 4, 5)), (even, (2, 3, 6, 7)), (odd, (2, 3, 6, 7)))
    return [_chosen(builder, pairs[0], pairs[1], half) for pairs, half in halves]


def _parts(context: Any, builder: Any, sig: Any, args: Any) -> list[tuple[list[Any], list[Any]]]:
    """Addresses of up to four components that are adjacent: in the array of every point, and in lanes."""
    kind = sig.args[0]
    if not (isinstance(kind, types.Array) and kind.layout == "C" and kind.dtype == types.float64):
        raise TypeError(f"lanes of {kind}: expected a C-contiguous array of float64")
    array, own = (_arrayobj.make_array(sig.args[k])(context, builder, args[k]).data for k in (0, 2))
    each = sig.args[3]
    nested = isinstance(each[0], types.BaseTuple)
    components = math.prod(map(len, each)) if nested else len(each) ** (kind.ndim - 1)
    parts = []
    for first in range(0, components, 4):
        count = min(4, components - first)
        at_points = []
        for lane in range(WIDTH):
            point = builder.extract_value(args[1], lane)
            start = builder.add(builder.mul(point, point.type(components)), point.type(first))
            vector = ir.VectorType(ir.DoubleType(), count).as_pointer()
            at_points.append(builder.bitcast(builder.gep(array, [start]), vector))
        parts.append((at_points, [builder.gep(own, [_INDEX(first + k)]) for k in range(count)]))
    return parts


@intrinsic
def read(_typing: Any, array: Any, points: Any, out: Any, spacing: Any) -> Any:
    """``out = array[p]`` of the points p, one in a lane: ``array`` is (n,), (n, dim) or (n, dim, dim).

    Of another one ``spacing`` is a tuple of tuples, each as long as an axis after the first."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        for at_points, in_lanes in _parts(context, builder, sig, args):
            columns = _transposed(builder, [builder.load(row, align=8) for row in at_points])
            for place, column in zip(in_lanes, columns, strict=False):
                builder.store(column, place, align=8)
        return context.get_dummy_value()

    return types.void(array, points, out, spacing), codegen


@intrinsic
def write(_typing: Any, array: Any, points: Any, value: Any, spacing: Any) -> Any:
    """``array[p] = value`` of the points p, one in a lane, as :func:`read`."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        for at_points, in_lanes in _parts(context, builder, sig, args):
            columns = [builder.load(place, align=8) for place in in_lanes]
            rows = _transposed(builder, [columns[min(k, len(columns) - 1)] for k in range(4)])
            for place, row in zip(at_points, rows, strict=True):
                builder.store(_chosen(builder, row, row, tuple(range(len(columns)))), place, align=8)
        return context.get_dummy_value()

    return types.void(array, points, value, spacing), codegen


@intrinsic
def multiply_add(_typing: Any, a: Any, b: Any, c: Any) -> Any:
    """``a * b + c``, in one operation where the processor has it."""
    return _lanes(a, b, c), lambda _context, builder, _signature, args: arithmetic.fused(builder, *args)


@intrinsic
def within(_typing: Any, value: Any, low: Any, high: Any) -> Any:
    """Return whether ``low < value < high`` in every lane; NaN is not."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        x, bounds = args[0], [_in_lanes(context, builder, *each) for each in zip(sig.args, args, strict=True)]
        above, below = builder.fcmp_ordered(">", x, bounds[1]), builder.fcmp_ordered("<", x, bounds[2])
        mask = builder.bitcast(builder.and_(above, below), ir.IntType(WIDTH))
        return builder.icmp_unsigned("==", mask, ir.IntType(WIDTH)(2**WIDTH - 1))

    return types.boolean(value, low, high), codegen


@intrinsic
def floor(_typing: Any, value: Any) -> Any:
    """The greatest integer that is not above a number, as a float, in every lane or of a float."""
    kind = value if isinstance(value, LanesType) else types.float64
    return kind(value), lambda _context, builder, _sig, args: arithmetic.of_floats(builder, "floor", *args)


@intrinsic
def positive(_typing: Any, value: Any) -> Any:
    """``max(value, 0)`` in every lane, or of a float; of NaN it is NaN."""

    def codegen(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        zero = ir.Constant(args[0].type, [0.0] * WIDTH if args[0].type == _VECTOR else 0.0)
        return builder.select(builder.fcmp_ordered(">", zero, args[0]), zero, args[0])

    return (value if isinstance(value, LanesType) else types.float64)(value), codegen


@intrinsic
def component(_typing: Any, array: Any, i: Any, j: Any, lane: Any) -> Any:
    """The number in one lane of ``array[i, j]``."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        matrix = _arrayobj.make_array(sig.args[0])(context, builder, args[0])
        i, j, lane = (context.cast(builder, args[n], sig.args[n], types.intp) for n in (1, 2, 3))
        place = builder.add(builder.mul(i, builder.extract_value(matrix.shape, 1)), j)
        numbers = builder.bitcast(builder.gep(matrix.data, [place]), ir.DoubleType().as_pointer())
        return builder.load(builder.gep(numbers, [lane]), align=8)

    return types.float64(array, i, j, lane), codegen


@device
def points_from(p: int, end: int) -> tuple[int, int, int, int]:
    """Return the points p, p + 1, … of all lanes; past the last, ``end − 1``, it is that one again."""
    last = end - 1
    return p, min(p + 1, last), min(p + 2, last), min(p + 3, last)


@device
def multiply(a: Lanes, b: Lanes, out: Lanes, spacing: tuple[float, ...]) -> None:
    """out = a b, all of them (dim, dim), as :func:`mpmfw.kernels.arithmetic.multiply`."""
    for d in range(len(spacing)):
        for e in range(len(spacing)):
            out[d, e] = a[d, 0] * b[0, e]
            for k in range(1, len(spacing)):
                out[d, e] = multiply_add(a[d, k], b[k, e], out[d, e])


@device
def invert(a: Lanes, out: Lanes, spacing: tuple[float, ...]) -> None:
    """Write a⁻¹ to ``out``, as :func:`mpmfw.kernels.arithmetic.invert`."""
    det = arithmetic.adjugate(a, out, spacing)
    for d in range(len(spacing)):
        for e in range(len(spacing)):
            out[d, e] = out[d, e] / det
