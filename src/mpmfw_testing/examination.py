"""All checks on one plug-in, and the table of failures that are expected and justified."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import did_you_mean
from mpmfw_testing.check import Check, Inapplicable, Outcome, Status, Violation
from mpmfw_testing.saving import forget, save
from mpmfw_testing.searching import raised
from mpmfw_testing.subject import Subject

#: Shortest justification of an expected failure, in characters: a word is none.
LEAST_JUSTIFICATION = 20


def examine(
    subject: Subject,
    checks: Sequence[Check],
    expected_failures: Mapping[str, str] | None = None,
    pictures: Path | None = None,
    progress: Callable[[Check], None] | None = None,
    folder: Path | None = None,
) -> list[Outcome]:
    """Run the checks one after the other.

    Parameters
    ----------
    subject
        The plug-in under test.
    checks
        What must hold.
    expected_failures
        Justification by name of the check; a check that is listed must fail.
    pictures
        Folder for the pictures of counterexamples, made if there is one; None draws none.
    progress
        Told of every check before it runs.
    folder
        For the scenes of counterexamples and the programs that run them; None writes none.

    Returns
    -------
    One outcome a check, in their order.

    Raises
    ------
    SceneError
        The table of expected failures names an unknown check, or does not justify one.
    """
    expected = justified(expected_failures or {}, checks)
    causes: dict[tuple[str, ...], str] = {}
    outcomes = []
    for check in checks:
        if progress is not None:
            progress(check)
        why = expected.get(check.name, "")
        outcome = examine_one(subject, check, why, None if why else pictures, None if why else folder)
        outcomes.append(named(outcome, causes))
    return outcomes


def named(outcome: Outcome, causes: dict[tuple[str, ...], str]) -> Outcome:
    """Return the outcome with the check that failed before by the same line; ``causes`` notes it."""
    if not outcome.where:
        return outcome
    first = causes.setdefault(outcome.where[-2:], outcome.check)
    return outcome if first == outcome.check else replace(outcome, same_as=first)


def examine_one(
    subject: Subject,
    check: Check,
    justification: str = "",
    pictures: Path | None = None,
    folder: Path | None = None,
) -> Outcome:
    """Run one check, which must fail if justified; ``folder`` takes a counterexample's scene."""
    started = time.perf_counter()
    forget()
    violation = reason = note = None
    try:
        note = check.run(subject)
    except Violation as broken:
        violation = broken
    except Inapplicable as asked:
        reason = str(asked)
    except Exception as error:
        violation = raised(error)
    seconds = time.perf_counter() - started
    if violation is None:
        status, message = _without_violation(reason, justification, note or "")
        return Outcome(
            check.name, check.property, status, message, justification=justification, seconds=seconds
        )
    return Outcome(
        check.name,
        check.property,
        "expected failure" if justification else "failed",
        violation.message,
        violation.counterexample,
        violation.measured,
        violation.bound,
        justification,
        None if pictures is None else _draw(subject, check, violation, pictures),
        () if folder is None else save(folder, _file_name(subject, check), subject, violation),
        seconds,
        violation.where,
    )


def _without_violation(reason: str | None, justification: str, note: str) -> tuple[Status, str]:
    if justification:
        what = "the check passes" if reason is None else f"the check does not apply ({reason})"
        return "unexpectedly passed", f"{what}, but is listed as an expected failure; take it off the list"
    return ("passed", note) if reason is None else ("not applicable", reason)


def justified(expected: Mapping[str, str], checks: Sequence[Check]) -> dict[str, str]:
    """The table of expected failures, if it is in order.

    Raises
    ------
    SceneError
        It names an unknown check, or a justification is too short to be one.
    """
    names = [check.name for check in checks]
    for name, why in expected.items():
        if name not in names:
            raise SceneError(f"expected_failures: no such check '{name}'; {did_you_mean(name, names)}")
        if len(str(why).strip()) < LEAST_JUSTIFICATION:
            raise SceneError(
                f"expected_failures: '{name}' must be justified in {LEAST_JUSTIFICATION} characters or more, "
                f"found {why!r}"
            )
    return {name: str(why).strip() for name, why in expected.items()}


def _draw(subject: Subject, check: Check, violation: Violation, folder: Path) -> Path | None:
    if violation.picture is None:
        return None
    from mpmfw_testing.pictures import draw

    return draw(folder / f"{_file_name(subject, check)}.png", f"{subject.label}: {check.name}", violation)


def _file_name(subject: Subject, check: Check) -> str:
    """Of a counterexample's files, without an ending."""
    return re.sub(r"[^\w.=-]+", "-", subject.label).strip("-") + f"-{check.name}"
