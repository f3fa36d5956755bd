"""Bodies that come near each other are listed, and nothing else is: against brute force."""

import itertools
from types import SimpleNamespace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.kernels.contact import pair_index, pair_table
from mpmfw.state.windows import FEW, BodyPairs, overlapping


def brute_force(lower, upper):
    """All two boxes with a point in common."""
    common = (lower[:, None] <= upper[None]).all(axis=2) & (lower[None] <= upper[:, None]).all(axis=2)
    return sorted(zip(*(index.tolist() for index in np.nonzero(np.triu(common, 1))), strict=True))


def listed(lower, upper):
    first, second = overlapping(lower, upper)
    return list(zip(first.tolist(), second.tolist(), strict=True))


def boxes(rng, n, dim, kind):
    """Corners of boxes: alike, of very different sizes, at one place, or on whole numbers."""
    lower = rng.uniform(-5.0, 5.0, (n, dim))
    size = {"alike": 1.0, "whole": 1.0, "one place": 1.0, "various": 10.0 ** rng.uniform(-2.0, 1.3, (n, 1))}[
        kind
    ]
    upper = lower + size * rng.uniform(0.2, 1.0, (n, dim))
    if kind == "whole":
        lower, upper = np.floor(lower), np.floor(upper)
    return (0.0 * lower, 0.0 * upper) if kind == "one place" else (lower, upper)


@settings(max_examples=150)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(0, 60),
    dim=st.sampled_from([2, 3]),
    kind=st.sampled_from(["alike", "various", "one place", "whole"]),
)
def test_boxes_that_overlap_are_those_that_brute_force_finds(seed, n, dim, kind):
    lower, upper = boxes(np.random.default_rng(seed), n, dim, kind)
    assert listed(lower, upper) == brute_force(lower, upper)


def moving(rng, n):
    """A state of windows alone, whose bodies move at random."""
    grid = SimpleNamespace(dim=2, n_fields=n, rigid_fields=0, frame=0, window_lower=None, window_shape=None)
    return (
        SimpleNamespace(grid=grid, pairs=(), near=None),
        rng.uniform(0.0, 60.0, (n, 2)),
        rng.uniform(0.5, 4.0, n),
    )


def lay(state, centre, radius):
    """Windows round discs, with a margin of three nodes."""
    grid = state.grid
    grid.window_lower = np.floor(centre - radius[:, None]).astype(np.int64) - 3
    grid.window_shape = np.floor(centre + radius[:, None]).astype(np.int64) + 4 - grid.window_lower + 1
    grid.frame += 1


@settings(max_examples=40)
@given(seed=st.integers(0, 2**32 - 1))
def test_no_bodies_meet_before_their_pair_is_listed(seed):
    """Discs wander, windows are laid anew: whoever is within a cell is listed by then."""
    rng = np.random.default_rng(seed)
    n = FEW + 8
    state, centre, radius = moving(rng, n)
    near = BodyPairs(tuple(f"b{k}" for k in range(n)), 0.0, {})
    velocity = rng.uniform(-1.0, 1.0, (n, 2))
    lay(state, centre, radius)
    near.update(state)
    sizes = [len(state.pairs)]
    for _ in range(60):
        centre = centre + velocity
        low, high = centre - radius[:, None], centre + radius[:, None]
        first, last = state.grid.window_lower, state.grid.window_lower + state.grid.window_shape - 1
        if (low < first + 1).any() or (high > last - 1).any():
            lay(state, centre, radius)
            near.update(state)
        known = {(pair.first, pair.second) for pair in state.pairs}
        distance = np.linalg.norm(centre[:, None] - centre[None], axis=2) - radius[:, None] - radius[None]
        within = set(zip(*(index.tolist() for index in np.nonzero(np.triu(distance < 1.0, 1))), strict=True))
        assert within <= known
        sizes.append(len(state.pairs))
    assert [pair.index for pair in state.pairs] == list(range(len(state.pairs)))
    assert len({pair.label for pair in state.pairs}) == len(state.pairs)
    assert sizes == sorted(sizes)
    assert sizes[0] < n * (n - 1) // 2


def test_the_table_finds_every_pair_in_either_order_and_no_other():
    rng = np.random.default_rng(3)
    n = 50
    bodies = np.array(list(itertools.combinations(range(n), 2)))
    chosen = rng.permutation(len(bodies))[:300]
    first, second = bodies[chosen].T
    table = pair_table(first, second)
    index = {tuple(two): k for k, two in enumerate(bodies[chosen].tolist())}
    for a, b in itertools.product(range(n), repeat=2):
        assert pair_index(table, a, b) == index.get((min(a, b), max(a, b)), -1)
    assert pair_index(pair_table(first[:0], second[:0]), 0, 1) == -1
