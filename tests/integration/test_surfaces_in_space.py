"""Penalty contact between surfaces of triangles."""

from __future__ import annotations

import numpy as np
import pytest

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.geometry.solid import turning
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

CELL = 0.25
SOFT = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 12e6, "shear_modulus": 6e6}
WALLS = [{"side": s, "fixed": [a]} for s, a in zip(("left", "right", "bottom", "top"), "xxyy", strict=True)]


def box(lower, upper, segment, **keys):
    """A box [cells] with triangles in rectangles of so many cells."""
    geometry = {"type": "box", "lower": [CELL * x for x in lower], "upper": [CELL * x for x in upper]}
    particles = {"layout": "fitted", "size": 0.5 * CELL}
    return {
        "material": "soft",
        "geometry": geometry,
        "particles": particles,
        "segment": segment * CELL,
        **keys,
    }


def scene(bodies, upper=(4.0, 4.0, 9.0), **keys):
    """Bodies in a grid from −2 cells to ``upper`` [cells], 2 beyond."""
    return {
        "grid": {"cell_size": CELL, "lower": [-2 * CELL] * 3, "upper": [CELL * (x + 2) for x in upper]},
        "time": {"end": 1.0, "output_interval": 1.0},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": 0.3},
        "materials": {"soft": SOFT},
        "bodies": bodies,
        **keys,
    }


def stacked(place, sides):
    """Blocks between smooth walls under pressure, with triangles of these sides; the first interface is
    ``place`` of a cell above a grid line."""
    ends = [0.0, *(4.0 * k + place for k in range(1, len(sides) + 1))]
    bodies = {}
    for k, side in enumerate(sides):
        held = [{"side": "back", "fixed": ["z"]}] if k == 0 else []
        held += [{"side": "front", "pressure": "0.2 MPa"}] if k == len(sides) - 1 else []
        bodies[f"block{k}"] = box((0, 0, ends[k]), (4, 4, ends[k + 1]), side, sides=[*held, *WALLS])
    return scene(bodies, upper=(4.0, 4.0, 4.0 * len(sides) + 1.0), settle={"tolerance": 3e-4}), ends[1:-1]


@pytest.mark.parametrize("sides", [(1 / 3, 1 / 4), (1 / 4, 1 / 3, 1 / 4)], ids=["two", "three"])
def test_stress_between_blocks_of_other_triangles_is_the_pressure(sides):
    mapping, interfaces = stacked(0.37, sides)
    sim = Simulation(load_scene(mapping))
    sim.start()
    particles, surface = sim.state.particles, sim.state.surface
    stress = particles.stress[:, 2, 2] / -0.2e6
    for start in interfaces:
        beside = np.abs(surface.position[:, 2] - CELL * start) < 0.2 * CELL
        interface = surface.position[beside, 2].mean()
        near = stress[np.abs(particles.position[:, 2] - interface) < 0.5 * CELL]
        assert len(near) == 128
        assert near.min() > 0.99
        assert near.max() < 1.01


TURN = np.radians([20.0, 35.0, 50.0])


def turned(blocks):
    """Blocks of four cells on top of each other, turned about the grid's middle, under pressure on both ends;
    ``blocks`` are the sizes of their points, which those of the rectangles are."""
    axes, bodies = turning(tuple(TURN)), {}
    for k, size in enumerate(blocks):
        centre = np.array([0.13, 0.07, 0.21]) + axes @ np.array([0.0, 0.0, 4.0 * k + 2.0 - 2.0 * len(blocks)])
        ends = [side for side, place in (("back", 0), ("front", len(blocks) - 1)) if k == place]
        body = box(centre - 2.0, centre + 2.0, size, sides=[{"side": s, "pressure": "2 kPa"} for s in ends])
        body["geometry"]["angles"], body["particles"]["size"] = TURN.tolist(), size * CELL
        bodies[f"block{k}"] = body
    half = (1.0 + 2.0 * len(blocks) + 2.0) * CELL
    made = scene(bodies, settle={"tolerance": 1e-3}, allow_overlap=True)
    made["grid"] = {"cell_size": CELL, "lower": [-half] * 3, "upper": [half] * 3}
    if len(blocks) == 1:
        del made["contact"]
    return made, axes


@pytest.mark.parametrize(
    ("blocks", "tolerance"),
    [((0.5,), 0.005), ((0.5, 0.5), 0.01), ((0.5, 0.4), 0.06)],
    ids=["one", "two", "other triangles"],
)
def test_stress_in_blocks_turned_against_the_grid_is_the_pressure(blocks, tolerance):
    """At the faces as well, where cells are filled in part: loads are mapped by what CPDI makes of the grid's
    functions there.
    """
    mapping, axes = turned(blocks)
    sim = Simulation(load_scene(mapping))
    sim.start()
    stress = np.einsum("a,nab,b->n", axes[:, 2], sim.state.particles.stress, axes[:, 2]) / -2e3
    assert abs(stress - 1.0).max() < tolerance
    assert stress.mean() == pytest.approx(1.0, abs=1e-3)


