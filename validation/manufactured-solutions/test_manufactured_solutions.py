"""Manufactured solutions: the order at which the steps without contact converge in space and in time."""

# cost: 45

import math

import numpy as np
from driven import displaced, root_mean_square
from manufactured import WAVE, AxisAligned, Motion, Vortex

from mpmfw.errors import SimulationError
from mpmfw.validation import SHAPES, Case, Method, methods

MOTIONS: dict[str, tuple[str, Motion]] = {
    "axis-aligned": ("square.toml", AxisAligned()),
    "vortex": ("ring.toml", Vortex()),
}

#: Expected order in space (axis-aligned, vortex), at a fixed Courant number and with four points a cell.
#: linear: ∇φ jumps where points cross cells, a quadrature error of the stress that no refinement lessens.
#: gimp: domains that do not stretch leave gaps and overlaps in proportion to the strain, which no refinement
#: closes: a part of the error stays, and shows sooner where volumes change.
#: cpdi, cpdi2: bilinear interpolation, and domains that tile the body to second order in h.
#: bspline: a wall that fixes single nodes of a quadratic basis holds the boundary to first order. Without
#: walls 2, until the quadrature by points that lie anyhow among the knots is all that is left.
ORDER = {
    "linear": ("≤ 0", "≤ 0"),
    "gimp": ("1, falls", "2, falls"),
    "cpdi": (2, 2),
    "cpdi2": (2, 2),
    "bspline": (1, "2, falls"),
}
TIME_ORDER = 2  # velocities live at half steps
LEAST = 1.8  # of the recommended methods, where 2 is expected

COURANT, CELLS = 0.3, (8, 16, 32, 64)  # 1; 1/h [1/m]
STEPS = (0.4, 0.2, 0.1)  # Courant numbers of the order in time, against one of
FINEST = 0.0125
#: What the transfer between points and grid does depends on the number of steps, and not on their length; at
#: h = 1/16 it hides the truncation in time of the motion above. That of one eight times as fast stands out.
FAST = AxisAligned(rate=8.0 * math.pi * WAVE, end=2.75 * 2.0 / (8.0 * WAVE))


def test_manufactured_solutions(case: Case) -> None:
    """Both motions with every shape function in space, the recommended ones in time."""
    shapes = ("cpdi", "cpdi2") if case.quick else SHAPES
    cells = CELLS[:2] if case.quick else CELLS
    for motion in MOTIONS:
        for method in methods(("",), shapes):
            in_space(case, method, motion, cells)
    if not case.quick:
        for method in methods(("",), ("cpdi", "cpdi2")):
            in_time(case, method, FAST, "axis-aligned, fast", True)
            in_time(case, method, MOTIONS["axis-aligned"][1], "axis-aligned", False)


def in_space(case: Case, method: Method, motion: str, cells: tuple[int, ...]) -> None:
    """Errors at h = 1 / cells with a step in proportion, and the observed orders."""
    scene, exact = MOTIONS[motion]
    errors = np.full(len(cells), np.nan)
    with case.timed():
        for k, count in enumerate(cells):
            try:
                found, expected = displaced(scene, exact, method.shape, 1.0 / count, COURANT)
                errors[k] = root_mean_square(found - expected)
            except SimulationError as error:
                case.failed(method, f"{motion}, h = 1/{count}: {error}")
    largest = amplitude(motion)
    for k, count in enumerate(cells):
        error = 100.0 * errors[k] / largest
        quantity = f"{motion}: rms error at h = 1/{count}, of the rms displacement"
        case.show(quantity, error, unit="%", method=method)
    expected = ORDER[method.shape][list(MOTIONS).index(motion)]
    for k in range(1, len(cells)):
        quantity = f"{motion}: order in space, h = 1/{cells[k - 1]} to 1/{cells[k]}"
        order = math.log2(errors[k - 1] / errors[k])
        if k == len(cells) - 1:
            case.gate(quantity, order, method=method, tolerance=(LEAST, math.inf), reference=expected)
        else:
            case.show(quantity, order, reference=expected, method=method)


def amplitude(motion: str) -> float:
    """Root mean square of the exact displacement at the end [m]."""
    scene, exact = MOTIONS[motion]
    if scene == "square.toml":
        axis = (np.arange(200) + 0.5) / 200.0
        start = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        weight = np.ones(len(start))
    else:
        radius = 0.75 + 0.5 * (np.arange(400) + 0.5) / 400.0
        start, weight = np.stack([radius, np.zeros_like(radius)], axis=1), radius
    square = ((exact.position(start, exact.end) - start) ** 2).sum(axis=1)
    return float(np.sqrt(weight @ square / weight.sum()))


def in_time(case: Case, method: Method, motion: Motion, speed: str, binds: bool) -> None:
    """Differences from a very small step at h = 1/16 [m], by step; and their orders."""
    with case.timed():
        finest, *ends = (
            displaced("square.toml", motion, method.shape, 1.0 / 16.0, courant)[0]
            for courant in (FINEST, *STEPS)
        )
    errors = np.array([root_mean_square(end - finest) for end in ends])
    for k in range(1, len(STEPS)):
        order = math.log2(errors[k - 1] / errors[k])
        quantity = f"{speed}: order in time, c Δt / h = {STEPS[k - 1]:g} to {STEPS[k]:g}"
        limits = {"tolerance": (LEAST, math.inf), "reference": TIME_ORDER}
        case.gate(quantity, order, method=method, binds=binds and k == len(STEPS) - 1, **limits)
