"""Arrays that kernels take as one argument, ``rows.gap[c]``.

numba takes a ``NamedTuple`` as well, but works out its type and unpacks every array anew at each call: 5 µs
for 15 arrays, a few percent of a small scene's step. A struct keeps addresses and shapes of its arrays in a
row of numbers, which compiled code reads at once: 0.1 µs, whatever their number.

numba's dispatch looks up the type of an argument by its class alone, in C, if it is a buffer; of another
object it fails first, which takes longer than all else. A struct is therefore a structure of ctypes, and its
class has one numba type. The structure holds the address of the row, since to read an attribute takes 0.6 µs.
"""

from __future__ import annotations

import ctypes
import functools
import inspect
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numba
import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, extending, imputils, types
from numba.core.typing.templates import AttributeTemplate
from numba.np import arrayobj

# numba's annotations differ between versions.
_arrayobj: Any = arrayobj
_cgutils: Any = cgutils
_extending: Any = extending
_imputils: Any = imputils
_typeof: Any = numba.typeof
_Attribute: Any = AttributeTemplate
_StructModel: Any = extending.models.StructModel
_Type: Any = types.Type


class StructType(_Type):  # type: ignore[misc]
    """Names and types of the members, and constants: structs with the same are of one type, whatever their
    class."""

    def __init__(self, members: tuple[tuple[str, Any], ...], constants: dict[str, int]) -> None:
        self.members, self.constants = members, constants
        of_members = ", ".join(f"{name}: {kind}" for name, kind in members)
        super().__init__(f"Struct({of_members}{constants or ''})")


#: Types of structs by the names of their members and what numba's type of an array depends on.
_struct_types: dict[tuple[Any, ...], StructType] = {}


