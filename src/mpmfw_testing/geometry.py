"""The checks of a geometry: its surfaces enclose the body that its points fill."""

from __future__ import annotations

import functools
import pickle
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import shapely

from mpmfw.geometry import BodyGeometry, Layout, PlaneGeometry, SolidGeometry
from mpmfw.geometry.cut_cells import centroid_of, volume_of
from mpmfw.geometry.solid import joined
from mpmfw.geometry.surface_checks import check_surface
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw_testing.bench import Opened
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.generic import repeatable, require_same, runs
from mpmfw_testing.subject import Subject

#: Sides of facets that are asked for, as shares of the largest extent.
SIDES = (1 / 6, 1 / 12, 1 / 24)
#: Sizes of points, likewise, and shifts of their lattice in cells.
SIZES, SHIFTS = (1 / 5, 1 / 10), (0.0, 0.3)
#: Excess of sides over what was asked: in space diagonals, on a ring where it is widest.
LONGER = {2: 1e-9, 3: 1.0}
#: Volumes of layouts, of the true one: rounding, and in space that of a surface of fine triangles.
VOLUMES = {2: 1e-9, 3: 1e-3}


def openings(subject: Subject) -> Iterator[Callable[[Any], Opened]]:  # noqa: ARG001
    """Yield the geometry's bounds, surfaces and points at several sizes."""
    yield functools.partial(Opened, _answers)


def _answers(geometry: BodyGeometry) -> Iterator[tuple[str, AnyArray]]:
    """Yield all answers; then write to their arrays, which must not be those that the geometry keeps."""
    dim = geometry.dim
    if geometry.bounds.shape != (2, dim) or not (geometry.bounds[0] < geometry.bounds[1]).all():
        text = "bounds must be a lower and an upper corner, (2, dim)"
        raise Violation(text, {"bounds": geometry.bounds.tolist()})
    extent = _extent(geometry)
    answers = {name: np.array(getattr(geometry, name)) for name in ("exact_volume", "centroid", "axes")}
    for side in SIDES:
        for k, (nodes, facets) in enumerate(geometry.surfaces(side * extent)):
            case = {"side [m]": side * extent, "nodes": nodes.shape, "facets": facets.shape}
            if nodes.ndim != 2 or nodes.shape[1] != dim or facets.shape != (len(facets), dim):
                raise Violation("a surface must be nodes (m, dim) and facets (k, dim)", case)
            if not len(facets) or facets.min() < 0 or facets.max() >= len(nodes):
                raise Violation("there must be facets, of nodes that there are", case)
            answers |= {f"nodes {k}, {side}": nodes, f"facets {k}, {side}": facets}
    for layout, case in _layouts(geometry):
        n = len(layout.volume)
        shapes = (layout.position.shape, layout.volume.shape, layout.half_edges.shape)
        if shapes != ((n, dim), (n,), (n, dim, dim)) or not n:
            raise Violation("a layout must have points, with the shapes of Layout", case)
        answers |= {f"positions, {case}": layout.position, f"volumes, {case}": layout.volume}
    yield from answers.items()
    for array in answers.values():
        if array.flags.writeable:
            array += 1


def closed(subject: Subject) -> None:
    """Its surfaces are closed and do not cross. In the plane no outline crosses itself or another, and no
    segment has no length; in space every side has two triangles."""
    geometry = subject.make()
    extent = _extent(geometry)
    for side in (share * extent for share in SIDES[:2]):
        surfaces, case = geometry.surfaces(side), {"side [m]": side}
        try:
            if geometry.dim == 3:
                check_surface(*joined(surfaces))
                continue
            loops = [shapely.LinearRing(nodes[facets[:, 0]]) for nodes, facets in surfaces]
        except ValueError as error:
            raise Violation(f"a surface is not closed: {error}", case) from error
        for loop, (nodes, facets) in zip(loops, surfaces, strict=True):
            once = len(set(facets[:, 0])) == len(nodes)
            if not once or not np.array_equal(facets[:, 1], np.roll(facets[:, 0], -1)):
                raise Violation("segments do not run through all nodes once and back", case)
            lengths = np.linalg.norm(nodes[facets[:, 1]] - nodes[facets[:, 0]], axis=1)
            if not loop.is_simple or lengths.min() <= 1e-9 * extent:
                near = {"near [m]": nodes[int(lengths.argmin())].tolist()}
                raise Violation("an outline crosses itself, or repeats a node", {**case, **near})
        if any(one.intersects(other) for k, one in enumerate(loops) for other in loops[:k]):
            raise Violation("two outlines of the body cross each other", case)


