"""What a step costs: nanoseconds per material point by stage, and the ratio to a plain loop of the same arithmetic.

    python tests/benchmarks/stepper.py [--shapes linear,gimp,bspline,cpdi] [--counts 600,17600] [--dim 2] [--repeats 30]

The plain loop is C++ where there is a compiler; samples of both alternate.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rich.console import Console

sys.path.insert(0, str(Path(__file__).parents[1]))

from mpmfw.benchmark import table
from mpmfw.campaigns.machine import Load, processor
from yardstick.kernels import SHAPES, measure_kernels
from yardstick.plain import FLAGS, compiler_version

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shapes", default=",".join(SHAPES))
    parser.add_argument("--counts", default="600,17600")
    parser.add_argument("--dim", type=int, default=2, choices=(2, 3))
    parser.add_argument("--repeats", type=int, default=30)
    chosen = parser.parse_args()
    counts = [int(text) for text in chosen.counts.split(",")]
    load = Load()
    rows = measure_kernels(chosen.shapes.split(","), counts, chosen.repeats, dim=chosen.dim)
    console = Console(width=170)
    console.print(table(rows, f"{chosen.dim}D block without contact: ns per material point and step"))
    console.print(
        f"{processor()}; {compiler_version()} {' '.join(FLAGS[:2])}; other processes kept {load.others():.1f} cores busy"
    )