class Struct(ctypes.Structure):
    """Base of classes whose annotated attributes are arrays that kernels take in one argument.

    A subclass annotates them, or names in ``member_names`` those that kernels see; classes derived from it
    may add what Python alone sees. Arrays are read and written in place; :meth:`set` replaces some.
    ``members`` are the arrays by name.
    """

    _fields_: ClassVar[list[Any]] = [("_address", ctypes.c_int64)]
    _address: int  #: of the row of numbers; 0 until ``kernel_arrays`` is first read

    #: Names of the annotated attributes, in their order.
    member_names: ClassVar[tuple[str, ...]] = ()
    #: Names of integers that compiled code has as constants, and which do not change.
    constant_names: ClassVar[tuple[str, ...]] = ()
    _numba_type_: StructType
    kernel_arrays: tuple[Any, ...]  #: in the order of ``member_names``

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if not cls.member_names:
            cls.member_names = tuple(inspect.get_annotations(cls))

    def __init__(self, **members: Any) -> None:
        self.set(**members)

    def set(self, **members: Any) -> Self:
        """Replace arrays by those in ``members``; return the object."""
        self.__dict__.update(members)
        arrays = [getattr(self, name) for name in self.member_names]
        sizes = [number for array in arrays for number in (array.ctypes.data, *array.shape, *array.strides)]
        numbers = np.array(sizes, dtype=np.int64)
        kind = _struct_type(
            self.member_names, arrays, {each: getattr(self, each) for each in self.constant_names}
        )
        self.__dict__.update(kernel_arrays=tuple(arrays), _numba_type_=kind, _numbers=numbers)
        self._address = numbers.ctypes.data
        self.__class__ = _class_with(self._written, kind)
        return self

    def __setattr__(self, name: str, value: Any) -> None:
        """As any attribute; compiled code sees a member's new array."""
        new = name in self.member_names and value is not self.__dict__.get(name)  # after += it is the same
        super().__setattr__(name, value)
        if new and hasattr(self, "kernel_arrays"):  # not while the object is being made
            self.set()

    @property
    def _written(self) -> type[Self]:
        """The class as it is written, without a numba type."""
        return next(each for each in type(self).__mro__ if "_of_type" not in vars(each))

    def __reduce__(self) -> Any:
        """As any object, of the class as it is written."""
        return _empty, (self._written,), self.__getstate__()

    def __getstate__(self) -> dict[str, Any]:
        """Without the addresses, which mean nothing in a copy."""
        own = ("kernel_arrays", "_numba_type_", "_numbers")
        return {name: value for name, value in self.__dict__.items() if name not in own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """With addresses of the copy."""
        self.__dict__.update(state)
        self.set()

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def members(self) -> dict[str, Any]:
        """Return the arrays that kernels see, by name."""
        return dict(zip(self.member_names, self.kernel_arrays, strict=True))


def _empty(written: type[Struct]) -> Struct:
    """A struct without arrays, to be given its state."""
    return written.__new__(written)


#: For good, as numba knows a class by its address: none that threads make twice may be used and freed.
_classes: dict[tuple[type[Struct], StructType], type[Any]] = {}


def _class_with(written: type[Struct], kind: StructType) -> type[Any]:
    """A class whose structs are all of one numba type."""
    if (written, kind) not in _classes:
        made = type(written.__name__, (written,), {"_of_type": kind, "__module__": written.__module__})
        _classes.setdefault((written, kind), made)
    return _classes[written, kind]


def _struct_type(names: tuple[str, ...], arrays: list[Any], constants: dict[str, int]) -> StructType:
    """The type of a struct; numba takes 40 µs a member to work it out, so that it is kept."""
    key = (names, *constants.items(), *[(type(a), a.dtype, a.ndim, a.flags.num) for a in arrays])
    if key not in _struct_types:
        _struct_types[key] = StructType(tuple(zip(names, map(_typeof, arrays), strict=True)), constants)
    return _struct_types[key]


def struct(**members: Any) -> Struct:
    """Return a struct of arrays by names that are known at run time alone."""
    return _members(tuple(members))(**members)


@functools.cache
def _members(names: tuple[str, ...]) -> type[Struct]:
    """A class with members of these names."""
    return type("Members", (Struct,), {"member_names": names})


@_extending.typeof_impl.register(Struct)  # type: ignore[untyped-decorator]
def _type_of(value: Struct, context: Any) -> StructType:  # noqa: ARG001
    """The type of a struct of a class that numba meets first."""
    return value._numba_type_


@_extending.register_model(StructType)
class _Model(_StructModel):  # type: ignore[misc]
    """The members one after the other. They are not counted as references: the caller holds the object."""

    def __init__(self, manager: Any, kind: StructType) -> None:
        super().__init__(manager, kind, list(kind.members))

    def traverse(self, builder: Any) -> list[Any]:  # noqa: ARG002
        """Count no references, or each call of a device would count those of every member."""
        return []


@_extending.infer_getattr
class _Attributes(_Attribute):  # type: ignore[misc]
    """Type of ``struct.member``."""

    key = StructType

    def generic_resolve(self, kind: StructType, name: str) -> Any:
        """None where there is no such member."""
        return types.int64 if name in kind.constants else dict(kind.members).get(name)


@_imputils.lower_getattr_generic(StructType)  # type: ignore[untyped-decorator]
def _member(context: Any, builder: Any, kind: StructType, value: Any, name: str) -> Any:
    """``struct.member``, without an owner whose references would be counted: a kernel must not return it."""
    if name in kind.constants:
        return context.get_constant(types.int64, kind.constants[name])
    members = _cgutils.create_struct_proxy(kind)(context, builder, value=value)
    array = _arrayobj.make_array(dict(kind.members)[name])(context, builder, value=getattr(members, name))
    array.meminfo = _cgutils.get_null_value(array.meminfo.type)
    return array._getvalue()


@_extending.unbox(StructType)  # type: ignore[untyped-decorator]
def _unbox(kind: StructType, value: Any, c: Any) -> Any:
    """The arrays of a Python object, from the row of numbers that it keeps."""
    builder, word = c.builder, ir.IntType(64)
    head = builder.gep(value, [word(object.__basicsize__)])  # here ctypes keeps the structure's address
    field = builder.load(builder.bitcast(head, word.as_pointer().as_pointer().as_pointer()))
    with builder.if_then(_cgutils.is_null(builder, builder.load(field)), likely=False):
        c.pyapi.decref(c.pyapi.object_getattr_string(value, "kernel_arrays"))
    numbers, read = builder.load(field), 0
    failed = _cgutils.is_null(builder, numbers)  # an error, as of memory, or an interruption ended its making

    def number() -> Any:
        nonlocal read
        read += 1
        return builder.load(builder.gep(numbers, [ir.Constant(word, read - 1)]))

    members = _cgutils.create_struct_proxy(kind)(c.context, builder)
    with builder.if_then(builder.not_(failed), likely=True):
        for name, member_type in kind.members:
            array = _arrayobj.make_array(member_type)(c.context, builder)
            _arrayobj.populate_array(
                array,
                data=builder.inttoptr(number(), array.data.type),
                shape=[number() for _ in range(member_type.ndim)],
                strides=[number() for _ in range(member_type.ndim)],
                itemsize=c.context.get_constant(
                    types.intp, c.context.get_abi_sizeof(c.context.get_data_type(member_type.dtype))
                ),
                meminfo=None,
            )
            setattr(members, name, array._getvalue())
    return _extending.NativeValue(members._getvalue(), is_error=failed)
