"""All checks on one plug-in, and the table of failures that are expected and justified."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import did_you_mean
from mpmfw_testing.check import Check, Inapplicable, Outcome, Violation, remember
from mpmfw_testing.files import draw, save
from mpmfw_testing.searching import raised
from mpmfw_testing.subject import Subject

#: Shortest justification of an expected failure, in characters.
LEAST_JUSTIFICATION = 20


def examine(
    subject: Subject,
    checks: Sequence[Check],
    expected_failures: Mapping[str, str] | None = None,
    pictures: Path | None = None,
    progress: Callable[[Check], None] | None = None,
    folder: Path | None = None,
) -> list[Outcome]:
    """Run the checks one after the other; return one outcome a check, in their order.

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
        Called with every check before it runs.
    folder
        For the scenes of counterexamples and the programs that run them; None writes none.

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
        outcome = examine_one(subject, check, expected.get(check.name, ""), pictures, folder)
        outcomes.append(named(outcome, causes))
    return outcomes


def named(outcome: Outcome, causes: dict[tuple[str, ...], str]) -> Outcome:
    """Return the outcome with the check that failed before by the same line; ``causes`` notes it."""
    if outcome.violation is None or not outcome.violation.where:
        return outcome
    first = causes.setdefault(outcome.violation.where[-2:], outcome.check)
    return outcome if first == outcome.check else replace(outcome, same_as=first)


def examine_one(
    subject: Subject,
    check: Check,
    justification: str = "",
    pictures: Path | None = None,
    folder: Path | None = None,
) -> Outcome:
    """Run one check, which must fail if justified; files are written of unexpected failures alone."""
    started = time.perf_counter()
    remember()
    outcome, violation = Outcome(check.name, check.property, "passed", justification=justification), None
    try:
        outcome = replace(outcome, message=check.run(subject) or "")
    except Violation as broken:
        violation = broken
    except Inapplicable as reason:
        outcome = replace(outcome, status="not applicable", message=str(reason))
    except Exception as error:
        violation = raised(error)
    outcome = replace(outcome, seconds=time.perf_counter() - started)
    if violation is not None:
        unexpected = not justification
        return replace(
            outcome,
            status="failed" if unexpected else "expected failure",
            message=violation.message,
            violation=violation,
            picture=draw(pictures, subject, check, violation) if pictures and unexpected else None,
            saved=save(folder, subject, check, violation) if folder and unexpected else (),
        )
    if justification:
        what = "the check passes" if outcome.status == "passed" else f"it does not apply ({outcome.message})"
        text = f"{what}, but is listed as an expected failure; take it off the list"
        return replace(outcome, status="unexpectedly passed", message=text)
    return outcome


def justified(expected: Mapping[str, str], checks: Sequence[Check]) -> dict[str, str]:
    """Return the table of expected failures; refuse unknown checks, and justifications that are too short."""
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
