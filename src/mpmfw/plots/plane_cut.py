"""A run in space on a plane across it, as a run in the plane: its material points and outlines there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.results.domains import facets_of, surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import bodies_of, frame_of, rigid_bodies_of
from mpmfw.state.fields import FloatArray, IntArray

#: Rounding of positions, which files have in single precision, over the bodies' extent.
SINGLE_PRECISION = 1e-6


def plane_cut(
    tree: xr.DataTree,
    name: str,
    frame: int,
    normal: str = "z",
    at: float | None = None,
    bodies: Sequence[str] | None = None,
) -> tuple[str, xr.DataTree]:
    """Return a field of one output on a plane across ``normal``, at a place [m], by default that of the
    point in the middle.

    Points within half their size are in the plane, with the area of their size. The title has the place.
    """
    axes = [str(axis) for axis in tree.coords["axis"].values]
    if normal not in axes:
        raise SceneError(f"plane {normal}: expected one of {', '.join(axes)}")
    across, own = axes.index(normal), bodies_of(tree, bodies)
    shown = [axis for axis in axes if axis != normal]
    frames = {body: frame_of(tree, f"particles/{body}", frame) for body in own}
    position = np.concatenate([data["position"].values for data in frames.values()]).astype(float)
    place = float(np.quantile(position[:, across], 0.5, method="lower")) if at is None else at
    time = {"time": [next(iter(frames.values()))["time"].item()]}
    groups = {"/": xr.Dataset(coords={"axis": shown, "body": own, **time}, attrs=tree.attrs)}
    for body, data in frames.items():
        size = np.cbrt(data["volume"].astype(float))
        met = abs(data["position"].sel(axis=normal) - place) <= 0.5 * size
        parts = {
            "position": data["position"].sel(axis=shown),
            "volume": size**2,
            name: point_field(data, name),
        }
        if met.any():
            groups[f"/particles/{body}"] = xr.Dataset(parts).isel(particle=met.values).expand_dims(time)
    if len(groups) == 1:
        low, high = position[:, across].min(), position[:, across].max()
        text = f"no material point is on the plane {normal} = {place:g} m"
        raise SceneError(f"{text}; expected {low:.4g} to {high:.4g} m")
    for body in set(surfaces_of(tree)) & {*own, *rigid_bodies_of(tree, bodies)}:
        nodes = frame_of(tree, f"surface/{body}", frame)["position"].values.astype(float)
        ends = cut_lines(nodes, facets_of(tree, body), across, place).reshape(-1, 3)
        if not len(ends):
            continue
        lines = {"position": (("surface_node", "axis"), np.delete(ends, across, axis=1))}
        following = ("surface_node", np.arange(len(ends)) ^ 1)  # the other end of each
        cut = xr.Dataset(lines, {"axis": shown}).expand_dims(time).assign(next=following)
        groups[f"/surface/{body}"] = cut
    near = abs(place) < SINGLE_PRECISION * float(np.ptp(position, axis=0).max())
    return f"{normal} = {0.0 if near else place:.4g} m", xr.DataTree.from_dict(groups)


def cut_lines(nodes: FloatArray, facets: IntArray, across: int, place: float) -> FloatArray:
    """Return segments (n, 2, 3) [m] in which triangles (k, 3) meet a plane."""
    corners = nodes[facets]
    above = corners[:, :, across] >= place
    cut = above.any(axis=1) & ~above.all(axis=1)
    corners, above = corners[cut], above[cut]
    lone = np.argmax(above == (above.sum(axis=1) == 1)[:, np.newaxis], axis=1)
    rows = np.arange(len(corners))
    start = corners[rows, lone]
    ends = []
    for k in (1, 2):
        end = corners[rows, (lone + k) % 3]
        share = (place - start[:, across]) / (end[:, across] - start[:, across])
        ends.append(start + share[:, np.newaxis] * (end - start))
    return np.stack(ends, axis=1)
