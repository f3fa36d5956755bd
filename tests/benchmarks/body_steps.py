"""What steps of its own for every body could gain on the rolling cylinder, and whether they are stable at
contacts.

    python tests/benchmarks/body_steps.py

The plane is ten times as stiff as the cylinder, so that its waves make the step √10 shorter than the cylinder
needs. Three measurements: a step that leaves the plane's waves out; what the plane's part of a step costs;
and the spectral radius of two elastic bars in contact, of which the stiff one takes M steps in one of the
other's."""

from __future__ import annotations

import itertools
import math
import sys
import time
import tomllib
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray

SCENE, STEPS, ROUNDS = "rolling-cylinder-no-slip", 100, 15
#: Elements of each bar, and steps of the stiff one in one of the other's: √10 of them and no less.
ELEMENTS, MANY = 20, 4


def scene(**changes: Any) -> dict[str, Any]:
    """The shipped scene without settling, with other top-level tables."""
    text = (files("mpmfw") / "scenes" / f"{SCENE}.toml").read_text()
    made = {name: value for name, value in tomllib.loads(text).items() if name != "settle"}
    return {**made, **changes}


def long_steps() -> None:
    """A fixed step of 0.8 h / c of the cylinder, which the plane's waves do not limit."""
    cell = Simulation(scene()).state.grid.cell_size
    for share in (0.30, 0.35, 0.5, 0.8):
        step = {"end": 0.5, "output_interval": 0.01, "step": share * cell / 100.0}
        sim = Simulation(scene(time=step, allow_unstable=True))
        try:
            sim.run()
            said = f"ran {sim.state.steps} steps"
        except MpmfwError as error:
            said = str(error).splitlines()[0]
        print(f"step {share:.2f} h/c of the cylinder, {share * 10**0.5:.2f} h/c of the plane: {said}")


def costs() -> None:
    """Least CPU time of a step of both bodies, and of each alone, and what the best division of steps would
    gain.
    """
    both = scene()
    alone = {}
    for name in ("cylinder", "plane"):
        alone[name] = {**both, "bodies": {name: both["bodies"][name]}}
        for table in ("contact", "reference", "gravity"):  # nothing would hold the cylinder
            del alone[name][table]
    sims = {"both": Simulation(both), **{name: Simulation(one) for name, one in alone.items()}}
    least = dict.fromkeys(sims, np.inf)
    for sim in sims.values():
        sim.advance(STEPS)
    for _ in range(ROUNDS):
        for name, sim in sims.items():
            begin = time.process_time()
            sim.advance(STEPS)
            least[name] = min(least[name], (time.process_time() - begin) / STEPS * 1e6)
    contact = least["both"] - least["cylinder"] - least["plane"]
    print(
        f"a step: {', '.join(f'{name} {value:.0f} µs' for name, value in least.items())}, the rest "
        f"{contact:.0f} µs"
    )
    apart = (MANY - 1) * least["cylinder"]
    once = apart + (MANY - 1) * max(contact, 0.0)
    for what, spared in (("contact in every step of the plane", apart), ("contact once", once)):
        gain = MANY * least["both"] / (MANY * least["both"] - spared)
        print(f"  {what}: at most {gain:.2f} × faster for {MANY} steps of the plane")


def bar_force(u: FloatArray, stiffness: float) -> FloatArray:
    """Force on the nodes of a bar of springs."""
    pull = stiffness * np.diff(u)
    force = np.zeros_like(u)
    force[:-1] += pull
    force[1:] -= pull
    return force


def divided_step(
    state: FloatArray, dt: float, ratio: float, kappa: float, *, contact: str, many: int
) -> FloatArray:
    """One step of a soft bar and ``many`` of a stiff one, whose ends are joined by a contact spring.

    Element size and mass of a node are 1, so that c² is the stiffness. The ``contact`` force of a step's
    beginning is "held" over the stiff bar's steps, or acts as one "impulse" on both ends, or is "asked" in
    each of the stiff bar's steps and acts on both. The last two are symplectic: there is an energy near to
    the true one that they keep, where they are stable."""
    soft, stiff, v_soft, v_stiff = (part.copy() for part in state.reshape(4, ELEMENTS + 1))
    mass = np.ones(ELEMENTS + 1)
    mass[[0, -1]] = 0.5
    small = dt / many
    pressed = kappa * (stiff[0] - soft[-1])
    v_soft += dt * bar_force(soft, 1.0) / mass
    if contact != "asked":
        v_soft[-1] += dt * pressed / mass[-1]
    if contact == "impulse":
        v_stiff[0] -= dt * pressed / mass[0]
    for _ in range(many):
        if contact == "asked":
            pressed = kappa * (stiff[0] - soft[-1])
            v_soft[-1] += small * pressed / mass[-1]
        if contact != "impulse":
            v_stiff[0] -= small * pressed / mass[0]
        v_stiff += small * bar_force(stiff, ratio) / mass
        v_stiff[-1] = 0.0  # fixed
        stiff += small * v_stiff
        soft += small * v_soft
    return np.concatenate([soft, stiff, v_soft, v_stiff])


def growth(dt: float, ratio: float, kappa: float, *, contact: str, many: int) -> float:
    """Spectral radius of a step."""
    eye = np.eye(4 * (ELEMENTS + 1))
    made = np.column_stack([divided_step(one, dt, ratio, kappa, contact=contact, many=many) for one in eye])
    return float(np.abs(np.linalg.eigvals(made)).max())


def stability() -> None:
    """Shares of steps that grow, up to half of the soft bar's limit with its contact and from there to 0.8,
    and the first.

    Scenes take half of the limit, if they do not say otherwise.
    """
    shares = np.linspace(0.2, 0.8, 121)
    print("stiffness  kappa  contact             to 0.5  to 0.8  largest growth  the first that grows")
    for ratio, kappa in itertools.product((10.0, 100.0), (0.25, 1.0, 4.0)):
        limit = 2.0 / np.sqrt(4.0 + 4.0 * kappa)  # 2 / √(ω_bulk² + ω²), as the penalty contact asks
        many = math.ceil(ratio**0.5)
        kinds = [
            ("one step for both", "impulse", 1),
            *((kind, kind, many) for kind in ("held", "impulse", "asked")),
        ]
        for name, contact, steps in kinds:
            dt = shares * limit / (ratio**0.5 if steps == 1 else 1.0)
            found = np.array([growth(each, ratio, kappa, contact=contact, many=steps) for each in dt])
            grows, half = found > 1.0 + 1e-9, shares <= 0.5
            first = f"{dt[grows][0] * ratio**0.5:.2f} h/c of the stiff bar" if grows.any() else ""
            low, high = 100.0 * grows[half].mean(), 100.0 * grows[~half].mean()
            largest = max(found.max() - 1.0 - 1e-9, 0.0)
            print(
                f"{ratio:9.0f}  {kappa:5.2f}  {name:18} {low:5.1f} % {high:5.1f} % {largest:15.1e}  {first}"
            )


MEASURED: tuple[Callable[[], None], ...] = (long_steps, costs, stability)

if __name__ == "__main__":
    for measured in MEASURED:
        measured()
        sys.stdout.flush()
