"""Run Newton's implicit MPM on the input of a folder. Newton's interpreter runs this; it imports no mpmfw."""

from __future__ import annotations

import json
import math
import sys
import time
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Any

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverImplicitMPM

#: Length of a step of settling, in steps of the motion, and most of them.
LONGER, MOST = 10.0, 200


def make_model(facts: dict[str, Any], points: Any) -> Any:
    """Return points and plane; nothing yields, and nothing damps."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Y)
    SolverImplicitMPM.register_custom_attributes(builder)
    volume, count = points["volume"], len(points["volume"])
    per_point = {
        "young_modulus": facts["young_modulus"],
        "poisson_ratio": facts["poisson_ratio"],
        "damping": 0.0,
        "viscosity": 0.0,
        "friction": 0.0,
        "tensile_yield_ratio": 1.0,
        "yield_stress": 1e15,
    }
    builder.add_particles(
        pos=[wp.vec3(*each) for each in points["position"].tolist()],
        vel=[wp.vec3(*each) for each in points["velocity"].tolist()],
        mass=(facts["density"] * volume).tolist(),
        radius=(0.5 * np.cbrt(volume)).tolist(),
        custom_attributes={f"mpm:{name}": [value] * count for name, value in per_point.items()},
    )
    plane = newton.ModelBuilder.ShapeConfig(mu=facts["friction"])
    builder.add_ground_plane(height=facts["height"], cfg=plane)
    return builder.finalize(device=facts["device"])


def make_solver(model: Any, facts: dict[str, Any]) -> Any:
    """Return the solver, without the drag of air that is its default."""
    config = SolverImplicitMPM.Config()
    config.grid_type, config.air_drag, config.voxel_size = "dense", 0.0, facts["cell_size"]
    for name in ("collider_basis", "tolerance", "max_iterations"):
        setattr(config, name, facts[name])
    return SolverImplicitMPM(model, config=config)


def advance(solver: Any, states: list[Any], step: float, when: str) -> None:
    """Take a step from the first state to the second and exchange them; end unless the motion is finite."""
    solver.step(*states, None, None, step)
    states.reverse()
    if not np.isfinite(states[0].particle_q.numpy()).all():  # the next step would end with another error
        sys.exit(f"the motion is not finite {when}")


def position_of(state: Any) -> Any:
    """Return a copy: numpy() of a state on the CPU is a view, which later steps overwrite."""
    return state.particle_q.numpy().copy()


def settle(model: Any, states: list[Any], facts: dict[str, Any], step: float) -> tuple[int, bool]:
    """Take long steps under the gravity of rest, each from rest; return steps and success."""
    model.set_gravity(tuple(facts["settle_gravity"]))
    solver, first = make_solver(model, facts), position_of(states[0])
    for steps in range(1, MOST + 1):
        before = position_of(states[0])
        states[0].particle_qd.zero_()
        states[0].mpm.particle_qd_grad.zero_()
        advance(solver, states, LONGER * step, "in settling")
        now = position_of(states[0])
        if np.abs(now - before).max() <= facts["settle_tolerance"] * np.abs(now - first).max():
            return steps, True
    return MOST, False


def main(folder: Path) -> None:
    """Write ``motion.npz``, then ``motion.json``."""
    facts = json.loads((folder / "newton.json").read_text(encoding="utf-8"))
    with np.load(folder / "points.npz", allow_pickle=False) as file:
        points = dict(file)
    times = facts["times"]
    intervals = [b - a for a, b in pairwise(times)]
    substeps = [math.ceil(interval / facts["step"] - 1e-9) for interval in intervals]
    step = max(interval / count for interval, count in zip(intervals, substeps, strict=True))
    model = make_model(facts, points)
    states, start = [model.state(), model.state()], time.perf_counter()
    model.set_gravity(tuple(facts["gravity"]))
    make_solver(model, facts).step(*states, None, None, 0.1 * step)  # compiles; the result is not used
    costs = {"compile_time": time.perf_counter() - start, "settle_time": 0.0}
    settle_steps, settled = 0, True
    if facts["settle_gravity"] is not None:
        begin = time.process_time()
        settle_steps, settled = settle(model, states, facts, step)
        costs["settle_time"] = time.process_time() - begin
        model.set_gravity(tuple(facts["gravity"]))
    states[0].particle_qd.assign(points["velocity"].astype(np.float32))
    gradient = np.broadcast_to(points["gradient"].astype(np.float32), (len(points["volume"]), 3, 3))
    states[0].mpm.particle_qd_grad.assign(np.ascontiguousarray(gradient))
    position, velocity = [position_of(states[0])], [states[0].particle_qd.numpy().copy()]
    solver, begin, start = make_solver(model, facts), time.process_time(), time.perf_counter()
    for end, interval, count in zip(times[1:], intervals, substeps, strict=True):
        for _ in range(count):
            advance(solver, states, interval / count, f"at {end:.6g} s")
        position.append(position_of(states[0]))
        velocity.append(states[0].particle_qd.numpy().copy())
    costs |= {"cpu_time": time.process_time() - begin, "wall_time": time.perf_counter() - start}
    np.savez_compressed(folder / "motion.npz", time=times, position=position, velocity=velocity)
    result = {
        "versions": {name: version(name) for name in ("newton", "warp-lang", "numpy")},
        "device": model.device.name if facts["device"] == "cuda" else "CPU",
        "step": step,
        "steps": sum(substeps),
        "settle_steps": settle_steps,
        "settled": settled,
        **costs,
    }
    (folder / "motion.json").write_text(json.dumps(result, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
