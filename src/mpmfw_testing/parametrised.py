"""The kit as parametrised pytest tests, and as one call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from inspect import cleandoc
from pathlib import Path
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import Kind, did_you_mean
from mpmfw_testing.check import Check
from mpmfw_testing.examination import examine, examine_one, justified, named
from mpmfw_testing.subject import Subject, kind_of, subject_of

#: Module of the checks of each kind; kinds without bundled plug-ins have the generic checks alone.
MODULES: dict[Kind, str] = {
    "contact": "contact", "detection": "contact", "law": "contact", "shape": "shape", "material": "material",
    "load": "load", "friction": "friction", "boundary": "others", "output": "others", "geometry": "geometry",
    "measure": "others", "reference": "others",
}  # fmt: skip
#: Kinds of plug-ins that there are checks for.
CHECKED: tuple[Kind, ...] = tuple(MODULES)
#: Folder for pictures of counterexamples, in the working directory; made by the first failure.
PICTURES = Path("mpmfw-check")


def _conformance_of(kind: Kind, more: str = "") -> Callable[..., Callable[[Any], Any]]:
    """Return the decorator of tests of a kind of plug-in; its docstring goes on with ``more``."""

    def conformance(
        plugin: Any,
        *,
        expected_failures: Mapping[str, str] | None = None,
        only: Iterable[str] | None = None,
        pictures: Path | None = PICTURES,
    ) -> Callable[[Any], Any]:
        """Parametrise a test over the checks of a plug-in.

        Parameters
        ----------
        plugin
            A class, a configured object, or a name, with its options as in ``"drag(rate=2)"``.
        expected_failures
            Names of checks that it cannot pass, each with the reason (20 characters or more). A listed check
            that passes fails the test.
        only
            Names of the checks to run; all by default.
        pictures
            Folder for the pictures of counterexamples; None draws none.

        Returns
        -------
        A decorator of a test with the argument ``check``, which it calls without arguments.

        Raises
        ------
        SceneError
            There is no such plug-in or check, or a failure is not justified.

        Examples
        --------
        >>> @contact_conformance("penalty")
        ... def test_conformance(check):
        ...     check()
        """
        checks, expected = requested(kind, only, expected_failures)
        return _parametrised(subject_of(plugin, kind), checks, expected, pictures)

    conformance.__name__ = conformance.__qualname__ = f"{kind}_conformance"
    conformance.__doc__ = cleandoc(conformance.__doc__ or "").replace("a plug-in.", f"a {kind}.{more}", 1)
    return conformance


contact_conformance = _conformance_of("contact")
detection_conformance = _conformance_of(
    "detection",
    " It is joined with the law ``penalty``, or ``impulse`` where that needs facets that it does not list; "
    "with another law "
    'the two are a contact, ``contact_conformance("my_detection+lcp")``.',
)
law_conformance = _conformance_of(
    "law",
    " It is joined with the detection ``surfaces``; with another one the two are a contact, "
    '``contact_conformance("nodes+my_law")``.',
)
shape_conformance = _conformance_of("shape")
material_conformance = _conformance_of("material")
load_conformance = _conformance_of("load")
friction_conformance = _conformance_of("friction")
boundary_conformance = _conformance_of("boundary")
output_conformance = _conformance_of("output")
geometry_conformance = _conformance_of("geometry")
measure_conformance = _conformance_of("measure")
reference_conformance = _conformance_of("reference")


def checks_of(kind: Kind) -> tuple[Check, ...]:
    """Return all checks of a kind of plug-in, in the order in which they are run.

    Raises
    ------
    SceneError
        There are none for it.
    """
    if kind not in MODULES:
        raise SceneError(f"a {kind} has no separate checks; expected one of {', '.join(CHECKED)}")
    return tuple(map(Check.of, import_module(f"mpmfw_testing.{MODULES[kind]}").CHECKS))


def check_plugin(
    plugin: Any,
    *,
    expected_failures: Mapping[str, str] | None = None,
    only: Iterable[str] | None = None,
    pictures: Path | None = PICTURES,
) -> None:
    """Check a plug-in against the properties of its kind, which follows from its base class.

    Parameters
    ----------
    plugin
        A class or a configured object.
    expected_failures, only, pictures
        As of :func:`mpmfw_testing.contact_conformance`.

    Raises
    ------
    AssertionError
        Checks failed: all of them, each with its smallest counterexample.
    SceneError
        There are no checks for it.

    Examples
    --------
    >>> mpmfw.check_plugin(MyLaw)
    """
    subject = subject_of(plugin, kind_of(plugin))
    checks, expected = requested(subject.kind, only, expected_failures)
    outcomes = examine(subject, checks, expected, pictures)
    if wrong := [outcome.report for outcome in outcomes if outcome.wrong]:
        raise AssertionError("\n".join([subject.label, *wrong]))


def requested(
    kind: Kind, only: Iterable[str] | None, expected_failures: Mapping[str, str] | None = None
) -> tuple[list[Check], dict[str, str]]:
    """Return the checks of these names, in the kit's order, all by default, and their expected failures.

    Refuse unknown names, and failures that are not justified."""
    checks = checks_of(kind)
    names = [check.name for check in checks]
    asked = names if only is None else list(only)
    for name in asked:
        if name not in names:
            raise SceneError(f"no such check '{name}'; {did_you_mean(name, names)}")
    table = justified(expected_failures or {}, checks)
    chosen = [check for check in checks if check.name in asked]
    return chosen, {name: why for name, why in table.items() if name in asked}


def _parametrised(
    subject: Subject, checks: Sequence[Check], expected: Mapping[str, str], pictures: Path | None
) -> Callable[[Any], Any]:
    """Return pytest's mark with a function for each check."""
    try:
        import pytest
    except ImportError as error:
        raise SceneError(
            "mpmfw_testing's decorators need pytest, which is not installed: pip install 'mpmfw[testing]'"
        ) from error
    causes: dict[tuple[str, ...], str] = {}  # of one plug-in's tests together

    def bound(check: Check) -> Callable[[], None]:
        def run() -> None:
            """Pass, skip where the check does not apply, or fail with the smallest counterexample."""
            why = expected.get(check.name, "")
            outcome = named(examine_one(subject, check, why, pictures), causes)
            if outcome.status == "not applicable":
                pytest.skip(outcome.message)
            if outcome.status == "expected failure":
                pytest.xfail(f"{why} ({outcome.message})")
            if outcome.wrong:
                pytest.fail(f"{subject.label}\n{outcome.report}", pytrace=False)

        return run

    mark: Callable[[Any], Any] = pytest.mark.parametrize(
        "check", [bound(check) for check in checks], ids=[check.name for check in checks]
    )
    return mark