def oriented(subject: Subject) -> None:
    """The material is on the declared side of the surface. The material lies on the left of every segment; in
    space normals point outwards: beside every facet inside is inside."""
    geometry = subject.make()
    side = SIDES[-1] * _extent(geometry)
    nodes, facets = joined(geometry.surfaces(side))
    case = {"side [m]": side}
    if _enclosed(nodes, facets) <= 0.0:
        raise Violation("facets run the wrong way round: what they enclose is negative", case)
    if not isinstance(geometry, PlaneGeometry):
        return
    one, other = nodes[facets[:, 0]], nodes[facets[:, 1]]
    along, middle = other - one, 0.5 * (one + other)
    left = 0.05 * np.stack([-along[:, 1], along[:, 0]], axis=1)
    for name, away, wanted in (("left", left, True), ("right", -left, False)):
        wrong = shapely.contains_xy(geometry.region, *(middle + away).T) != wanted
        if wrong.any():
            where = "not in the region" if wanted else "in the region"
            text = f"beside {wrong.sum()} of {len(wrong)} segments the {name} is {where}"
            raise Violation(text, {**case, "the first at [m]": middle[wrong][0].tolist()})


def sides(subject: Subject) -> None:
    """Facets are as fine as asked, and as many as announced. No side is longer than was asked, in space not
    twice as long, and there are no more nodes than memory is planned for."""
    geometry = subject.make()
    for asked in (share * _extent(geometry) for share in SIDES):
        nodes, facets = joined(geometry.surfaces(asked))
        corners, case = nodes[facets], {"asked [m]": asked}
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
        text = "a side is longer than was asked (over that)"
        within(longest / asked, 1.0 + LONGER[geometry.dim], text, case)
        if isinstance(geometry, SolidGeometry):
            most = geometry.surface_nodes(asked)
        else:
            most = 2.0 * geometry.outline_length / asked + 8.0
        within(len(nodes), most, "there are more nodes than surface_nodes or outline_length announce", case)


def in_bounds(subject: Subject) -> None:
    """The bounds are those of the surface. Nodes lie within them and reach each to 2 %."""
    geometry = subject.make()
    extent, (lower, upper) = _extent(geometry), geometry.bounds
    nodes, _ = joined(geometry.surfaces(SIDES[-1] * extent))
    least, most = nodes.min(axis=0), nodes.max(axis=0)
    outside = max((lower - least).max(), (most - upper).max())
    within(outside / extent, 1e-9, "the surface leaves the bounds (by a share of the extent)")
    inside = np.maximum(least - lower, upper - most).max()
    within(inside / extent, 0.02, "the bounds are wider than the surface (by a share of the extent)")


def volume(subject: Subject) -> None:
    """Surface and points have the body's volume. Finer facets enclose `exact_volume` ever better: 2 % at the
    finest; points have it to rounding, in space to 1e-3."""
    geometry = subject.make()
    true, extent = float(geometry.exact_volume), _extent(geometry)
    off = [abs(_enclosed(*joined(geometry.surfaces(side * extent))) / true - 1.0) for side in SIDES]
    case: dict[str, object] = {"exact_volume": true, "coarse": off[0]}
    within(off[-1], 0.02, "the surface does not enclose exact_volume (off by a share of it)", case)
    within(off[-1], 0.5 * off[0] + 1e-9, "with finer facets it comes no nearer to exact_volume", case)
    for layout, sizes in _layouts(geometry):
        wrong = abs(layout.volume.sum() / true - 1.0)
        text = "the points have not the volume of the body (off by a share of it)"
        within(wrong, VOLUMES[geometry.dim], text, {"exact_volume": true, **sizes})


def centroid(subject: Subject) -> None:
    """Surface and points have the body's centroid. To 1 % of the extent and of a point's size."""
    geometry = subject.make()
    true, extent = np.asarray(geometry.centroid), _extent(geometry)
    off = np.abs(_centre(*joined(geometry.surfaces(SIDES[-1] * extent))) - true).max()
    case = {"centroid": true.tolist()}
    within(off / extent, 0.01, "the surface has another centroid (off by a share of the extent)", case)
    for layout, sizes in _layouts(geometry):
        off = np.abs(layout.volume @ layout.position / layout.volume.sum() - true).max()
        text = "the points have another centroid (off by a share of their size)"
        within(off / sizes["size [m]"], 0.01, text, {**case, **sizes})


