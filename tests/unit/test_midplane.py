"""Segments on the line between them: areas, gaps, pressure through outlines of any nodes, moments."""

from __future__ import annotations

import numpy as np
import pytest

from contact_kernels import PLANE, join, pair_table, turned
from interpreted import interpreted
from mpmfw.contact.rows import ContactRows
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw_contact.midplane import DEEPEST, LEAST_COSINE, LEAST_OVERLAP, write_midlines
from support import as_table


def cut(x, y0, y1):
    """A rectangle whose bottom and top are cut at the places ``x``."""
    x = np.asarray(x, dtype=float)
    return np.concatenate(
        [np.stack([x, np.full(len(x), y0)], 1), np.stack([x[::-1], np.full(len(x), y1)], 1)]
    )


def rows_between(loops, *, friction=True, reach=0.5, **constants):
    """Rows of all segments of the first body with all of the second; the surface's nodes are the grid's."""
    write = interpreted(write_midlines, **constants) if constants else write_midlines
    n, first = len(loops.body), np.flatnonzero(loops.body == 0)
    second = np.flatnonzero(loops.body == 1)
    near = NearFacets(
        first=len(second) * np.minimum(np.arange(n + 1), len(first)),
        facet=np.tile(second, len(first)).astype(np.int32),
        away=np.zeros(0),
        moved=np.zeros(2),
    )
    rows = ContactRows(2, couples=friction)
    rows.make_room(4 * len(near.facet), 64 * len(near.facet))
    table = as_table(np.arange(n + 1), np.arange(n, dtype=np.int32), np.ones(n))
    rows.count = write(near, reach, loops.outline, *pair_table(2), table, rows, PLANE)
    assert constants or rows.count > 0
    return rows


def nodal(rows, force, n):
    """Bᵀ f on the surface's nodes."""
    rows.force[: rows.count] = force
    out = np.zeros((n, 2))
    rows.add_to(out, PLANE)
    return out


BOTTOM = [0.0, 0.17, 0.5, 0.61, 1.0]
TOP = [-0.2, 0.1, 0.33, 0.8, 1.3]
DEPTH = 0.01


def overlapping(turn=0.0):
    """A block that lies on a wider one and overlaps it, both turned."""
    return join([turned(cut(BOTTOM, 0.0, 0.4), turn), turned(cut(TOP, -0.4, DEPTH), turn)])


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
def test_a_pressure_is_passed_on_as_one(turn):
    """The upper block's nodes have their tributary lengths' part, to rounding."""
    loops = overlapping(turn)
    rows = rows_between(loops)
    n = slice(rows.count)
    np.testing.assert_allclose(rows.gap[n], -DEPTH, atol=1e-12)
    assert rows.area[n].sum() == pytest.approx(1.0, abs=1e-12)
    force = nodal(rows, rows.area[n, None] * rows.normal[n], len(loops.body))
    expected = 0.5 * np.convolve(np.concatenate([[0.0], np.diff(BOTTOM), [0.0]]), [1.0, 1.0], "valid")
    np.testing.assert_allclose(np.linalg.norm(force[: len(BOTTOM)], axis=1), expected, atol=1e-12)
    assert not force[len(BOTTOM) : 2 * len(BOTTOM)].any()  # the top of the upper block
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12)


def test_only_what_overlaps_bears():
    """The energy ∫ g² ds / 2 of a wedge's overlap is exact, and its derivative is the force."""

    def energy(depth):
        loops = join(
            [cut([0.0, 1.0], 0.0, 0.4), [[0.2, -0.4], [0.8, -0.4], [0.8, depth - 0.1], [0.2, depth]]]
        )
        rows = rows_between(loops, friction=False)
        n = slice(rows.count)
        gap, area = rows.gap[n], rows.area[n]
        return 0.5 * (area * np.minimum(gap, 0.0) ** 2).sum(), -(area * np.minimum(gap, 0.0)).sum()

    depth, step = 0.03, 1e-5
    (low, _), (_, force), (high, _) = energy(depth - step), energy(depth), energy(depth + step)
    slope = 0.1 / 0.6
    assert force == pytest.approx(
        0.5 * depth**2 / slope, rel=0.02
    )  # of the horizontal face, which leans by half
    assert (high - low) / (2.0 * step) == pytest.approx(force, rel=0.02)


