"""Small scratch arrays on the stack of a kernel.

``np.empty`` allocates on the heap, and sums stay in memory. An array on the stack whose address never escapes
is promoted to registers, so that loops over ``range(dim)`` cost what hand-written scalars do.

The shape is given by the length of tuples, known to the compiler. The contents are undefined until written.
The arrays must not be returned or stored.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.np import arrayobj

from mpmfw.kernels._jit import intrinsic

_arrayobj: Any = arrayobj  # numba has no annotations here


def stack_array(context: Any, builder: Any, array_type: Any, shape: tuple[int, ...]) -> Any:
    """Emit an ``alloca`` of items in the entry block and wrap it as a numba array."""
    count = int(np.prod(shape))
    item, intp = context.get_data_type(array_type.dtype), context.get_value_type(types.intp)
    size = context.get_abi_sizeof(item)
    with builder.goto_entry_block():
        data = builder.alloca(ir.ArrayType(item, count))
    array = _arrayobj.make_array(array_type)(context, builder)
    strides = [size * int(np.prod(shape[axis + 1 :])) for axis in range(len(shape))]
    _arrayobj.populate_array(
        array,
        data=builder.bitcast(data, item.as_pointer()),
        shape=[ir.Constant(intp, extent) for extent in shape],
        strides=[ir.Constant(intp, stride) for stride in strides],
        itemsize=ir.Constant(intp, size),
        meminfo=None,
    )
    return array._getvalue()


@intrinsic
def vector(_typing: Any, like: Any) -> Any:
    """Scratch vector of shape ``(len(like),)``."""
    array_type = types.Array(types.float64, 1, "C")

    def codegen(context: Any, builder: Any, signature: Any, _args: Any) -> Any:
        return stack_array(context, builder, signature.return_type, (len(signature.args[0]),))

    return array_type(like), codegen


@intrinsic
def integers(_typing: Any, like: Any) -> Any:
    """Scratch vector of int64, of shape ``(len(like),)``."""
    array_type = types.Array(types.int64, 1, "C")

    def codegen(context: Any, builder: Any, signature: Any, _args: Any) -> Any:
        return stack_array(context, builder, signature.return_type, (len(signature.args[0]),))

    return array_type(like), codegen


@intrinsic
def matrix(_typing: Any, rows: Any, columns: Any) -> Any:
    """Scratch matrix of shape ``(len(rows), len(columns))``."""
    array_type = types.Array(types.float64, 2, "C")

    def codegen(context: Any, builder: Any, signature: Any, _args: Any) -> Any:
        return stack_array(context, builder, signature.return_type, tuple(len(arg) for arg in signature.args))

    return array_type(rows, columns), codegen


@intrinsic
def matrices(_typing: Any, number: Any, rows: Any, columns: Any) -> Any:
    """As many scratch matrices of shape ``(len(rows), len(columns))`` as ``number`` is long."""
    array_type = types.Array(types.float64, 3, "C")

    def codegen(context: Any, builder: Any, signature: Any, _args: Any) -> Any:
        return stack_array(context, builder, signature.return_type, tuple(len(arg) for arg in signature.args))

    return array_type(number, rows, columns), codegen


__all__ = ["integers", "matrices", "matrix", "vector"]
