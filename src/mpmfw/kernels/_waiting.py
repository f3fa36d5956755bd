"""Threads wait for each other in compiled code, without the interpreter's lock.

A thread that sleeps is awake 15 to 30 µs after it is called, and so is one that asks for the interpreter's
lock while another has it: as long as a small kernel. So they look, for a while, at a number that another
thread writes."""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.np import arrayobj

from mpmfw.kernels._jit import intrinsic, kernel
from mpmfw.kernels.types import Ints

_arrayobj: Any = arrayobj  # numba has no annotations here

#: Numbers between two that different threads write: as many as a line of the cache has.
APART = 8


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    data = _arrayobj.make_array(array_type)(context, builder, array).data
    return builder.gep(data, [builder.mul(index, ir.Constant(ir.IntType(64), APART))])


@intrinsic
def read(_typing: Any, numbers: Any, t: Any) -> Any:  # noqa: ARG001
    """Number ``t`` as another thread wrote it last, and all that it wrote before."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        address = _address(context, builder, signature.args[0], *args)
        return builder.load_atomic(address, "acquire", 8)

    return types.int64(numbers, types.intp), codegen


@intrinsic
def write(_typing: Any, numbers: Any, t: Any, value: Any) -> Any:  # noqa: ARG001
    """Write number ``t`` for other threads, after all that was written before."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        address = _address(context, builder, signature.args[0], *args[:2])
        builder.store_atomic(args[2], address, "release", 8)
        return context.get_dummy_value()

    return types.void(numbers, types.intp, types.int64), codegen


@kernel
def wait(numbers: Ints, t: int, value: int, looks: int) -> bool:
    """Look at number ``t`` of ``numbers`` (n * APART,) until it is ``value``, at most ``looks`` times;
    whether it is.
    """
    for _ in range(looks):  # noqa: SIM110
        if read(numbers, t) == value:
            return True
    return False


@kernel
def begin(numbers: Ints, value: int, looks: int) -> None:
    """Write number 0, which all threads look at, and give them time to take the interpreter's lock one after
    the other.
    """
    write(numbers, 0, value)
    for _ in range(looks):
        read(numbers, 0)


@kernel
def end(numbers: Ints, t: int, value: int, looks: int) -> bool:
    """Write number ``t``, that of a thread that is done, and wait until number 0 is another; whether it
    is.
    """
    write(numbers, t, value)
    for _ in range(looks):  # noqa: SIM110
        if read(numbers, 0) != value:
            return True
    return False