def sides(across, turn=0.0, **constants):
    """Rows of the sides of a block or wedge in a wide face: their normals lean by more than 10°."""
    loops = join([turned(across, turn), turned(cut([-1.0, 1.0], -1.0, 0.0), turn)])
    rows = rows_between(loops, **constants)
    upright = turned([[0.0, 1.0]], turn)[0]
    return int((np.abs(rows.normal[: rows.count] @ upright) < np.cos(np.radians(10.0))).sum())


def test_without_a_least_cosine_rounding_decides_whether_sides_at_right_angles_face_each_other():
    """With a large one a wedge whose sides lean by 70° from the face faces nothing."""
    block = cut([-0.2, 0.2], -DEPTH, 0.4)
    turns = np.linspace(0.0, 3.0, 20)
    assert {sides(block, turn, LEAST_COSINE=LEAST_COSINE) for turn in turns} == {0}
    assert len({sides(block, turn, LEAST_COSINE=0.0) for turn in turns}) > 1
    height = 0.1 * np.tan(np.radians(70.0))
    wedge = [[0.0, -DEPTH], [0.1, height - DEPTH], [-0.1, height - DEPTH]]
    assert sides(wedge, LEAST_COSINE=LEAST_COSINE) > 0
    assert sides(wedge, LEAST_COSINE=0.5) == 0


def test_segments_end_to_end_share_nothing_and_the_rest_is_counted_whole():
    """Without a least overlap rounding makes rows; with a large one short overlaps carry nothing."""

    def areas(turn, **constants):
        upper, lower = (
            cut(BOTTOM, 0.0, 0.4),
            cut(BOTTOM, -0.4, DEPTH),
        )  # 0.61 − 0.5 and the like have no exact value
        loops = join([turned(upper, turn), turned(lower, turn)])
        rows = rows_between(loops, **constants)
        return rows.area[: rows.count]

    turns = np.linspace(0.1, 3.0, 12)
    assert all(len(areas(turn, LEAST_OVERLAP=LEAST_OVERLAP)) == 2 * (len(BOTTOM) - 1) for turn in turns)
    assert any(len(areas(turn, LEAST_OVERLAP=0.0)) > 2 * (len(BOTTOM) - 1) for turn in turns)
    whole = rows_between(overlapping(), LEAST_OVERLAP=LEAST_OVERLAP)
    assert whole.area[: whole.count].sum() == pytest.approx(1.0, abs=1e-12)
    short = rows_between(overlapping(), LEAST_OVERLAP=0.5)
    assert short.area[: short.count].sum() < 0.9


def test_the_far_side_of_a_thin_body_bears_nothing_and_what_is_deep_still_does():
    """With a smaller depth a deep face is let go; with a larger one far sides push as well."""
    reach = 0.5
    sheet, block = cut([-1.0, 1.0], -0.6 * reach, 0.0), cut([-0.5, 0.5], -0.1 * reach, 2.0 * reach)

    def depths(deepest):
        rows = rows_between(join([block, sheet]), reach=reach, DEEPEST=deepest)
        return np.unique(np.round(-rows.gap[: rows.count] / reach, 6)).tolist()

    assert depths(DEEPEST) == [0.1]
    assert depths(0.05) == []
    thin = cut([-0.5, 0.5], -0.1 * reach, 0.5 * reach)  # its top faces the sheet's bottom, through both
    rows = {
        deepest: rows_between(join([thin, sheet]), reach=reach, DEEPEST=deepest).count
        for deepest in (DEEPEST, 2.0)
    }
    assert rows[2.0] > rows[DEEPEST] == 2
