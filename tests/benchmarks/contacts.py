"""What contact costs: a step of the rings as they touch, over one in which both share a velocity field.

    python tests/benchmarks/contacts.py [--shapes linear,gimp,bspline,cpdi,cpdi2] [--repeats 15]

``separate`` has a field for each ring, with its rotation corrected, and no contact: what is beyond it is contact's. Samples of
all methods alternate; a figure is the least of a method's samples over the least of ``none``.
"""

from __future__ import annotations

import argparse
import time

from mpmfw.simulation import Simulation

METHODS = ("none", "separate", "bardenhagen", "penalty")
#: Steps after which the rings touch, and steps of a sample.
BEFORE, SAMPLE = 270, 10


def measure(shape: str, repeats: int) -> dict[str, float]:
    """Least CPU time of a step by method, over the points [ns]."""
    sims = {method: Simulation("colliding-rings", contact=method, shape=shape) for method in METHODS}
    for sim in sims.values():
        sim.advance(BEFORE)
    least = dict.fromkeys(METHODS, float("inf"))
    for _ in range(repeats):
        for method, sim in sims.items():
            begin = time.process_time()
            sim.advance(SAMPLE)
            taken = (time.process_time() - begin) / SAMPLE / sim.state.particles.count * 1e9
            least[method] = min(least[method], taken)
    return least


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--shapes", default="linear,gimp,bspline,cpdi,cpdi2")
    parser.add_argument("--repeats", type=int, default=15)
    asked = parser.parse_args()
    print(f"shape    none [ns]  {'  '.join(f'{method:>11}' for method in METHODS[1:])}")
    for shape in asked.shapes.split(","):
        times = measure(shape, asked.repeats)
        ratios = "  ".join(f"{times[method] / times['none']:11.2f}" for method in METHODS[1:])
        print(f"{shape:8} {times['none']:9.1f}  {ratios}", flush=True)
