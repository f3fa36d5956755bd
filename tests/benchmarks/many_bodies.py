"""How cost grows with the number of bodies: touching discs, each count beside two discs of the same size.

    python tests/benchmarks/many_bodies.py [--bodies 100 400 1000] [--contact penalty] [--write FILE]

Prints seconds to build and of a frame, nanoseconds a point and step, and the ratio of these to two discs,
whose steps are timed between those of the many: figures of one machine at one time, of which only the ratios
mean something."""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # also when it is run as a script

from many_discs import many_discs
from mpmfw.results.writing import RunWriter
from mpmfw.runs.simulation import Simulation

#: Steps of the two discs for one of the many, rounds of both.
STEPS_OF_TWO, ROUNDS = 100, 5


def seconds(act: Callable[[], object]) -> float:
    """CPU time of a call."""
    start = time.process_time()
    act()
    return time.process_time() - start


def a_point(simulation: Simulation, steps: int) -> float:
    """CPU time a material point and step [ns]."""
    return 1e9 * seconds(lambda: simulation.advance(steps)) / steps / simulation.state.particles.count


def measure(count: int, contact: str, path: str | None) -> str:
    """A line of the table."""
    two = Simulation(many_discs(2, contact))
    made: list[Simulation] = []
    build = seconds(lambda: made.append(Simulation(many_discs(count, contact))))
    many = made[0]
    two._recorder.frame(0.0)  # what is compiled or loaded with the first call is not timed
    two.advance(STEPS_OF_TWO)
    many.advance(2)
    ratios, costs = [], []
    for _ in range(ROUNDS):
        few, cost = a_point(two, STEPS_OF_TWO), a_point(many, 2)
        ratios.append(cost / few)
        costs.append(cost)
    frame = many._recorder.frame(0.0)
    framing = seconds(lambda: many._recorder.frame(0.0))
    line = (
        f"{count:6d} {len(many.state.pairs):8d} {build:9.2f} {statistics.median(costs):9.0f} "
        f"{statistics.median(ratios):9.2f} {framing:9.3f}"
    )
    if path is not None:
        with RunWriter(path, many.header()) as writer:
            writer.write(frame)
            writing = seconds(lambda: writer.write(frame))
        line += f" {writing:9.2f} {os.path.getsize(path) / 1e6:9.1f}"
    return line


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--bodies", type=int, nargs="+", default=[100, 400, 1000])
    parser.add_argument("--contact", default="penalty")
    parser.add_argument(
        "--write", metavar="FILE", help="also write two frames, and say how long and how large"
    )
    asked = parser.parse_args()
    print(
        "bodies    pairs build [s] ns/point of two  frame [s]"
        + (" write [s] file [MB]" if asked.write else "")
    )
    for count in asked.bodies:
        print(measure(count, asked.contact, asked.write), flush=True)


if __name__ == "__main__":
    main()
