"""The checks of a geometry: its surfaces enclose the body that its points fill."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import shapely

from mpmfw.geometry import BodyGeometry, Layout, PlaneGeometry, SolidGeometry
from mpmfw.geometry.cut_cells import centroid_of, volume_of
from mpmfw.geometry.surface_checks import check_surface
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.subject import Subject

#: Sides of facets that are asked for, as shares of the largest extent.
SIDES = (1 / 6, 1 / 12, 1 / 24)
#: Sizes of points, likewise, and shifts of their lattice in cells.
SIZES, SHIFTS = (1 / 5, 1 / 10), (0.0, 0.3)
#: By what share of what was asked sides may be longer: in space diagonals, on a ring where it is widest.
LONGER = {2: 1e-9, 3: 1.0}
#: Volumes of layouts, of the true one: rounding, and in space that of a surface of fine triangles.
VOLUMES = {2: 1e-9, 3: 1e-3}


def runs(subject: Subject) -> None:
    """It answers with bounds, surfaces and points. Finite, of the right shapes, at several sizes."""
    geometry, dim, extent = _made(subject)
    if geometry.bounds.shape != (2, dim) or not (geometry.bounds[0] < geometry.bounds[1]).all():
        raise Violation(
            "bounds must be a lower and an upper corner, (2, dim)", {"bounds": geometry.bounds.tolist()}
        )
    for side in SIDES:
        for nodes, facets in geometry.surfaces(side * extent):
            case = {"side [m]": side * extent, "nodes": nodes.shape, "facets": facets.shape}
            if (
                nodes.ndim != 2
                or nodes.shape[1] != dim
                or facets.ndim != 2
                or facets.shape[1] != dim
                or not len(facets)
            ):
                raise Violation("a surface must be nodes (m, dim) and facets (k, dim)", case)
            if not np.isfinite(nodes).all() or facets.min() < 0 or facets.max() >= len(nodes):
                raise Violation("nodes must be finite, and facets of nodes that there are", case)
    for layout, case in _layouts(geometry, extent):
        shapes = (layout.position.shape, layout.volume.shape, layout.half_edges.shape)
        n = len(layout.volume)
        if shapes != ((n, dim), (n,), (n, dim, dim)) or not n or not np.isfinite(layout.position).all():
            raise Violation("a layout must have points, at finite places, with the shapes of Layout", case)


def closed(subject: Subject) -> None:
    """Its surfaces are closed and do not cross. In the plane no outline crosses itself or another, and no
    segment has no length; in space every side has two triangles."""
    geometry, dim, extent = _made(subject)
    for side in SIDES[:2]:
        surfaces = geometry.surfaces(side * extent)
        try:
            if dim == 3:
                check_surface(*_joined(surfaces))
                continue
            loops = [shapely.LinearRing(nodes[facets[:, 0]]) for nodes, facets in surfaces]
        except ValueError as error:
            raise Violation(f"a surface is not closed: {error}", {"side [m]": side * extent}) from error
        for loop, (nodes, facets) in zip(loops, surfaces, strict=True):
            if not np.array_equal(facets[:, 1], np.roll(facets[:, 0], -1)) or len(set(facets[:, 0])) != len(
                nodes
            ):
                raise Violation(
                    "segments do not run through all nodes once and back", {"side [m]": side * extent}
                )
            lengths = np.linalg.norm(nodes[facets[:, 1]] - nodes[facets[:, 0]], axis=1)
            if not loop.is_simple or lengths.min() <= 1e-9 * extent:
                at = nodes[int(lengths.argmin())].tolist()
                raise Violation(
                    "an outline crosses itself, or repeats a node",
                    {"side [m]": side * extent, "near [m]": at},
                )
        if any(one.intersects(other) for k, one in enumerate(loops) for other in loops[:k]):
            raise Violation("two outlines of the body cross each other", {"side [m]": side * extent})


def oriented(subject: Subject) -> None:
    """The material is on the side of the surface that is said. The material lies on the left of every
    segment; in space normals point outwards: beside every facet inside is inside."""
    geometry, _, extent = _made(subject)
    side = SIDES[-1] * extent
    nodes, facets = _joined(geometry.surfaces(side))
    case = {"side [m]": side}
    if _enclosed(nodes, facets) <= 0.0:
        raise Violation("facets run the wrong way round: what they enclose is negative", case)
    if isinstance(geometry, PlaneGeometry):
        one, other = nodes[facets[:, 0]], nodes[facets[:, 1]]
        along = other - one
        left = 0.05 * np.stack([-along[:, 1], along[:, 0]], axis=1)
        middle = 0.5 * (one + other)
        for away, wanted in ((left, True), (-left, False)):
            wrong = shapely.contains_xy(geometry.region, *(middle + away).T) != wanted
            if wrong.any():
                where = "not in the region" if wanted else "in the region"
                text = (
                    f"beside {wrong.sum()} of {len(wrong)} segments "
                    f"the {'left' if wanted else 'right'} is {where}"
                )
                raise Violation(text, {**case, "the first at [m]": middle[wrong][0].tolist()})


def sides(subject: Subject) -> None:
    """Facets are as fine as asked, and as many as announced. No side is longer than was asked, in space not
    twice as long, and there are no more nodes than memory is planned for."""
    geometry, dim, extent = _made(subject)
    for share in SIDES:
        asked = share * extent
        nodes, facets = _joined(geometry.surfaces(asked))
        corners = nodes[facets]
        longest = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
        within(
            longest / asked,
            1.0 + LONGER[dim],
            "a side is longer than was asked (over that)",
            {"asked [m]": asked},
        )
        if isinstance(geometry, SolidGeometry):
            most = geometry.surface_nodes(asked)
        else:
            most = 2.0 * geometry.outline_length / asked + 8.0  # type: ignore[attr-defined]
        within(
            float(len(nodes)),
            most,
            "there are more nodes than surface_nodes or outline_length announce",
            {"asked [m]": asked},
        )


def in_bounds(subject: Subject) -> None:
    """The bounds are those of the surface. Nodes lie within them and reach each to 2 %."""
    geometry, _, extent = _made(subject)
    nodes, _ = _joined(geometry.surfaces(SIDES[-1] * extent))
    lower, upper = geometry.bounds
    out = max(float((lower - nodes.min(axis=0)).max()), float((nodes.max(axis=0) - upper).max()))
    within(out / extent, 1e-9, "the surface leaves the bounds (by a share of the extent)", {})
    apart = np.maximum(nodes.min(axis=0) - lower, upper - nodes.max(axis=0)).max()
    within(
        float(apart) / extent, 0.02, "the bounds are wider than the surface (by a share of the extent)", {}
    )


def volume(subject: Subject) -> None:
    """Surface and points have the body's volume. Finer facets enclose `exact_volume` ever better: 2 % at the
    finest; points have it to rounding, in space to 1e-3."""
    geometry, dim, extent = _made(subject)
    true = float(geometry.exact_volume)
    off = [abs(_enclosed(*_joined(geometry.surfaces(side * extent))) / true - 1.0) for side in SIDES]
    case: dict[str, object] = {"exact_volume": true}
    within(off[-1], 0.02, "the surface does not enclose exact_volume (off by a share of it)", case)
    within(
        off[-1],
        0.5 * off[0] + 1e-9,
        "with finer facets it comes no nearer to exact_volume",
        {**case, "coarse": off[0]},
    )
    for layout, sizes in _layouts(geometry, extent):
        wrong = abs(float(layout.volume.sum()) / true - 1.0)
        within(
            wrong,
            VOLUMES[dim],
            "the points have not the volume of the body (off by a share of it)",
            {**case, **sizes},
        )


def centroid(subject: Subject) -> None:
    """Surface and points have the body's centroid. To 1 % of the extent and of a point's size."""
    geometry, _, extent = _made(subject)
    true = np.asarray(geometry.centroid)
    nodes, facets = _joined(geometry.surfaces(SIDES[-1] * extent))
    off = float(np.abs(_centre(nodes, facets) - true).max())
    within(
        off / extent,
        0.01,
        "the surface has another centroid (off by a share of the extent)",
        {"centroid": true.tolist()},
    )
    for layout, case in _layouts(geometry, extent):
        found = layout.volume @ layout.position / layout.volume.sum()
        wrong = float(np.abs(found - true).max()) / float(case["size [m]"])  # type: ignore[arg-type]
        within(
            wrong,
            0.01,
            "the points have another centroid (off by a share of their size)",
            {"centroid": true.tolist(), **case},
        )


def points(subject: Subject) -> None:
    """Points are in the body and as large as asked. Every point has a volume, that of its domain, lies in the
    body or half its size beside it, and is no larger than asked."""
    geometry, dim, extent = _made(subject)
    number = []
    for layout, case in _layouts(geometry, extent):
        size = float(case["size [m]"])  # type: ignore[arg-type]
        domain = np.linalg.det(2.0 * layout.half_edges)
        if not (layout.volume > 0.0).all() or not np.allclose(domain, layout.volume, rtol=1e-9, atol=0.0):
            raise Violation("a point's volume is not positive, or not det(2 r) of its domain", case)
        within(
            float(layout.volume.max()) / (1.5 * size) ** dim,
            1.0,
            "a point is larger than 1.5 times the size in every direction (over that)",
            case,
        )
        if isinstance(geometry, PlaneGeometry):
            away = float(shapely.distance(geometry.region, shapely.points(layout.position)).max())
            within(away / size, 0.5, "a point lies outside the body (by so many of its sizes)", case)
            assert layout.corners is not None
            area = 0.5 * _twice(
                layout.corners[:, 2] - layout.corners[:, 0], layout.corners[:, 3] - layout.corners[:, 1]
            )
            if not np.allclose(area, layout.volume, rtol=1e-9, atol=0.0):
                raise Violation("the corners of a point's domain have not its area, or run clockwise", case)
        number.append(len(layout.volume))
    few, many = number[0], number[len(SHIFTS)]
    within(
        0.5 * 2**dim * few / many,
        1.0,
        "points of half the size are too few (expected over found)",
        {"few": few, "many": many},
    )


def repeatable(subject: Subject) -> None:
    """The same geometry answers alike, whatever was done with its answers. Asked again, and of another
    object, it answers with the same bits, though what it gave before was written to."""
    geometry, _, extent = _made(subject)
    first = _answers(geometry, extent)
    for array in _arrays(geometry, extent):
        if array.flags.writeable:
            array += 1
    for other in (geometry, subject.make()):
        if _answers(other, extent) != first:
            raise Violation("the same geometry answers otherwise when it is asked again")


def saved(subject: Subject) -> None:
    """Written and read again it is the same body. Written as a scene's keys and read again, and sent to
    another process, it has the same surfaces and points to the bit."""
    geometry, _, extent = _made(subject)
    ways: dict[str, Any] = {
        "its keys": lambda: type(geometry).model_validate(geometry.model_dump()),
        "a pickle": lambda: pickle.loads(pickle.dumps(geometry)),
    }
    for name, way in ways.items():
        try:
            other = way()
        except Exception as error:
            raise Violation(
                f"it cannot be made again from {name}: {type(error).__name__}: {error}"
            ) from error
        if other.model_dump() != geometry.model_dump() or _answers(other, extent) != _answers(
            geometry, extent
        ):
            raise Violation(f"made again from {name} it is another body")


def moves(subject: Subject) -> None:
    """A centre moves the body and nothing else. A key ``centre`` moves the body as it is: bodies that are
    alike but for it share one layout, to 1e-9 of the extent."""
    geometry, dim, extent = _made(subject)
    if "centre" not in type(geometry).model_fields:
        raise Inapplicable("it has no key 'centre'")
    by = extent * np.array([0.75, -0.5, 0.25])[:dim]
    other = subject.make(centre=tuple(np.asarray(geometry.centre) + by))  # type: ignore[attr-defined]
    for one, two in zip(_arrays(geometry, extent), _arrays(other, extent), strict=True):
        shift = by if one.ndim == 2 and one.shape[1] == dim and one.dtype == float else 0.0
        if one.shape != two.shape or np.abs(two - one - shift).max() > 1e-9 * extent:
            raise Violation(
                "with another centre it is not the same body elsewhere", {"moved by [m]": by.tolist()}
            )


def axes(subject: Subject) -> None:
    """Sides are named along unit vectors at right angles. Right-handed, to 1e-12."""
    geometry, dim, _ = _made(subject)
    found = np.asarray(geometry.axes)
    if (
        found.shape != (dim, dim)
        or np.abs(found @ found.T - np.eye(dim)).max() > 1e-12
        or np.linalg.det(found) < 0.0
    ):
        raise Violation("axes are no right-handed unit vectors at right angles", {"axes": found.tolist()})


def _made(subject: Subject) -> tuple[BodyGeometry, int, float]:
    """A fresh geometry, its dimension and its largest extent [m]."""
    geometry: BodyGeometry = subject.make()
    return geometry, geometry.dim, float(np.ptp(geometry.bounds, axis=0).max())


def _layouts(geometry: BodyGeometry, extent: float) -> list[tuple[Layout, dict[str, object]]]:
    """Lattices of all sizes and shifts, with these; the coarse ones first."""
    return [
        (
            geometry.lattice(share * extent, (shift,) * geometry.dim),
            {"size [m]": share * extent, "shift [cells]": shift},
        )
        for share in SIZES
        for shift in SHIFTS
    ]


def _arrays(geometry: BodyGeometry, extent: float) -> list[Any]:
    layout = geometry.lattice(SIZES[0] * extent, (SHIFTS[1],) * geometry.dim)
    surfaces = [array for surface in geometry.surfaces(SIDES[0] * extent) for array in surface]
    return [*surfaces, layout.position, layout.volume]


def _answers(geometry: BodyGeometry, extent: float) -> list[bytes]:
    facts = [
        np.asarray(each)
        for each in (geometry.exact_volume, geometry.centroid, geometry.bounds, geometry.axes)
    ]
    return [np.ascontiguousarray(array).tobytes() for array in [*facts, *_arrays(geometry, extent)]]


def _joined(surfaces: Any) -> tuple[FloatArray, IntArray]:
    """Nodes and facets of all surfaces as one."""
    first = np.cumsum([0, *(len(nodes) for nodes, _ in surfaces)])
    facets = [own + start for (_, own), start in zip(surfaces, first, strict=False)]
    return np.concatenate([nodes for nodes, _ in surfaces]), np.concatenate(facets)


def _enclosed(nodes: FloatArray, facets: IntArray) -> float:
    """Area or volume within the facets [m^dim], negative where they run the wrong way round."""
    if nodes.shape[1] == 3:
        return volume_of(nodes, facets)
    nodes = nodes - nodes.mean(axis=0)
    return float(0.5 * _twice(nodes[facets[:, 0]], nodes[facets[:, 1]]).sum())


def _twice(one: FloatArray, other: FloatArray) -> FloatArray:
    """Twice the area between pairs of vectors (n, 2) [m^2], positive counter-clockwise."""
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _centre(nodes: FloatArray, facets: IntArray) -> FloatArray:
    """Centroid of what the facets enclose [m]."""
    if nodes.shape[1] == 3:
        return centroid_of(nodes, facets)
    one, other = nodes[facets[:, 0]], nodes[facets[:, 1]]
    twice = _twice(one, other)
    return np.asarray((twice[:, None] * (one + other)).sum(axis=0) / (3.0 * twice.sum()))


#: Those first whose failure makes others fail as well.
CHECKS = (
    runs, closed, oriented, sides, in_bounds, volume, centroid, points, repeatable, saved, moves, axes,
)  # fmt: skip
