"""The cost of hooks, plan and clock: a step of the simulation against one written out for the scene.

    python tests/benchmarks/overhead.py [--points 20000] [--pairs 200]

Both run in one process on the same arrays, from the same state, which is restored before every sample; which
of the two comes first alternates. The overhead is the median of the pairs' ratios."""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]  # also when it is run as a script

from written_out import OneBody, TwoApart  # noqa: E402

from mpmfw.benchmark import quartiles  # noqa: E402
from mpmfw.runs.simulation import Simulation  # noqa: E402
from scenes_for_tests import scene_of, solid  # noqa: E402

POINTS, PAIRS, STEPS, WARM_UP = 20_000, 200, 3, 20


def scene(gap, friction, points):
    """One square of a metre, or two of half the points that approach at 1 m/s."""
    bodies = 1 if gap is None else 2
    edge = round((points / bodies) ** 0.5)
    h = 2.0 / edge
    made = {}
    for name, left, speed in (("left", -1.0, 1.0), ("right", gap, -1.0))[:bodies]:
        moves = {"velocity": [speed, 0.3 * speed], "rotation": "lumped"}
        made[name] = solid([left, 0.0], [left + 1.0, 1.0], 0.5 * h, **moves)
    tables = {"contact": {"method": "penalty", "friction": friction}} if bodies == 2 else {}
    output = {"gap": False, "particles": False}
    return scene_of(made, h, [-3.0, -1.0], [3.0, 2.0], end=1.0, output=output, **tables)


SCENES = {
    "one body": (OneBody, None, 0.0),
    "two bodies apart": (TwoApart, 1.0, 0.3),
    "frictionless": (TwoApart, 0.0, 0.0),
    "frictional": (TwoApart, 0.0, 0.3),
}


def reached(simulation):
    """The points and what contact did to them, copied."""
    p, contact = simulation.state.particles, simulation.contact
    arrays = [p.position, p.velocity, p.deformation_gradient, p.stress]
    arrays += [] if contact is None else list(contact.records.members().values())
    return [array.copy() for array in arrays]


def prepared(name, points):
    """A scene after some steps, its reference step, and its state, from which both must reach the same."""
    reference, gap, friction = SCENES[name]
    simulation = Simulation(scene(gap, friction, points))
    simulation.advance(WARM_UP)
    written, snapshot = reference(simulation), simulation.snapshot()
    both = []
    for step in (simulation.step, written.step):
        simulation.restore(snapshot)
        for _ in range(STEPS):
            step()
        both.append(reached(simulation))
    for ours, theirs in zip(*both, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    return simulation, written, snapshot


def sample(step, simulation, snapshot, steps):
    """CPU seconds of some steps from the snapshot on."""
    simulation.restore(snapshot)
    begin = time.process_time()
    for _ in range(steps):
        step()
    return time.process_time() - begin


def measure(name, points=POINTS, pairs=PAIRS):
    """Nanoseconds per point and step of both, their difference a step, the median ratio with its
    quartiles.
    """
    simulation, written, snapshot = prepared(name, points)

    times = np.zeros((pairs, 2))
    for index in range(pairs):
        for which in (0, 1) if index % 2 else (1, 0):
            times[index, which] = sample((simulation.step, written.step)[which], simulation, snapshot, STEPS)
    count = simulation.state.particles.count
    low, ratio, high = quartiles(times[:, 0] / times[:, 1])
    ours, theirs = np.median(times, axis=0) * 1e9 / (count * STEPS)
    return {
        "points": count,
        "ns": ours,
        "ns_reference": theirs,
        "extra": float(np.median(times[:, 0] - times[:, 1])) * 1e6 / STEPS,
        "ratio": ratio,
        "low": low,
        "high": high,
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--points", type=int, default=POINTS)
    parser.add_argument("--pairs", type=int, default=PAIRS)
    asked = parser.parse_args()
    print("scene              points       ns  written out  µs a step   ratio  quartiles")
    for name in SCENES:
        row = measure(name, asked.points, asked.pairs)
        times = f"{row['ns']:8.1f} {row['ns_reference']:12.1f} {row['extra']:10.1f}"
        interval = f"{row['ratio']:7.4f}  {row['low']:.4f} … {row['high']:.4f}"
        print(f"{name:17} {row['points']:7.0f} {times} {interval}", flush=True)
