"""How far surfaces turn about their normal: a stored tangential force turns with them."""

from __future__ import annotations

from mpmfw.contact.surfaces.assembly import Places
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.facets import area_vector, length_of, read_corners, read_point, write_own_gradients
from mpmfw.kernels.types import Float, Floats
from mpmfw.state.structs import Surface


@device
def facet_turn(m: int, normal: Floats, outline: Surface, spacing: tuple[float, ...]) -> tuple[Float, Float]:
    """Angle by which facet m of a surface in space turned about ``normal`` over the last step [rad], and
    twice its area across that [m^2], negative from behind.

    With the displacements u_a of its corners and s = Σ ∇ξ_a × u_a / 2 the facet turns about its own normal
    e by s·e, and e itself by 2 s − 2 (s·e) e: in all by 2 s − (s·e) e. Gradient and e are those half a
    step ago, so that the error is of third order in the angle.
    """
    corners, gradient = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    area, u = scratch.vector(spacing), scratch.vector(spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    for a in range(3):
        for d in range(3):
            corners[a, d] -= 0.5 * outline.displacement[outline.facets[m, a], d]
    area_vector(corners, area, spacing)
    size = length_of(area, spacing)
    if not size > 0.0:
        return 0.0, 0.0
    write_own_gradients(corners, 1.0, gradient, spacing)
    about_normal, about_own, cosine = 0.0, 0.0, 0.0
    for d in range(3):
        cosine += area[d] / size * normal[d]
    for a in range(3):
        read_point(outline.facets[m, a], outline.displacement, u, spacing)
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            turned = 0.5 * (gradient[a, e] * u[f] - gradient[a, f] * u[e])
            about_normal += turned * normal[d]
            about_own += turned * area[d] / size
    return 2.0 * about_normal - about_own * cosine, size * cosine


@device
def node_turn(s: int, normal: Floats, without: Float, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Mean by area of the angles of node s's facets that face ``normal`` [rad], else ``without``."""
    total, whole = 0.0, 0.0
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        angle, across = facet_turn(outline.star[k], normal, outline, spacing)
        total += max(-across, 0.0) * angle
        whole += max(-across, 0.0)
    return total / whole if whole > 0.0 else without


@kernel
def write_spins(
    count: int, widest: float, outline: Surface, rows: Rows, places: Places, spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Mean of the angles by which the surfaces of every row turned about its normal over the last step
    [rad]; 0 where the gap is wider than ``widest`` [m]."""
    normal = scratch.vector(spacing)
    for c in range(count):
        rows.spin[c] = 0.0
        if rows.gap[c] > widest:
            continue
        read_point(c, rows.normal, normal, spacing)
        of_facet, _ = facet_turn(places.facet[c], normal, outline, spacing)
        rows.spin[c] = 0.5 * (of_facet + node_turn(places.slave[c], normal, of_facet, outline, spacing))
