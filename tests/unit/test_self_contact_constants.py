"""Constants of self-contact: each with another value, and a measure that fails with it."""

from unittest import mock

import numpy as np
import pytest

from contact_scenes import CELL
from interpreted import interpreted
from mpmfw.contact.surfaces import one_part, self_contact
from mpmfw.runs.simulation import Simulation
from mpmfw.step.schemes import interpolate
from scenes_for_tests import SOFT, one_body, with_changes

#: Constants that compiled functions read, and those functions.
COMPILED = {"FACING": "mark_nodes", "OVERLAP": "mark_nodes", "DEEPEST": "least_gap"}


def simulation(points, **constants):
    """A body of one outline (n, 2) [cells] at rest."""
    made = one_body({"type": "polygon", "points": (CELL * np.array(points)).tolist()}, size=0.05)
    made = with_changes(made, grid__cell_size=CELL, contact={"method": "penalty"}, shape__method="cpdi")
    made["materials"] = {"soft": SOFT}
    made["bodies"]["solid"]["self_contact"] = True
    with mock.patch.dict(vars(self_contact), constants), mock.patch.dict(vars(one_part), constants):
        return Simulation(made)


def divided(made, **constants):
    """The nodes (n,) of the entries of points, and their points, with these constants."""
    kernels = {
        COMPILED[name]: interpreted(getattr(self_contact, COMPILED[name]), **{name: value})
        for name, value in constants.items()
        if name in COMPILED
    }
    with mock.patch.dict(vars(self_contact), {**constants, **kernels}):
        phi = interpolate(made.state, made.hook, made.clock)
    return phi.nodes[phi.weight > 0.0], np.repeat(np.arange(len(phi.row) - 1), np.diff(phi.row))[
        phi.weight > 0.0
    ]


def closed(gap, slide=0.0, start=2.5, **constants):
    """A long C whose upper arm is moved down to this gap, and aside [cells]."""
    half, wide, arm = 0.5 * start, 15.0, 4.0
    outline = [[-2, -half - arm], [wide, -half - arm], [wide, -half], [1, -half]]
    outline += [[1, half], [wide, half], [wide, half + arm], [-2, half + arm]]
    made = simulation(outline, **constants)
    surface, particles = made.state.surface, made.state.particles
    for x in (surface.position, particles.position):
        x[x[:, 1] > 0.0] += CELL * np.array([slide, gap - start])
    return made


def shared(*given, **constants):
    """Number of nodes, three cells and more from the back, that have points of both arms."""
    made = closed(*given, **constants)
    reference = made.state.self_contact.parts[0].points
    nodes, points = divided(made, **constants)
    far = made.state.grid.position[nodes, 0] > 8.0 * CELL
    above = reference[points, 1] > 0.0
    return len(np.intersect1d(nodes[far & above], nodes[far & ~above]))


@pytest.mark.parametrize(
    ("given", "name", "other"),
    [
        ((0.3,), "FACING", -1.01),
        ((0.3,), "NEARLY", -1.01),
        ((-0.3,), "OVERLAP", 0.1),
        ((-0.2, 0.0, 3.8), "BEYOND", 0.0),
        ((0.1, 1.5, 0.3), "ROOT", 0.1),
    ],
)
def test_no_node_is_shared(given, name, other):
    assert hasattr(self_contact, name)
    assert shared(*given) == 0
    assert shared(*given, **{name: other}) > 0


def ahead_of_the_root(**constants):
    """Number of second nodes that points of the back have, ahead of a slit of 1.5 cells."""
    made = closed(1.5, start=1.5, **constants)
    nodes, points = divided(made)
    back = made.state.self_contact.parts[0].points[points, 0] < CELL
    return (nodes[back] >= np.prod(made.state.grid.window_shape[0])).sum()


def test_ROOT():
    assert ahead_of_the_root(ROOT=self_contact.ROOT) == 0
    assert ahead_of_the_root(ROOT=1.0) > 0


def test_DEEPEST():
    """With less, overlaps are not seen; nodes beside the other part do not count as deep."""
    made = closed(-0.7)
    divided(made)
    contact, pairs = made.state.self_contact, made.state.pair_bodies
    assert contact.gaps(pairs)[0] == pytest.approx(-0.7 * CELL, abs=0.05 * CELL)
    with mock.patch.object(self_contact, "least_gap", interpreted(self_contact.least_gap, DEEPEST=0.5)):
        assert contact.gaps(pairs)[0] > -0.6 * CELL


@pytest.mark.parametrize(("name", "other"), [("SKIN", 0.05), ("SKIN", 1.0), ("CHUNK", 7)])
def test_which_is_the_same_for_all(name, other):
    """How long lists are used, and how they are made, does not change them."""
    one, two = (divided(made) for made in (closed(0.5), closed(0.5, **{name: other})))
    assert all(np.array_equal(*both) for both in zip(one, two, strict=True))
