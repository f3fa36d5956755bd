"""What bodies asleep cost: a hundred blocks at rest beside one that moves, over the one that moves alone.

    python tests/benchmarks/sleeping.py [--blocks 100] [--contact penalty] [--rounds 7]

Prints CPU time of a step of the block alone, of all blocks while the others sleep, and of all awake, each the
least of rounds that are taken by turns, and their ratios."""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))  # also when it is run as a script

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of, solid

#: Edges of the moving block and of those at rest, and distance of their centres, in cells.
MOVING, RESTING, PITCH = 24, 8, 20
#: Steps before anything is timed, in which bodies fall asleep, and of each round.
BEFORE, STEPS = 200, 100


def block(centre, edge, **more):
    """A square of ``edge`` cells of a metre."""
    lower, upper = ([x + side * 0.5 * edge for x in centre] for side in (-1.0, 1.0))
    return solid(lower, upper, 0.5, **more)


def scene(blocks, contact, **more):
    """So many blocks at rest on a lattice, and one that moves beside them."""
    side = int(np.ceil(np.sqrt(max(blocks, 1))))
    bodies = {"moving": block((0.0, -40.0), MOVING, velocity=[2.0, -0.5], angular_velocity=0.05)}
    for k in range(blocks):
        bodies[f"b{k}"] = block((PITCH * (k // side), PITCH * (k % side)), RESTING)
    upper = [PITCH * side + 20.0] * 2
    tables = {"contact": {"method": contact}} if blocks else {}
    return scene_of(bodies, 1.0, [-40.0, -80.0], upper, end=1e3, **tables, **more)


def cost(simulation):
    """CPU time of a step [s]."""
    start = time.process_time()
    for _ in range(STEPS):
        simulation.step()
    return (time.process_time() - start) / STEPS


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blocks", type=int, default=100)
    parser.add_argument("--contact", default="penalty")
    parser.add_argument("--rounds", type=int, default=7)
    asked = parser.parse_args()
    runs = {
        "alone": Simulation(scene(0, asked.contact)),
        "asleep": Simulation(scene(asked.blocks, asked.contact, sleep={"crossings": 2.0})),
        "awake": Simulation(scene(asked.blocks, asked.contact)),
    }
    for run in runs.values():
        run.advance(BEFORE)
    least = dict.fromkeys(runs, np.inf)
    for _ in range(asked.rounds):
        least = {name: min(least[name], cost(run)) for name, run in runs.items()}
    for name, run in runs.items():
        points, ratio = run.state.particles.count, least[name] / least["alone"]
        print(f"{name:7s} {points:7d} points {1e6 * least[name]:9.1f} us a step {ratio:8.3f} of alone")