def points(subject: Subject) -> None:
    """Points are in the body and as large as asked. Every point has a volume, that of its domain, lies in the
    body or half its size beside it, and is no larger than asked."""
    geometry = subject.make()
    number = []
    for layout, case in _layouts(geometry):
        size, domain = case["size [m]"], np.linalg.det(2.0 * layout.half_edges)
        if not (layout.volume > 0.0).all() or not np.allclose(domain, layout.volume, rtol=1e-9, atol=0.0):
            raise Violation("a point's volume is not positive, or not det(2 r) of its domain", case)
        larger = layout.volume.max() / (1.5 * size) ** geometry.dim
        within(larger, 1.0, "a point is larger than 1.5 times the size in every direction (over that)", case)
        if isinstance(geometry, PlaneGeometry):
            away = shapely.distance(geometry.region, shapely.points(layout.position)).max()
            within(away / size, 0.5, "a point lies outside the body (by so many of its sizes)", case)
            c = layout.corners
            assert c is not None
            area = 0.5 * _twice(c[:, 2] - c[:, 0], c[:, 3] - c[:, 1])
            if not np.allclose(area, layout.volume, rtol=1e-9, atol=0.0):
                raise Violation("the corners of a point's domain have not its area, or run clockwise", case)
        number.append(len(layout.volume))
    few, many = number[0], number[len(SHIFTS)]
    text = "points of half the size are too few (expected over found)"
    within(0.5 * 2**geometry.dim * few / many, 1.0, text, {"few": few, "many": many})


def saved(subject: Subject) -> None:
    """Written and read again it is the same body. Written as a scene's keys and read again, and sent to
    another process, it has the same surfaces and points to the bit."""
    geometry = subject.make()
    ways: dict[str, Any] = {
        "its keys": lambda: type(geometry).model_validate(geometry.model_dump()),
        "a pickle": lambda: pickle.loads(pickle.dumps(geometry)),
    }
    for name, way in ways.items():
        try:
            other = way()
        except Exception as error:
            text = f"it cannot be made again from {name}: {type(error).__name__}: {error}"
            raise Violation(text) from error
        text = f"made again from {name} it is another body"
        if other.model_dump() != geometry.model_dump():
            raise Violation(text)
        first, second = (dict(_answers(each)) for each in (geometry, other))
        require_same(first, second, text)


def moves(subject: Subject) -> None:
    """A centre moves the body and nothing else. A key ``centre`` moves the body as it is: bodies that are
    alike but for it share one layout, to 1e-9 of the extent."""
    geometry = subject.make()
    if "centre" not in type(geometry).model_fields:
        raise Inapplicable("it has no key 'centre'")
    extent = _extent(geometry)
    by = extent * np.array([0.75, -0.5, 0.25])[: geometry.dim]
    other = subject.make(centre=tuple(np.asarray(geometry.centre) + by))
    first, second = dict(_answers(geometry)), dict(_answers(other))
    for name, one in first.items():
        shift = by if name.startswith(("nodes", "positions", "centroid")) else 0.0
        if one.shape != second[name].shape or np.abs(second[name] - one - shift).max() > 1e-9 * extent:
            text = "with another centre it is not the same body elsewhere"
            raise Violation(text, {"moved by [m]": by.tolist(), "value": name})


def axes(subject: Subject) -> None:
    """Sides are named along unit vectors at right angles. Right-handed, to 1e-12."""
    geometry = subject.make()
    found = np.asarray(geometry.axes)
    turned = found.shape != (geometry.dim, geometry.dim) or np.linalg.det(found) < 0.0
    if turned or np.abs(found @ found.T - np.eye(geometry.dim)).max() > 1e-12:
        raise Violation("axes are not a right-handed orthonormal set", {"axes": found.tolist()})


def _extent(geometry: BodyGeometry) -> float:
    """Return the largest extent [m]."""
    return float(np.ptp(geometry.bounds, axis=0).max())


def _layouts(geometry: BodyGeometry) -> Iterator[tuple[Layout, dict[str, Any]]]:
    """Yield lattices of all sizes and shifts, with these; the coarse ones first."""
    for size in (share * _extent(geometry) for share in SIZES):
        for shift in SHIFTS:
            layout = geometry.lattice(size, (shift,) * geometry.dim)
            yield layout, {"size [m]": size, "shift [cells]": shift}


def _enclosed(nodes: FloatArray, facets: IntArray) -> float:
    """Return area or volume within the facets [m^dim], negative where they run the wrong way round."""
    if nodes.shape[1] == 3:
        return volume_of(nodes, facets)
    nodes = nodes - nodes.mean(axis=0)
    return float(0.5 * _twice(nodes[facets[:, 0]], nodes[facets[:, 1]]).sum())


def _centre(nodes: FloatArray, facets: IntArray) -> FloatArray:
    """Return the centroid of what the facets enclose [m]."""
    if nodes.shape[1] == 3:
        return centroid_of(nodes, facets)
    one, other = nodes[facets[:, 0]], nodes[facets[:, 1]]
    twice = _twice(one, other)
    return np.asarray((twice[:, None] * (one + other)).sum(axis=0) / (3.0 * twice.sum()))


def _twice(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return twice the area between pairs of vectors (n, 2) [m^2], positive counter-clockwise."""
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


#: Those first whose failure makes others fail as well.
CHECKS = (runs, closed, oriented, sides, in_bounds, volume, centroid, points, repeatable, saved, moves, axes)
