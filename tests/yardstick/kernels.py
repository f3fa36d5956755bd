"""Time of the real stepper on a synthetic block, against a plain loop in the same run."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmfw.benchmark.sampling import quartiles, stage_times
from yardstick.block import Block, make_block
from yardstick.plain import STAGES, PlainLoop

#: Shape functions that the plain loop knows.
SHAPES = ("linear", "gimp", "bspline", "cpdi")
#: Material points of a small scene and of a large one.
COUNTS = (600, 17_600)
#: One sample steps so often that it moves at least this many points: a timer's noise does not count.
POINTS_PER_SAMPLE = 20_000


def measure_kernels(
    shapes: Sequence[str] = SHAPES,
    counts: Sequence[int] = COUNTS,
    repeats: int = 30,
    *,
    dim: int = 2,
    compiler: bool = True,
) -> list[dict[str, Any]]:
    """Cost of a step with affine transfer, update stress last, neo-Hookean material and no contact.

    Samples alternate between the kernels and the plain loop, so that both meet the same disturbances.

    Parameters
    ----------
    shapes
        Names among :data:`SHAPES`.
    counts
        Numbers of material points, met as nearly as a cube of whole cells allows.
    repeats
        Pairs of samples.
    dim
        Number of space dimensions.
    compiler
        Use a C++ compiler if there is one; else the plain loop is numba's (two dimensions only).

    Returns
    -------
    One row for each shape and count: ``shape``, ``dim``, ``particles``; least CPU time over the repeats
    [ns per point and step], ``ns_total``, its stages (``ns_gather``, …), and ``ns_plain`` of the plain loop,
    whose language is ``loop``; ``ratio``, the median over the repeats of total / plain, and its quartiles
    ``ratio_low`` and ``ratio_high``.
    """
    return [_measure(shape, count, repeats, dim, compiler) for shape in shapes for count in counts]


def _measure(shape: str, count: int, repeats: int, dim: int, compiler: bool) -> dict[str, Any]:
    block = make_block(shape, count, dim)
    plain = PlainLoop(shape, block, compiler=compiler)
    n = block.state.particles.count
    steps = max(1, -(-POINTS_PER_SAMPLE // n))
    _sample_block(block, 1)
    _sample_plain(plain, 1)
    wall, ours, theirs = np.zeros((repeats, len(STAGES))), np.zeros(repeats), np.zeros(repeats)
    for repeat in range(repeats):
        ours[repeat], wall[repeat] = _sample_block(block, steps)
        theirs[repeat] = _sample_plain(plain, steps)
    to_ns = 1e9 / (n * steps)
    low, median, high = quartiles(ours / theirs)
    times = stage_times(wall, ours) * to_ns
    return {
        "shape": shape,
        "dim": dim,
        "particles": n,
        **{f"ns_{stage}": float(time) for stage, time in zip(STAGES, times, strict=True)},
        "ns_total": float(ours.min() * to_ns),
        "ns_plain": float(theirs.min() * to_ns),
        "loop": plain.language,
        "ratio": median,
        "ratio_low": low,
        "ratio_high": high,
    }


def _sample_block(block: Block, steps: int) -> tuple[float, list[float]]:
    """CPU seconds of so many steps, and wall seconds by stage."""
    block.clock.restart()
    for _ in range(steps):
        block.step()
    block.clock("output")
    block.clock.flush()
    return sum(block.clock.cpu.values()), [block.clock.wall[stage] for stage in STAGES]


def _sample_plain(plain: PlainLoop, steps: int) -> float:
    """CPU seconds of so many steps of the plain loop."""
    begin = time.process_time()
    for _ in range(steps):
        for stage in STAGES:
            plain.stages[stage]()
    return time.process_time() - begin
