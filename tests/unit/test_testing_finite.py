"""The kit names the array that had a value that is no number first, and the hook."""

import numpy as np
import pytest

from mpmfw.api import ContactStrategy, ForceLaw, hookimpl
from mpmfw_testing import checks_of, examine, subject_of


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
        assert str(outcome.counterexample["first that is no number"]).startswith(array), outcome.report
        assert str(outcome.counterexample["made"]).startswith(made), outcome.report
