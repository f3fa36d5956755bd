"""Constants that decide which facets another body covers, each varied: kernels are compiled anew with
them.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from contact_kernels import PLANE, join
from mpmfw.contact.surfaces import covering


def facet_of(loops, first, second):
    """The facet from one place to another."""
    corners = loops.position[loops.outline.facets]
    return int(np.flatnonzero(np.isclose(corners, [first, second]).all(axis=(1, 2)))[0])


def is_flush(loops, place, facet):
    """Return True if the node at a place, of a face to the right, lies on the facet."""
    node = int(np.flatnonzero(np.isclose(loops.position, place).all(axis=1))[0])
    return njit(covering.is_flush.py_func)(node, facet, np.array([1.0, 0.0]), loops.outline, PLANE)


def test_a_facet_that_leans_by_more_than_elastic_faces_do_covers_nothing(monkeypatch):
    """By ASIDE: one of 20 degrees, near a node in the middle of a face."""
    lean = 0.4 * np.array([np.sin(np.radians(20.0)), np.cos(np.radians(20.0))])
    low, high = np.array([0.02, 0.0]) - lean, np.array([0.02, 0.0]) + lean
    face = [[0.0, -1.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
    loops = join([np.array(face), np.array([high, low, [2.0, -1.0], [2.0, 1.0]])])
    facet = facet_of(loops, high, low)
    assert not is_flush(loops, (0.0, 0.0), facet)
    monkeypatch.setattr(covering, "ASIDE", 0.4)
    assert is_flush(loops, (0.0, 0.0), facet)


def test_a_node_may_be_beyond_the_rim_at_an_edge_alone(monkeypatch):
    """By EDGE: facets that meet at 45 degrees are a curved face."""
    body = [[-0.7071, -0.7071], [0.0, 0.0], [0.0, 1.0], [-2.0, 1.0], [-2.0, -0.7071]]
    cover = [[0.01, 1.03], [0.01, 0.03], [1.0, 0.03], [1.0, 1.03]]
    loops = join([np.array(body), np.array(cover)])
    facet = facet_of(loops, cover[0], cover[1])
    assert not is_flush(loops, (0.0, 0.0), facet)
    monkeypatch.setattr(covering, "EDGE", 0.8)
    assert is_flush(loops, (0.0, 0.0), facet)


def test_facets_that_turn_away_cover_nothing(monkeypatch):
    """By OPPOSITE: two of 30 degrees touch the corners of a face, and leave its middle free."""
    body = [[0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]]
    notch = [[0.0, 1.0], [0.2887, 0.5], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    loops = join([np.array(body), np.array(notch)])
    listed = np.array(
        [facet_of(loops, notch[0], notch[1]), facet_of(loops, notch[1], notch[2])], dtype=np.int32
    )
    asked = (facet_of(loops, body[0], body[1]), listed, 0, 2, loops.outline, PLANE)
    assert not njit(covering.is_covered.py_func)(*asked)
    monkeypatch.setattr(covering, "OPPOSITE", 0.8)
    assert njit(covering.is_covered.py_func)(*asked)