def impact(method="penalty"):
    """A ball that spins hits the edge of a free box, both off the grid lines."""
    ball = {
        "material": "soft",
        "geometry": {"type": "ball", "centre": [0.31, 0.47, 1.18], "radius": 0.375},
        "particles": {"layout": "lattice", "size": 0.5 * CELL},
        "velocity": [2.0, 1.0, -6.0],
        "angular_velocity": [5.0, -20.0, 8.0],
    }
    bodies = {"ball": ball, "box": box((0.3, 0.2, 0.1), (3.3, 3.2, 3.1), 1 / 2)}
    return scene(bodies, contact={"method": method, "friction": 0.3})


def momentum(particles):
    return particles.mass @ particles.velocity


@pytest.mark.parametrize("method", ["penalty", "surfaces+hamad2017", "surfaces+impulse", "lcp", "hybrid"])
def test_impact_keeps_momentum_and_pushes_apart(method):
    sim = Simulation(load_scene(impact(method)))
    sim.advance(1)
    particles, ball = sim.state.particles, sim.state.bodies[0].particles
    before, speed = momentum(particles), particles.velocity[ball].mean(axis=0)
    touched = 0
    for _ in range(60):
        sim.step()
        touched += int((sim.contact.rows.gap[: sim.contact.rows.count] < 0.0).sum())
    assert touched > 20
    assert particles.velocity[ball].mean(axis=0)[2] > speed[2] + 0.3
    np.testing.assert_allclose(momentum(particles), before, atol=1e-12 * np.abs(before).max())


@pytest.mark.parametrize("contact", ["penalty", "adhesion"])
def test_what_friction_has_stored_turns_with_a_table_and_what_rests_on_it(contact):
    """Springs that are loaded along x between two steps pull, a step on, along what was x: beside those of a
    run without them.
    """
    spin, found = 20.0, []
    bodies = {
        "table": box((0, 0, 0), (4, 4, 2), 0.5, angular_velocity=[0.0, 0.0, spin]),
        "guest": box((0.6, 0.6, 1.99), (3.4, 3.4, 4), 0.5, angular_velocity=[0.0, 0.0, spin]),
    }
    mapping = scene(
        bodies,
        upper=(4.0, 4.0, 5.0),
        contact={"method": contact, "friction": 5.0, contact: {"kappa": 1.0}},
        allow_overlap=True,
    )
    for pull in (0.0, 1e-3):
        sim = Simulation(mapping)
        sim.start()
        for _ in range(3):
            sim.step(2e-4)
        rows = sim.contact.old
        touching = (rows.gap[: rows.count] < 0.0) & (np.abs(rows.normal[: rows.count, 2]) > 0.99)
        rows.own.tangential[: rows.count][touching, 0] += pull
        identity, normal = rows.identity[: rows.count][touching], rows.normal[: rows.count][touching]
        sim.step(2e-4)
        new = sim.contact.old
        own = np.isin(new.identity[: new.count], identity)
        assert touching.sum() > 20
        assert own.sum() == touching.sum()
        found.append(new.own.tangential[: new.count][own].copy())
    turned = (found[1] - found[0]) / 1e-3
    np.testing.assert_allclose(normal[:, :2], 0.0, atol=1e-2)
    angle = np.arctan2(turned[:, 1], turned[:, 0])
    np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1.0, rtol=1e-3)
    np.testing.assert_allclose(angle, spin * 2e-4, rtol=0.05)  # the bodies stretch as they turn


def test_bodies_that_overlap_at_the_start_are_refused():
    bodies = {"one": box((0, 0, 0), (2, 2, 2), 0.5), "other": box((1, 1, 1.9), (3, 3, 4), 0.5)}
    with pytest.raises(
        SceneError, match=r"bodies\.one: overlaps body .other. by 0\.025 m at one node at the start"
    ):
        Simulation(load_scene(scene(bodies)))


def test_the_least_gap_is_measured():
    bodies = {"one": box((0, 0, 0), (2, 2, 2), 0.5), "other": box((0.5, 0.5, 2.5), (2, 2, 4), 0.5)}
    tree = mpmfw.run(scene(bodies, time={"end": 1e-4, "output_interval": 1e-4}))
    np.testing.assert_allclose(tree["series"]["min_gap"], 0.5 * CELL, rtol=1e-12)
