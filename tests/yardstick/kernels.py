"""Time of the real stepper on a synthetic block, against a plain loop in the same run."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mpmfw.benchmark import quartiles, stage_times
from yardstick.block import Block, make_block, make_rings
from yardstick.plain import STAGES, PlainLoop, compilers

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
) -> list[dict[str, Any]]:
    """Cost of a step with affine transfer, update stress last, neo-Hookean material and no contact.

    Samples of the kernels and of the plain loops alternate, so that all meet the same disturbances. The plain
    loop that counts is the fastest of those of every compiler, with an interpolation table and without.

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

    Returns
    -------
    One row for each shape and count: ``shape``, ``dim``, ``particles``; least CPU time over the repeats [ns
    per point and step], ``ns_total``, its stages (``ns_gather``, …), and ``ns_plain`` of the fastest plain
    loop, which ``loop`` describes; ``ratio``, the median over the repeats of total / plain, and its quartiles
    ``ratio_low`` and ``ratio_high``."""
    blocks = ((shape, make_block(shape, count, dim)) for shape in shapes for count in counts)
    return [_measure(shape, block, repeats) for shape, block in blocks]


def measure_rings(shapes: Sequence[str] = SHAPES, repeats: int = 30) -> list[dict[str, Any]]:
    """The same of the colliding rings' points, as one body without contact, in the order and between the grid
    lines of the scene.

    Parameters and rows are those of :func:`measure_kernels`.
    """
    return [_measure(shape, make_rings(shape), repeats) for shape in shapes]


def _measure(shape: str, block: Block, repeats: int) -> dict[str, Any]:
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
    low, median, high = quartiles(ours / theirs[fastest])
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


def _plain_steps(shape: str, block: Block) -> dict[str, Callable[[], object]]:
    """A step of every plain loop that there is, by what it is; there must be a C++ compiler."""
    found: dict[str, Callable[[], object]] = {}
    for path in compilers():
        loop = PlainLoop(shape, block, compiler=path)
        found |= {f"{loop.language}, table": loop.step, f"{loop.language}, no table": loop.whole}
    return found


def _sample_block(block: Block, steps: int) -> tuple[float, list[float]]:
    """CPU seconds of so many steps, and wall seconds by stage."""
    block.clock.restart()
    for _ in range(steps):
        block.step()
    block.clock("output")
    block.clock.flush()
    return sum(block.clock.cpu.values()), [block.clock.wall[stage] for stage in STAGES]


def _sample_plain(step: Callable[[], object], steps: int) -> float:
    """CPU seconds of so many steps of a plain loop."""
    begin = time.process_time()
    for _ in range(steps):
        step()
    return time.process_time() - begin
