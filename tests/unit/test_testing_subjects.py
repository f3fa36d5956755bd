"""Subjects of checks: classes, objects, names; and values of their options."""

from typing import Annotated

import numpy as np
import pytest
from pydantic import BaseModel, Field

from mpmfw.api import ContactStrategy, ForceLaw, ImpulseLaw, hookimpl
from mpmfw.errors import SceneError
from mpmfw_contact.penalty import Penalty
from mpmfw_testing import (
    Inapplicable,
    Violation,
    check_plugin,
    checks_of,
    examine,
    ladder,
    search,
    subject_of,
    try_all,
)
from mpmfw_testing.options import candidates


def test_subjects_of_all_sorts():
    assert subject_of(Penalty(kappa=2.0), "contact").make().options.kappa == 2.0
    assert subject_of(Penalty, "contact", {"kappa": 3.0}).label == "penalty(kappa=3.0)"
    assert subject_of("mpmfw_contact.penalty:Penalty", "contact").make(kappa=4.0).options.kappa == 4.0
    made = subject_of("penalty(kappa=5)", "contact")
    assert made.make() is not made.make()
    assert made.make().options.kappa == 5.0


def test_a_law_that_attracts_fails_what_the_kit_asks_of_it():
    """Given as the class, as ``check_plugin`` is."""
    with pytest.raises(AssertionError, match=r"surfaces\+attracts\npushes-apart: failed"):
        check_plugin(Attracts, only=["pushes-apart"], pictures=None)


@pytest.mark.parametrize(
    ("plugin", "options", "said"),
    [
        ("penalti", {}, "did you mean 'penalty'"),
        ("mpmfw_shape.gimp:Gimp", {}, "is not of the kind contact"),
        (Penalty, {"kapa": 1.0}, "kapa: unknown key; did you mean 'kappa'"),
        (3, {}, "cannot check 3"),
    ],
)
def test_what_is_no_subject_is_refused(plugin, options, said):
    with pytest.raises(SceneError, match=said):
        subject_of(plugin, "contact", options)


class Attracts(ImpulseLaw):
    """Pulls where it should push."""

    name = "attracts"

    def impulses(self, rows, grid, work, *, projected):  # noqa: ARG002
        rows.force[: rows.count] = -1e-3 * rows.normal[: rows.count]


class Some(BaseModel):
    """Options of many types."""

    opaque: dict[str, float] = {}
    number: float = 2.0
    count: int = 3
    flag: bool = False
    maybe: str | None = None
    pair: tuple[float, ...] | None = None
    other: dict[str, float] = Field({}, examples=[{"a": 1.0}])
    narrow: float = Field(5.5, ge=5, le=6)
    open: float = Field(0.5, gt=0, lt=1)
    order: int = Field(2, ge=1)
    length: Annotated[float, Field(ge=100.0)] | None = None
    shown: float = Field(0.0, ge=0.0, examples=[1e4, 1.0])


def test_values_of_options_are_made_up_by_type():
    fields = Some.model_fields
    assert candidates(fields["number"])[:2] == [4.0, 1.0]
    assert set(candidates(fields["count"])) >= {6, 1}
    assert candidates(fields["flag"]) == [False, True]
    assert "first" in candidates(fields["maybe"])
    assert (1.0, 0.0) in candidates(fields["pair"])
    assert candidates(fields["other"]) == [{"a": 1.0}]
    assert candidates(fields["opaque"]) == []


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [("narrow", 5.0, 6.0), ("open", 1e-9, 1.0 - 1e-9), ("order", 1, 1000), ("length", 100.0, 1e9)],
)
def test_numbers_that_are_made_up_keep_the_bounds_of_the_field(name, least, most):
    field = Some.model_fields[name]
    others = [value for value in candidates(field) if value != field.default]
    assert len(others) >= 2
    assert all(least <= value <= most for value in others)
    for value in others:
        Some(**{name: value})


def test_an_error_of_the_plugin_is_a_violation_with_its_case():
    def trial(a):
        if a > 0:
            raise ZeroDivisionError("no gap")

    with pytest.raises(Violation, match="ZeroDivisionError: no gap") as caught:
        search({"a": ladder(0.0, 4.0, 5)}, trial, examples=20)
    assert caught.value.counterexample == {"a": 1.0}
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


def test_a_later_case_that_cannot_be_asked_hides_no_violation():
    def trial(a):
        if a > 0.6:
            raise Violation("beyond 0.6")
        if a > 0.3:
            raise Inapplicable("the middle cannot be asked")

    with pytest.raises(Violation, match=r"beyond 0\.6"):
        try_all({"a": (0.0, 0.5, 1.0)}, trial)
    with pytest.raises(Inapplicable, match="middle"):
        try_all({"a": (0.5, 1.0)}, trial)


class Divides(ForceLaw):
    """A force that is 0 / 0 in a row, once bodies overlap."""

    name = "divides"

    def estimate_frequency(self, bulk_frequency):  # noqa: ARG002
        return 0.0

    def stiffness(self, rows, old):  # noqa: ARG002
        return np.zeros(rows.count)

    def forces(self, rows, old, dashpot, records):  # noqa: ARG002
        rows.force[: rows.count] = 0.0
        if (rows.gap[: rows.count] < 0.0).any():
            rows.force[0] = np.nan


class Moves(ContactStrategy):
    """A momentum that is none."""

    name = "moves"

    @hookimpl
    def after_momentum_update(self, grid):
        grid.momentum[np.argmax(grid.mass)] = np.nan


@pytest.mark.parametrize(
    ("plugin", "array", "made"),
    [
        (Divides, "rows.force[0]", "in add_nodal_force, step "),
        (Moves, "grid.momentum[", "in after_momentum_update, step 1"),
    ],
)
def test_the_first_array_and_the_hook_that_made_it_are_named(plugin, array, made):
    checks = [check for check in checks_of("contact") if check.name in ("runs", "energy")]
    for outcome in examine(subject_of(plugin, "contact"), checks):
        assert outcome.status == "failed"
        case = outcome.violation.counterexample
        assert str(case["first that is no number"]).startswith(array), outcome.report
        assert str(case["made"]).startswith(made), outcome.report
