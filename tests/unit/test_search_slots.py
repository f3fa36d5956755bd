"""Where more bodies are near than there are slots, the nearest are kept, whatever the order of search."""

from __future__ import annotations

import itertools

import numpy as np

from contact_kernels import empty_candidates
from mpmfw.contact.surfaces.search import keep_nearest
from mpmfw.kernels import kernel


@kernel
def offer(order, gaps, share, normal, candidates):
    """Offer bodies 1, 2, … with the given gaps to node 0, in the given order."""
    for body in order:
        keep_nearest(0, body, body, gaps[body], share, normal, candidates, (1.0, 1.0))


def kept(order, gaps, slots):
    candidates = empty_candidates(1, slots)
    offer(np.array(order), np.array(gaps), np.array([0.5, 0.5]), np.array([0.0, 1.0]), candidates)
    return {int(body): float(gap) for body, gap in zip(candidates.master[0], candidates.gap[0], strict=True)}


def test_the_nearest_bodies_are_kept_in_any_order():
    gaps = [np.nan, 0.05, -0.035, 0.02, 0.06, -0.001]
    expected = {5: -0.001, 3: 0.02, 2: -0.035}
    for order in itertools.permutations(range(1, 6)):
        assert kept(order, gaps, 3) == expected


def test_of_equally_near_bodies_the_lower_index_is_kept():
    gaps = [np.nan, 0.02, 0.02, 0.02, -0.02]
    for order in itertools.permutations(range(1, 5)):
        assert set(kept(order, gaps, 3)) == {1, 2, 3}
