"""Soil that begins with the stress of its own weight stays where it is."""

import numpy as np
import pytest

from mpmfw.effects import initial_stress
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of, solid, with_changes

K, G, DENSITY, DEPTH = 5e6, 3e6, 2e3, 2.0
SOIL = {
    "model": "mohr_coulomb", "density": DENSITY, "bulk_modulus": K, "shear_modulus": G, "friction_angle": 0.5,
    "cohesion": 1e3,
}  # fmt: skip
#: Elastic settlement of the layer under its weight.
SETTLEMENT = DENSITY * 10.0 * DEPTH**2 / (2.0 * (K + 4.0 / 3.0 * G))


def layer(**changes):
    """Two metres of soil between smooth walls, off the grid lines."""
    smooth = (("bottom", "y"), ("left", "x"), ("right", "x"))
    sides = [{"side": side, "fixed": [axis]} for side, axis in smooth]
    keys = {"volumetric": "pointwise", "initial_stress": {"k0": 0.5}, "sides": sides}
    body = solid([0.0, 0.07], [1.5, 0.07 + DEPTH], 0.125, material="soil", **keys)
    tables = {"materials": {"soil": SOIL}, "gravity": {"vector": [0.0, -10.0]}}
    scene = scene_of({"solid": body}, 0.25, [-1.0] * 2, [4.0] * 2, end=0.1, outputs=2, **tables)
    return with_changes(scene, **changes)


def moved(scene):
    """Return the largest motion of a point over the elastic settlement, and the last stresses."""
    simulation = Simulation(scene)
    simulation.start()
    p = simulation.state.particles
    start, farthest = p.position.copy(), 0.0
    while simulation.state.time < 0.1:
        simulation.advance(5)
        farthest = max(farthest, float(np.abs(p.position - start).max()))
    return farthest / SETTLEMENT, p


