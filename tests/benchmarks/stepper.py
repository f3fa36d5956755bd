"""What a step costs: nanoseconds per material point by stage, and the ratio to a plain loop of the same
arithmetic.

    python tests/benchmarks/stepper.py [--shapes linear,gimp,bspline,cpdi] [--counts 600,17600] [--dim 2]
    [--repeats 30]
    python tests/benchmarks/stepper.py --rings [--shapes linear,gimp,bspline,cpdi] [--repeats 30]

The points are those of a block, slightly irregular, or with --rings those of the scene colliding-rings. The
step has an affine transfer, update stress last, neo-Hookean material and no contact. The plain loop is the
fastest of g++'s and clang++'s, with an interpolation table and without."""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from mpmfw.benchmark import stage_times
from mpmfw.campaigns.work import Load, processor
from mpmfw.cli.tables import print_table
from yardstick.block import make_block, make_rings
from yardstick.plain import ENTRIES, STAGES, PlainLoop, compiler_version, compilers

#: One sample steps so often that it moves at least this many points: a timer's noise does not count.
POINTS_PER_SAMPLE = 20_000


def measure(shape, block, repeats):
    """Return the least CPU time of a step [ns per point], its stages, that of the fastest plain loop, and the
    median of the pairs' ratios with its quartiles.

    Samples of the stepper and of the plain loops alternate, so that all meet the same disturbances."""
    plains = _plain_steps(shape, block)
    n = block.state.particles.count
    steps = max(1, -(-POINTS_PER_SAMPLE // n))
    _sample_block(block, 1)
    for step in plains.values():
        _sample_plain(step, 1)
    wall, ours = np.zeros((repeats, len(STAGES))), np.zeros(repeats)
    theirs = np.zeros((len(plains), repeats))
    for repeat in range(repeats):
        ours[repeat], wall[repeat] = _sample_block(block, steps)
        theirs[:, repeat] = [_sample_plain(step, steps) for step in plains.values()]
    fastest = int(theirs.min(axis=1).argmin())
    to_ns = 1e9 / (n * steps)
    low, median, high = np.quantile(ours / theirs[fastest], [0.25, 0.5, 0.75])
    times = stage_times(wall, ours) * to_ns
    return {
        "shape": shape,
        "dim": block.state.particles.dim,
        "particles": n,
        **{f"ns_{stage}": float(time) for stage, time in zip(STAGES, times, strict=True)},
        "ns_total": float(ours.min() * to_ns),
        "ns_plain": float(theirs[fastest].min() * to_ns),
        "loop": list(plains)[fastest],
        "ratio": median,
        "ratio_low": low,
        "ratio_high": high,
    }


def _plain_steps(shape, block):
    """A step of every plain loop that there is, by what it is; there must be a C++ compiler."""
    found = {}
    for path in compilers():
        loop = PlainLoop(shape, block, compiler=path)
        found |= {f"{loop.language}, table": loop.step, f"{loop.language}, no table": loop.whole}
    return found


def _sample_block(block, steps):
    """CPU seconds of so many steps, and wall seconds by stage."""
    block.clock.restart()
    for _ in range(steps):
        block.step()
    block.clock("output")
    block.clock.flush()
    return sum(block.clock.cpu.values()), [block.clock.wall[stage] for stage in STAGES]


def _sample_plain(step, steps):
    """CPU seconds of so many steps of a plain loop."""
    begin = time.process_time()
    for _ in range(steps):
        step()
    return time.process_time() - begin


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shapes", default=",".join(ENTRIES))
    parser.add_argument("--counts", default="600,17600")
    parser.add_argument("--rings", action="store_true")
    parser.add_argument("--dim", type=int, default=2, choices=(2, 3))
    parser.add_argument("--repeats", type=int, default=30)
    chosen = parser.parse_args()
    load, shapes, points = Load(), chosen.shapes.split(","), "rings" if chosen.rings else "block"
    counts = [None] if chosen.rings else [int(text) for text in chosen.counts.split(",")]
    rows = []
    for shape in shapes:
        for count in counts:
            block = make_rings(shape) if count is None else make_block(shape, count, chosen.dim)
            rows.append({**measure(shape, block, chosen.repeats), "points": points})
    busy = load.others()
    title = f"{points} in {rows[0]['dim']}D, without contact: ns per material point and step"
    print_table(rows, labels=("shape",), title=title)
    said = "; ".join(map(compiler_version, compilers())) or "no C++ compiler"
    print(f"{processor()}; {said}; other processes kept {busy:.1f} cores busy")
