"""The values of objects by their place: taken from one simulation, put into another that was built alike.

Nothing has to be declared: whatever hangs on a plug-in's attributes is its history. Numbers, texts, arrays (views of one array
stay views of one), lists, dictionaries, sets, tuples and objects of Python classes are walked through, and each of them is
written once, however many hold it. What is code or was given (functions, classes, options) stays as it was built; a class whose
attributes are not its values says what they are by Python's own ``__getstate__`` and ``__setstate__``. All else (files,
iterators, objects of compiled libraries) is refused with its place. Reading runs no code of the file's: classes and functions
are those at the place, or are looked up among the imported ones of the plug-ins, mpmfw and NumPy; objects are made without their
constructors.
"""

from mpmfw.snapshot.archive import NotSaved, Snapshot, extract_beside, read_snapshot, write_snapshot
from mpmfw.snapshot.putting import put
from mpmfw.snapshot.taking import take

__all__ = ["NotSaved", "Snapshot", "extract_beside", "put", "read_snapshot", "take", "write_snapshot"]
