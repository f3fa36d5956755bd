"""Contact with options that the tests of the conformance kit leave alone, and what the kit does not ask."""

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from contact_scenes import ACTING, run, simulation, slider
from kit_for_tests import asked, entry_points_are_read_once  # noqa: F401
from mpmfw_testing import subject_of

GIVEN = "the normal is given, and the kit's bodies meet in other directions"
#: Contacts with options, and what they cannot pass.
VARIANTS = {
    "bardenhagen(criterion=position)": {},
    "bardenhagen(normal=master)": {},
    "bardenhagen(normal=specified, direction=[1.0, 0.0])": dict.fromkeys(
        ("pushes-apart", "no-adhesion", "coulomb-cone", "frictionless", "relabelling", "rotation"), GIVEN
    ),
    "penalty(passes=one)": {},
    "nodes+lcp": {"relabelling": "rows that say nearly the same share a force by their order"},
}
#: Checks that options of contact might break; the others are asked in the long form.
CHECKS = (
    *("equal-and-opposite", "moment-balance", "pushes-apart", "coulomb-cone", "energy", "rotation"),
    "reports",
)
LONG = ("no-adhesion", "frictionless", "relabelling", "shift", "isolation")


@pytest.mark.parametrize("name", [*CHECKS, *(pytest.param(name, marks=pytest.mark.long) for name in LONG)])
@pytest.mark.parametrize("contact", VARIANTS)
def test_options_break_no_property(contact, name):
    """Linear momentum, moment, friction, energy and symmetries; what is listed as lacking must fail."""
    found = asked(subject_of(contact, "contact"), name, VARIANTS[contact].get(name, ""))
    assert not found.wrong, found.report


def largest_excess(sim, friction):
    """Largest |J_t| − μ J_n over rows, as a fraction of the largest J_n."""
    rows = sim.contact.last_rows
    force, n = rows.force[: rows.count], rows.normal[: rows.count]
    normal = (force * n).sum(axis=1)
    tangential = np.linalg.norm(force - normal[:, None] * n, axis=1)
    return (
        (tangential - friction * normal).max() / normal.max() if len(normal) and normal.max() > 0.0 else 0.0
    )


@pytest.mark.parametrize("strategy", ACTING)
@settings(max_examples=3, derandomize=True, phases=[Phase.generate])  # shrinking takes minutes
@given(friction=st.floats(0.05, 1.0), gap=st.floats(1e-6, 0.01))
def test_every_row_stays_in_the_cone_and_friction_takes_work(strategy, friction, gap):
    excess, sim = [], simulation(strategy, slider(friction=friction, gap=gap))
    work = run(sim, 60, each=lambda sim: excess.append(largest_excess(sim, friction))).work
    assert max(excess) < 1e-12
    assert work.min() >= 0.0
    assert work.sum() > 0.0
