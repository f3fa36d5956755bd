"""What a step costs: nanoseconds per material point by stage, and the ratio to a plain loop of the same
arithmetic.

    python tests/benchmarks/stepper.py [--shapes linear,gimp,bspline,cpdi] [--counts 600,17600] [--dim 2]
    [--repeats 30] [--keep] python tests/benchmarks/stepper.py --rings [--shapes linear,gimp,bspline,cpdi]
    [--repeats 30] [--keep]

The points are those of a block, slightly irregular, or with --rings those of the scene colliding-rings. The
plain loop is the fastest of g++'s and clang++'s, with an interpolation table and without; samples of all
alternate. With
--keep the ratios go to history.csv beside this file, with the commit that they are of.
"""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console

sys.path.insert(0, str(Path(__file__).parents[1]))

from mpmfw.benchmark import table
from mpmfw.campaigns.work import Load, processor
from yardstick.kernels import SHAPES, measure_kernels, measure_rings
from yardstick.plain import compiler_version, compilers

HISTORY = Path(__file__).with_name("history.csv")
KEPT = ("points", "dim", "shape", "particles", "loop", "ratio", "ratio_low", "ratio_high")


def keep(rows: list[dict[str, object]], busy: float) -> None:
    """Add the rows' ratios to the history, with date, commit, processor and how many cores others kept
    busy.
    """
    head = ("git", "describe", "--always", "--dirty")
    commit = subprocess.run(
        head, cwd=HISTORY.parent, check=True, capture_output=True, text=True
    ).stdout.strip()
    labels = {
        "date": datetime.now(UTC).date().isoformat(),
        "commit": commit,
        "processor": processor(),
        "busy": round(busy, 1),
    }
    new = not HISTORY.exists()
    with HISTORY.open("a", newline="") as file:
        writer = csv.writer(file)
        if new:
            writer.writerow([*labels, *KEPT])
        for row in rows:
            values = [row[name] for name in KEPT]
            writer.writerow(
                [*labels.values(), *(f"{one:.3f}" if isinstance(one, float) else one for one in values)]
            )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shapes", default=",".join(SHAPES))
    parser.add_argument("--counts", default="600,17600")
    parser.add_argument("--rings", action="store_true")
    parser.add_argument("--dim", type=int, default=2, choices=(2, 3))
    parser.add_argument("--repeats", type=int, default=30)
    parser.add_argument("--keep", action="store_true")
    chosen = parser.parse_args()
    counts = [int(text) for text in chosen.counts.split(",")]
    load = Load()
    shapes, points = chosen.shapes.split(","), "rings" if chosen.rings else "block"
    if chosen.rings:
        rows = measure_rings(shapes, chosen.repeats)
    else:
        rows = measure_kernels(shapes, counts, chosen.repeats, dim=chosen.dim)
    busy = load.others()
    console = Console(width=170)
    rows = [{**row, "points": points} for row in rows]
    console.print(
        table(rows, f"{points} in {rows[0]['dim']}D, without contact: ns per material point and step")
    )
    said = "; ".join(map(compiler_version, compilers())) or "no C++ compiler"
    console.print(f"{processor()}; {said}; other processes kept {busy:.1f} cores busy")
    if chosen.keep:
        keep(rows, busy)
