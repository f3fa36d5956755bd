"""A rigid punch, flat, round and a wedge, on an elastic half-plane: pressure, and force over displacement."""
# cost: 70

import numpy as np
from common import disc, elastic, fixed, nodes_of, polygon, rectangle, scene

from mpmfw.validation import Place, Runs, by_method, full, methods, together

MODULUS = 1e6 / (1.0 - 0.3**2)  #: E / (1 − ν²) [Pa]
RADIUS, HALF_WIDTH = 8.0, 0.6  #: of the round punch and of the contact under the whole force [m]
FORCE = np.pi * MODULUS * HALF_WIDTH**2 / (4.0 * RADIUS)  #: on the whole punch [N/m]


def pressed_by(punch, part):
    """Return half of a ``punch`` under ``part`` of the force."""
    rise = 1.5 * FORCE / (MODULUS * HALF_WIDTH)
    held = {"mass": 1e3, "inertia": 1e3, "held": ["x", "rotation"], "force": [0.0, -0.5 * part * FORCE]}
    body = {
        "flat": rectangle(-HALF_WIDTH, 0.0, HALF_WIDTH, 0.4),
        "round": disc(0.0, RADIUS, RADIUS),
        "wedge": polygon([[0, 0], [1.5, rise], [1.5, 0.4], [-1.5, 0.4], [-1.5, rise]]),
    }[punch]
    sides = fixed(bottom="xy", left="x", right="x")
    bodies = {
        "bed": rectangle(0.0, -3.0, 3.0, 0.0, segment="0.25 cells", sides=sides),
        "punch": {**body, "segment": 0.01, "rigid": held},
    }
    more = {"settle": {"tolerance": 1e-3}, "output": {"particles": False}}
    return scene(0.1, [-0.4, -3.4], [3.4, 0.6], 1e-4, 1e-4, elastic(1e3, 1e6, 0.3), bodies, **more)


def places(punch, *parts):
    """Return places of a punch with 6 and 12 cells in the half-width, under parts of the force."""
    return [
        Place(
            f"{punch}, b/h = {6 * n}" + (f", F/{round(1 / part)}" if part < 1.0 else ""),
            set={"grid.cell_size": 0.1 / n},
            make={"punch": punch, "part": part},
            when="" if n == 1 else "full",
        )
        for n in (1, 2)
        for part in parts
    ]


every = [*places("flat", 0.25), *places("round", 0.25, 1.0), *places("wedge", 1.0)]
pressed = Runs("pressed", pressed_by, methods(), every)


def profile(tree):
    """Return x and pressure in windows of a cell, without the corner on the plane of symmetry."""
    position, force, length = nodes_of(tree, "bed", -1)
    top = (position[:, 1] > -0.3) & (position[:, 0] < 1.5) & (position[:, 0] > 1e-3)
    window = (position[top, 0] / float(tree.attrs["cell_size"])).astype(int)
    sums = [np.bincount(window, v) for v in (length[top] * position[top, 0], -force[top, 1], length[top])]
    return sums[0] / sums[2], sums[1] / sums[2]


def flat(tree):
    """Return the largest error [%] of the pressure F / (π √(b² − x²)) for x < 0.65 b."""
    x, pressure = profile(tree)
    inner = x < 0.65 * HALF_WIDTH
    exact = 0.25 * FORCE / (np.pi * np.sqrt(HALF_WIDTH**2 - x[inner] ** 2))
    return {"pressure": 100.0 * abs(pressure[inner] / exact - 1.0).max()}


def round_(tree, part):
    """Return errors [%] of p0 and b of a semi-ellipse that is fitted above a fifth of the peak."""
    x, pressure = profile(tree)
    chosen = pressure > 0.2 * pressure.max()
    slope, level = np.polyfit(x[chosen] ** 2, pressure[chosen] ** 2, 1)
    b = HALF_WIDTH * np.sqrt(part)
    peak, width = np.sqrt(level) / (2.0 * part * FORCE / (np.pi * b)), np.sqrt(-level / slope) / b
    return {"peak": 100.0 * (peak - 1.0), "width": 100.0 * (width - 1.0)}


def wedge(tree):
    """Return errors [%] of the pressure F / (π b) arcosh(b / x) for 0.2 b < x < 0.7 b, and of b by its first
    moment (Johnson, eq. 5.13)."""
    x, pressure = profile(tree)
    inner = (x > 0.2 * HALF_WIDTH) & (x < 0.7 * HALF_WIDTH)
    exact = FORCE / (np.pi * HALF_WIDTH) * np.arccosh(HALF_WIDTH / x[inner])
    position, force, _ = nodes_of(tree, "bed", -1)
    b = -2.0 * np.pi * force[:, 1] @ position[:, 0] / FORCE
    return {"pressure": 100.0 * abs(pressure[inner] / exact - 1.0).max(), "b": 100.0 * (b / HALF_WIDTH - 1.0)}


@pressed
def test_pressed(run):
    if run.at("flat*"):
        rows = (("pressure, largest error for x < 0.65 b, {at}", "pressure", 0.0, 5.0, "%"),)
        measure, args = flat, {}
    elif run.at("wedge*"):
        rows = (
            ("pressure, largest error for 0.2 b < x < 0.7 b, {at}", "pressure", 0.0, 5.0, "%"),
            ("b, error, {at}", "b", 0.0, 5.0, "%"),
        )
        measure, args = wedge, {}
    else:
        rows = ("p0, error, {at}", "peak", 0.0, 5.0, "%"), ("b, error, {at}", "width", 0.0, 5.0, "%")
        measure, args = round_, {"part": run.place.make["part"]}
    run.gates(measure, *rows, **args)


def depth(run):
    """Return how deep the round punch stands [m]."""
    return RADIUS - run.results["series"]["centre_of_mass"].sel(body="punch", axis="y").values[0]


def falls(runs):
    """Return by how much δ/F falls from F/4 to F over ln 4 / (π E*) [%], less 100 (Johnson, eq. 5.56)."""
    compliance = [depth(one) / (one.place.make["part"] * FORCE) for one in runs]
    return 100.0 * ((compliance[0] - compliance[1]) * np.pi * MODULUS / np.log(4.0) - 1.0)


@full
@together(pressed)
def test_force_over_displacement(case, runs):
    for method, same in by_method(runs):
        for n in (6, 12):
            pair = [one for one in same if f"round, b/h = {n}" in one.place.at]
            value = falls(sorted(pair, key=lambda one: one.place.make["part"]))
            case.gate(f"fall of δ/F, error, b/h = {n}", value, 0.0, 5.0, "%", method)
