"""Search for a counterexample over placements, orientations and options, and for the smallest one."""

from __future__ import annotations

import itertools
import re
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import mpmfw
from mpmfw.errors import SceneError
from mpmfw_testing.check import Inapplicable, Violation

_CORE = Path(mpmfw.__file__).resolve().parent
#: Libraries that stand between the kit and a plug-in.
_LIBRARY = re.compile(
    r"[/\\\\](hypothesis|pluggy|numba|numpy|scipy|xarray|pydantic|_pytest|contextlib\.py|<frozen)|^<"
)


class _Enough(BaseException):
    """End the shrinking with what was found. Not an ``Exception``: hypothesis lets it pass."""


def hypothesis() -> Any:
    """Return the module hypothesis with its strategies; refuse to go on if it is not installed."""
    try:
        import hypothesis
        import hypothesis.strategies
    except ImportError as error:
        raise SceneError(
            "the conformance kit searches for counterexamples with hypothesis, which is not installed: "
            "pip install 'mpmfw[testing]'"
        ) from error
    return hypothesis


def ladder(first: float, last: float, rungs: int) -> Any:
    """Return a hypothesis strategy of ``rungs`` numbers at equal distance from ``first`` to ``last``.

    ``first`` is the simplest: a counterexample moves towards it as far as it can.
    """
    step = (last - first) / (rungs - 1)
    return hypothesis().strategies.integers(0, rungs - 1).map(lambda k: first + k * step)


def search(
    cases: Mapping[str, Any],
    trial: Callable[..., None],
    *,
    examples: int = 10,
    most: int = 60,
    names: Mapping[str, str] | None = None,
) -> None:
    """Try a property on many cases; raise what breaks it in the smallest case that does.

    The search is the same in every run: no randomness, no database, no deadline.

    Parameters
    ----------
    cases
        A hypothesis strategy (or :func:`ladder`) for every named number of the case. The first trial is the
        simplest case of all.
    trial
        Takes the numbers as keywords, raises :class:`~mpmfw_testing.check.Violation` if the property is
        broken.
    examples
        Cases that are tried as long as none breaks the property.
    most
        Trials in all, those that look for the smallest counterexample included.
    names
        Names of numbers in the counterexample, where they differ from the keyword.

    Raises
    ------
    Violation
        Of the smallest case found; its counterexample begins with the case's numbers. Another error of a
        trial counts as a violation that names the error.
    Inapplicable
        As raised by a trial, unless another one has broken the property before.
    """
    library, counted = hypothesis(), itertools.count()
    found: list[Violation] = []
    inapplicable: list[Inapplicable] = []

    def one(numbers: Mapping[str, Any]) -> None:
        if next(counted) >= most:
            raise _Enough
        try:
            _tried(trial, numbers, names)
        except Violation as violation:
            found.append(violation)
            raise
        except Inapplicable as reason:
            inapplicable.append(reason)
            raise _Enough from None

    settings = library.settings(
        max_examples=examples,
        derandomize=True,
        database=None,
        deadline=None,
        suppress_health_check=list(library.HealthCheck),
        phases=(library.Phase.generate, library.Phase.shrink),
        report_multiple_bugs=False,
        print_blob=False,
        verbosity=library.Verbosity.quiet,
    )
    try:
        settings(library.given(library.strategies.fixed_dictionaries(dict(cases)))(one))()
    except _Enough:
        pass
    except Exception:
        if not found:
            raise
    if found:
        raise found[-1] from found[-1].__cause__
    if inapplicable:
        raise inapplicable[0]


def try_all(
    cases: Mapping[str, Sequence[Any]], trial: Callable[..., None], *, names: Mapping[str, str] | None = None
) -> None:
    """Try a property on every combination of a few values, simplest first; raise what breaks it first.

    Parameters
    ----------
    cases
        The values of every named number of the case, simplest first.
    trial, names
        As for :func:`search`, whose errors it raises. ``Inapplicable`` counts in the first case; later cases
        that cannot be asked are left out.
    """
    ranks = itertools.product(*(range(len(values)) for values in cases.values()))
    for count, rank in enumerate(sorted(ranks, key=sum)):
        numbers = {name: values[k] for (name, values), k in zip(cases.items(), rank, strict=True)}
        try:
            _tried(trial, numbers, names)
        except Inapplicable:
            if count == 0:
                raise


def _tried(trial: Callable[..., None], numbers: Mapping[str, Any], names: Mapping[str, str] | None) -> None:
    """Try one case; a violation, or an error as one, begins with the case's numbers."""
    case = {(names or {}).get(name, name): value for name, value in numbers.items()}
    try:
        trial(**numbers)
    except Violation as violation:
        raise violation.with_case(case) from violation.__cause__
    except Inapplicable:
        raise
    except Exception as error:
        raise raised(error).with_case(case) from error


def raised(error: BaseException) -> Violation:
    """Return an error of the plug-in, or of the run with it, as a violation with the lines that raised it."""
    first = error
    while (
        inner := first.__cause__ or (None if first.__suppress_context__ else first.__context__)
    ) is not None:
        first = inner
    return Violation(f"{type(error).__name__}: {error}", where=_lines(first))


def _lines(error: BaseException) -> list[str]:
    """Return lines of the traceback outside mpmfw's core and libraries; the last one if there is none."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if not Path(frame.filename).resolve().is_relative_to(_CORE)]
    strange = [frame for frame in own if not _LIBRARY.search(frame.filename)]
    text = []
    for frame in strange or frames[-1:]:
        text += [f'File "{frame.filename}", line {frame.lineno}, in {frame.name}', f"  {frame.line}"]
    return text
