"""Two segments of the plane that face each other: the line between them, and what they have in common."""

from __future__ import annotations

from mpmfw.api.types import Surface
from mpmfw.contact.surfaces.outline import opposition
from mpmfw.kernels import device, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.facets import length_of, read_corners, write_gradients
from mpmfw.kernels.surfaces import area_of
from mpmfw.kernels.types import Float, Floats, Table

#: Least cosine between one segment's normal and the other's reversed one. It is more than that of nodes,
#: 0.02, with which the sides of a block that lean a little push along the face that it lies on.
LEAST_COSINE = 0.1

#: Part of a segment's length by which two must lie over each other: what rounding leaves is no overlap.
LEAST_OVERLAP = 1e-9


@device
def set_midline(m: int, other: int, outline: Surface, normal: Floats, spacing: tuple[float, ...]) -> bool:
    """Write the unit normal of the line between two segments, out of the second; False if none faces."""
    a, b = scratch.vector(spacing), scratch.vector(spacing)
    area_of(m, outline, a, spacing)
    if not opposition(a, other, outline, spacing) > LEAST_COSINE:  # a segment without length has none
        return False
    area_of(other, outline, b, spacing)
    size, other_size = length_of(a, spacing), length_of(b, spacing)
    for d in range(len(spacing)):
        normal[d] = b[d] / other_size - a[d] / size
    whole = length_of(normal, spacing)
    for d in range(len(spacing)):
        normal[d] /= whole
    return True


@device
def shadow(m: int, normal: Floats, outline: Surface, out: Floats) -> None:
    """Write places of a segment's ends along the midline and above it, s_1, s_2, z_1, z_2, to ``out`` [m]."""
    for a in range(2):
        p = outline.facets[m, a]
        out[a] = -normal[1] * outline.position[p, 0] + normal[0] * outline.position[p, 1]
        out[2 + a] = normal[0] * outline.position[p, 0] + normal[1] * outline.position[p, 1]


@device
def share_at(s: Float, ends: Floats) -> Float:
    """Coordinate ξ of the place of a segment over ``s``."""
    return (s - ends[0]) / (ends[1] - ends[0])


@device
def gap_at(s: Float, ends: Floats, other_ends: Floats) -> Float:
    """Height of the first segment over the second at ``s`` [m]."""
    xi, eta = share_at(s, ends), share_at(s, other_ends)
    return (1.0 - xi) * ends[2] + xi * ends[3] - (1.0 - eta) * other_ends[2] - eta * other_ends[3]


@device
def common_part(ends: Floats, other_ends: Floats) -> tuple[Float, Float]:
    """Where two segments lie over each other, and overlap if they do: the gap is linear. The first is larger
    if there is no such part."""
    low = max(min(ends[0], ends[1]), min(other_ends[0], other_ends[1]))
    high = min(max(ends[0], ends[1]), max(other_ends[0], other_ends[1]))
    least = min(abs(ends[1] - ends[0]), abs(other_ends[1] - other_ends[0]))
    if high - low <= LEAST_OVERLAP * least:
        return 1.0, 0.0
    left, right = gap_at(low, ends, other_ends), gap_at(high, ends, other_ends)
    if left * right < 0.0:
        zero = low + (high - low) * left / (left - right)
        low, high = (low, zero) if left < 0.0 else (zero, high)
    return low, high


@device
def add_side(
    c: int, m: int, sign: Float, xi: Float, half_gap: Float, outline: Surface, table: Table, rows: Rows,
    top: int, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Entries and motion of the place ξ of segment m in row c, times ``sign``; the new top. The couple of a
    force along the midline is ½ g ∇ξ on both sides."""
    dim, has_couple = len(spacing), len(rows.couple) > 0
    corners, gradient = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    normal = scratch.vector(spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    for d in range(dim):
        normal[d] = -sign * rows.normal[c, d]  # out of this side
    write_gradients(corners, normal, half_gap, gradient, spacing)
    for a in range(dim):
        p, share, along = outline.facets[m, a], sign * (1.0 - xi if a == 0 else xi), 0.0
        for d in range(dim):
            rows.motion[c, d] += share * outline.displacement[p, d]
            along += rows.normal[c, d] * outline.displacement[p, d]
        for d in range(dim):
            rows.motion[c, d] += gradient[a, d] * along if has_couple else 0.0
        for k in range(table.row[p], table.row[p + 1]):
            if table.weight[k] == 0.0:
                continue
            rows.dof[top], rows.weight[top] = table.nodes[k], share * table.weight[k]
            if has_couple:
                for d in range(dim):
                    rows.couple[top, d] = table.weight[k] * gradient[a, d]
            top += 1
    return top
