"""Two rigid masses on one penalty spring: the product's steps, and the same motion as two numbers."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mpmfw.errors import SimulationError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

FOLDER = Path(__file__).parent

# Of scene.toml. The stiffness is that of one of two passes: k = κ M l_trib / (2 h), l_trib across the normal.
LIGHT, HEAVY = 1.0 * (0.02 * 0.02 + 0.5 * 0.02 * 0.004), 2.0 * 0.02 * 0.02  # kg/m
STIFFNESS = 0.5 * 1e4 * 0.01  # N/m²
REDUCED = LIGHT * HEAVY / (LIGHT + HEAVY)
FREQUENCY = math.sqrt(STIFFNESS / REDUCED)  # rad/s
LIMIT = 2.0 / FREQUENCY  # s
CONTACT = math.pi / FREQUENCY  # s: half a period

PRESSURE, HEIGHT = 1e-4, 0.02  # Pa, m: of the preload
SPEED = 1e-4  # m/s: of approach


def scene(gap: float, shape: str = "cpdi", **bodies: Any) -> Any:
    """The scene with the plate ``gap`` [m] from the tip; keys of bodies as ``tip__velocity``."""
    values = {f"bodies.{key.replace('__', '.')}": value for key, value in bodies.items()}
    moved = {
        "bodies.plate.geometry.lower": [0.5 + gap, 0.49],
        "bodies.plate.geometry.upper": [0.52 + gap, 0.51],
        "shape.method": shape,
    }
    return load_scene(FOLDER / "scene.toml", set=moved | values)


def stays(step: float, shape: str = "cpdi", steps: int = 600) -> bool:
    """Return whether the pressed masses, a thousandth beside rest, stay within half of the rest's depth."""
    depth = PRESSURE * HEIGHT / STIFFNESS
    pressed = {
        f"{body}__sides": [{"side": side, "pressure": PRESSURE}]
        for body, side in (("tip", "left"), ("plate", "right"))
    }
    sim = Simulation(scene(-0.999 * depth, shape, **pressed))
    sim.start()
    for _ in range(steps):
        try:
            sim.step(step)
        except SimulationError:
            return False
        rows = sim.contact.last_rows
        gap = rows.gap[: rows.count].min(initial=0.0)
        if not -1.5 * depth < gap < -0.5 * depth:
            return False
    return True


def bisect(stable: Callable[[float], bool], low: float, high: float, relative: float) -> float:
    """The largest stable step between two [s]; NaN if the lower one is not stable."""
    if not stable(low):
        return math.nan
    if stable(high):
        return math.inf
    while high / low > 1.0 + relative:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return math.sqrt(low * high)


def impact(steps: float, phase: float) -> tuple[float, int]:
    """Let the masses meet: ``steps`` a contact, the first touch after ``phase`` of a step.

    Returns the relative velocity squared over that before, less 1, and the steps with a contact force.
    """
    step = CONTACT / steps
    share = SPEED / (LIGHT + HEAVY)
    moving = {"tip__velocity": [share * HEAVY, 0.0], "plate__velocity": [-share * LIGHT, 0.0]}
    sim = Simulation(scene(max(phase, 1e-9) * SPEED * step, **moving))
    sim.start()
    touching = 0
    for _ in range(4 + math.ceil(3.0 * steps)):
        sim.step(step)
        rows = sim.contact.last_rows
        acts = bool(np.abs(rows.force[: rows.count]).max(initial=0.0) > 0.0)
        if touching and not acts:
            break
        touching += acts
    p, bodies = sim.state.particles, sim.state.bodies
    velocity = [np.average(p.velocity[b.particles, 0], weights=p.mass[b.particles]) for b in bodies]
    return float((velocity[1] - velocity[0]) / SPEED) ** 2 - 1.0, touching


def exact_gain(steps: float, phase: float) -> float:
    """Return the gain of v ← v + Δt ω² max(−x, 0), x ← x + Δt v, symplectic Euler."""
    step = 1.0 / steps
    gap, velocity, touched = phase * step, -1.0, False
    while not (touched and gap > 0.0):
        velocity += step * math.pi**2 * max(-gap, 0.0)
        gap += step * velocity
        touched = touched or gap < 0.0
    return velocity**2 - 1.0


def realistic(values: dict[str, Any], steps: int) -> tuple[float, float]:
    """Press two blocks and find the step at which velocities pass four times those of a small step.

    Returns the least limit of the strategy while the pair was pressed, before the safety factor, and the step
    that holds, by bisection [h/c]."""
    loaded = load_scene(FOLDER / "pair.toml", set=values)
    bulk = Simulation(loaded).limits()[0][0]
    reported: list[float] = []
    calm = press(loaded, 0.1 * bulk, 40.0 * bulk, reported)

    def stable(step: float) -> bool:
        return press(loaded, step, steps * step) < 4.0 * calm

    return min(reported) / bulk, bisect(stable, 0.1 * bulk, 2.0 * bulk, 0.01) / bulk


def press(loaded: Any, step: float, end: float, reported: list[float] | None = None) -> float:
    """Largest speed of a point in all steps [m/s], infinite where the run broke down.

    Limits of the step while the pair is pressed are added to ``reported``."""
    sim = Simulation(loaded)
    sim.start()
    fastest = 0.0
    while sim.state.time < end:
        try:
            sim.step(step)
        except SimulationError:
            return math.inf
        speed = float(np.abs(sim.state.particles.velocity).max())
        if not speed < 1e3:
            return math.inf
        fastest = max(fastest, speed)
        if reported is not None and sim.contact.last_rows.count:
            reported.append(min(limit for limit, _ in sim.limits()))
    return fastest