AXISYMMETRIC = {"grid__lower": [0.0, -1.0], "grid__axisymmetric": True}
STIFFENS = {**SOIL, "pressure_exponent": 0.5, "reference_pressure": 1e4}
ON_LINES = {"bodies__solid__geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [1.5, DEPTH]}}
HALF = {"grid__cell_size": 0.125, "bodies__solid__particles__size": 0.0625}
CASES = {
    "plane": ({}, 1e-9),
    "Drucker and Prager": ({"materials__soil__model": "drucker_prager"}, 1e-9),
    "moduli that grow with pressure": ({"materials__soil": STIFFENS}, 1e-9),
    "table": ({"bodies__solid__initial_stress": {"table": [[0.0, 0.0, 0.0], [2.0, 4e4, 2e4]]}}, 1e-9),
    "averaged, on grid lines": ({"bodies__solid__volumetric": "auto", **ON_LINES}, 1e-9),
    "averaged, off grid lines": ({"bodies__solid__volumetric": "auto"}, 4e-3),
    "averaged, half the cells": ({"bodies__solid__volumetric": "auto", **HALF}, 1e-3),
    "GIMP on grid lines": ({"shape__method": "gimp", **ON_LINES}, 1e-9),
    "GIMP off grid lines": ({"shape__method": "gimp"}, 4e-3),
    "GIMP, half the cells": ({"shape__method": "gimp", **HALF}, 1e-3),
    "B-splines": ({"shape__method": "bspline"}, 1e-3),
    "of revolution": (AXISYMMETRIC, 2e-2),  # gravity's weights and those of stress differ by l²/(h r)
}


@pytest.mark.parametrize(("changes", "most"), CASES.values(), ids=CASES)
def test_a_layer_stays_where_it_is(changes, most):
    scene = layer(**changes)
    share, p = moved(scene)
    assert share < most
    top = scene["bodies"]["solid"]["geometry"]["upper"][1]
    below = 0.5 if most > 1e-9 else 0.0  # free sides of other shapes are rough
    deep = top - p.position[:, 1] > below
    vertical = -DENSITY * 10.0 * (top - p.position[deep, 1])
    rounding = max(5.0 * most, 1e-6) * DENSITY * 10.0 * DEPTH
    if "bodies__solid__volumetric" in changes:  # points have the mean pressure of their cell
        rounding += 0.5 * 0.25 * DENSITY * 10.0
    assert p.stress[deep, 1, 1] == pytest.approx(vertical, abs=rounding)
    assert p.stress[deep, 0, 0] == pytest.approx(0.5 * vertical, abs=rounding)
    if p.in_space is not p:
        assert p.in_space.stress[deep, 2, 2] == pytest.approx(0.5 * vertical, abs=rounding)


def test_without_it_the_layer_settles():
    scene = layer()
    del scene["bodies"]["solid"]["initial_stress"]
    assert moved(scene)[0] > 0.5


def test_the_step_follows_the_stiffness_under_pressure():
    """M = K' + 4 G / 3 + m K' (largest principal over norm of stress from p₀)², times A: here at the base."""
    simulation = Simulation(layer(materials__soil=STIFFENS))
    p, reference, k = simulation.state.particles, 1e4, 0.5 * K
    vertical = float(-p.stress[:, 1, 1].min())
    principal = reference + vertical * np.array([1.0, 0.5, 0.5])
    mean = principal.mean()
    norm = mean**2 + k / G * 0.5 * float(((principal - mean) ** 2).sum())
    factor = (norm / reference**2) ** 0.25
    modulus = factor * (k + 4.0 / 3.0 * G + k * principal[0] ** 2 / norm)
    limits = {owner: limit for limit, owner in simulation.limits()}
    expected = 0.25 / np.sqrt(modulus / DENSITY)
    assert limits["bulk under pressure (mohr_coulomb)"] == pytest.approx(expected, rel=1e-6)
    assert simulation.stable_step() == pytest.approx(simulation.setup.safety * expected, rel=1e-6)
    assert expected < 0.8 * limits["bulk wave speed (h / c)"]
    with pytest.raises(SceneError, match=r"bulk under pressure \(mohr_coulomb\), of which 0\.8 is stable"):
        Simulation(layer(materials__soil=STIFFENS, time__safety=0.9)).start()


def test_top_density_and_the_direction_of_gravity_are_obeyed():
    given = {"k0": 0.8, "density": 1e3, "top": -1.0}
    scene = layer(gravity={"vector": [0.0, 10.0]}, bodies__solid__initial_stress=given)
    simulation = Simulation(scene)
    p = simulation.state.particles
    assert p.stress[:, 1, 1] == pytest.approx(-1e4 * (p.position[:, 1] + 1.0))
    assert p.stress[:, 0, 0] == pytest.approx(0.8 * p.stress[:, 1, 1])


def test_a_stress_at_the_limit_is_kept_and_one_beyond_is_refused(monkeypatch):
    active = (1.0 - np.sin(0.5)) / (1.0 + np.sin(0.5))
    sand = {**SOIL, "cohesion": 0.0}
    Simulation(layer(materials__soil=sand, bodies__solid__initial_stress__k0=1.01 * active))
    beyond = layer(materials__soil=sand, bodies__solid__initial_stress__k0=0.9 * active)
    with pytest.raises(SceneError, match="beyond the strength"):
        Simulation(beyond)
    monkeypatch.setattr(initial_stress, "YIELDED", 1.0)
    Simulation(beyond)


ROWS = [[0, 0, 0], [1, 1, 1]]
ELASTIC = {key: SOIL[key] for key in list(SOIL)[:4]} | {"model": "neo_hookean"}


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"materials__soil": ELASTIC}, "neo_hookean"),
        ({"bodies__solid__initial_stress": {"top": 1.0}}, "expected k0 or table"),
        ({"bodies__solid__initial_stress": {"table": ROWS, "k0": 1.0}}, "expected k0 or table"),
        ({"bodies__solid__initial_stress": {"table": [[1, 0, 0], [0, 1, 1]]}}, "depths that increase"),
        ({"gravity": {"vector": [1.0, -10.0]}}, "gravity along one of the axes"),
    ],
)
def test_what_cannot_be_is_refused(changes, match):
    with pytest.raises(SceneError, match=match):
        Simulation(layer(**changes))
