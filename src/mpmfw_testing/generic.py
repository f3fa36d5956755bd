"""The properties of every kind: it runs, gives the same bits again, goes on when saved, has no idle option.

A kind has a function ``openings``, which returns functions that put an object of the plug-in to work in a
small scene. Each returns a :class:`Session`.
"""

from __future__ import annotations

import functools
import gc
import hashlib
import importlib
import pickle
import tracemalloc
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol, TypeAlias

import numpy as np

from mpmfw.state.fields import AnyArray
from mpmfw.state.history import NotSaved
from mpmfw_testing.check import Violation, within
from mpmfw_testing.options import every_option_acts
from mpmfw_testing.parametrised import MODULES
from mpmfw_testing.subject import Subject

Values: TypeAlias = Iterable[tuple[str, AnyArray]]
#: Bytes that a round may add to the memory that is kept, and how many rounds are measured.
GROWTH, ROUNDS = 10_000.0, 6


class Session(Protocol):
    """An object of a plug-in at work in a small scene."""

    def advance(self) -> Values:
        """Work for a while, and yield the results by name."""

    def save(self) -> dict[str, AnyArray]:
        """Return the values that a run would save."""

    def load(self, saved: dict[str, AnyArray]) -> None:
        """Restore the values that another session saved."""


def openings_of(subject: Subject) -> list[Callable[[Any], Session]]:
    """Return functions that put an object of the plug-in to work, each in a scene."""
    module = importlib.import_module(f"mpmfw_testing.{MODULES[subject.kind]}")
    return list(module.openings(subject))


def runs(subject: Subject) -> None:
    """It works in small scenes, with finite results.

    This is the plainest property: a plug-in that breaks it breaks most others as well.
    """
    for opening in openings_of(subject):
        for name, values in opening(subject.make()).advance():
            if not np.isfinite(values).all():
                raise Violation(f"{name}: a value is not finite")


def repeatable(subject: Subject) -> None:
    """The same scene gives the same bits, with a fresh object and with one that was used before.

    Comparisons and studies hand one configured object to many runs. A plug-in without state answers alike
    whatever it was asked before, and whatever was done with its answers.
    """
    for opening in openings_of(subject):
        used = subject.make()
        session = opening(used)
        first = _kept(session.advance())
        if not hasattr(session, "save"):
            require_same(first, _kept(session.advance()), "asked again it gives other values")
        for which, made in (("an object that was used before", used), ("a fresh object", subject.make())):
            require_same(first, _kept(opening(made).advance()), f"{which} gives other values")


def saved(subject: Subject) -> None:
    """What is saved in the middle and loaded goes on with the same bits.

    It is loaded into a scene that is built anew. Saved are the values that classes name in ``history``, and
    declared arrays of points, surface nodes, bodies and pairs. What is kept elsewhere is lost.
    """
    for opening in openings_of(subject):
        first, second = opening(subject.make()), opening(subject.make())
        _kept(first.advance())
        try:
            second.load(first.save())
        except NotSaved as error:
            raise Violation(str(error)) from error
        text = "after it was saved and loaded it goes on otherwise: history does not name all that is kept"
        require_same(_kept(first.advance()), _kept(second.advance()), text)


def options(subject: Subject) -> None:
    """Every option changes something or is refused. It changes a bit of the results in one of the scenes.

    Values are tried alone, and together with each choice of the other options, since an option may need
    another one. Values may be refused, by the model or as a ``SceneError``, but not all that are tried.
    """

    def digest(opening: Callable[[Any], Session], options: dict[str, Any]) -> str:
        digest = hashlib.sha256()
        try:
            for _, values in opening(subject.make(**options)).advance():
                digest.update(np.ascontiguousarray(values).tobytes())
        except Violation as broken:
            digest.update(str(broken).encode())
        return digest.hexdigest()

    every_option_acts(subject, [functools.partial(digest, each) for each in openings_of(subject)])


def no_growth(subject: Subject) -> None:
    """The memory that it keeps does not grow. A round of work adds at most 10 kB: a run has many thousands.

    Of six rounds the one that adds least counts: arrays that are enlarged once do not grow.
    """
    session = openings_of(subject)[0](subject.make())
    sizes = np.zeros(ROUNDS + 1)  # made before anything is counted
    for _ in session.advance():  # kernels are compiled, Python and NumPy fill their caches
        pass
    frozen = gc.get_freeze_count()
    gc.freeze()  # what there is already does not grow, and is not looked through again
    tracemalloc.start()
    try:
        for k in range(ROUNDS + 1):
            for _ in session.advance():
                pass
            gc.collect()
            sizes[k] = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
        if not frozen:
            gc.unfreeze()
    within(np.diff(sizes).min(), GROWTH, "the memory that is kept grows with every round [bytes]")


def sent(subject: Subject) -> None:
    """An object can be sent to another process, and is the same there.

    A fresh object that is pickled and read again has the same class, options and attributes, arrays to the
    bit.
    """
    made = subject.make()
    try:
        other = pickle.loads(pickle.dumps(made))
    except Exception as error:
        raise Violation(f"an object cannot be sent to another process: {error}") from error
    lost = sorted({name for name in {*vars(made), *vars(other)} if not _alike(made, other, name)})
    if type(other) is not type(made) or lost:
        text = "an object that was sent to another process is another one"
        raise Violation(text, {"lost or changed": ", ".join(lost)})


def _alike(one: Any, other: Any, name: str) -> bool:
    """Return True if both have an attribute, and the same value where values can be compared."""
    if not (hasattr(one, name) and hasattr(other, name)):
        return False
    first, second = getattr(one, name), getattr(other, name)
    if isinstance(first, np.ndarray):
        return bool(np.array_equal(first, second, equal_nan=first.dtype.kind == "f"))
    plain = name == "options" or isinstance(first, bool | int | float | str | tuple | None)
    return not plain or bool(first == second)


def require_same(expected: dict[str, AnyArray], found: dict[str, AnyArray], message: str) -> None:
    """Raise a violation unless two sets of named arrays are the same to the bit; NaN equals NaN."""
    for name, values in expected.items():
        other = found[name]
        if not np.array_equal(values, other, equal_nan=values.dtype.kind == "f"):
            same_shape = values.shape == other.shape
            apart = {"largest difference": np.abs(values - other).max()} if same_shape else {}
            raise Violation(message, {"value": name, **apart})


def _kept(values: Values) -> dict[str, AnyArray]:
    """Return copies: plug-ins may fill the same arrays again."""
    return {name: np.array(array) for name, array in values}


@contextmanager
def unchanged(who: str, *owners: Any, but: Collection[str] = (), **case: object) -> Iterator[None]:
    """Raise a violation if the block changes a bit of the owners' arrays, ``but`` those of some names."""

    def arrays() -> dict[str, AnyArray]:
        found: dict[str, AnyArray] = {}
        for owner in owners:
            kind = type(owner).__name__
            own = {f"{kind}.{name}": each for name, each in vars(owner).items() if name not in but}
            found |= {name: each for name, each in own.items() if isinstance(each, np.ndarray)}
        return found

    before = _kept(arrays().items())
    yield
    changed = [k for k, array in arrays().items() if not np.array_equal(array, before[k], equal_nan=True)]
    if changed:
        raise Violation(f"{who} changes {', '.join(changed)}", case)
