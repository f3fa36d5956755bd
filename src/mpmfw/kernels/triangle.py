"""Points and triangles in space: projection on the plane, and the closest point by the region that the point
lies in.
"""

from __future__ import annotations

import math

from mpmfw.kernels._jit import device
from mpmfw.kernels.types import Float, Floats


@device
def product_along(x: Floats, a: int, b: int, c: int, corners: Floats) -> Float:
    """(x_c − x_b)·(x − x_a) of three corners of a triangle [m²]."""
    total = 0.0
    for d in range(3):
        total += (corners[c, d] - corners[b, d]) * (x[d] - corners[a, d])
    return total


@device
def coordinates_on_triangle(x: Floats, corners: Floats, share: Floats, normal: Floats) -> Float:
    """Gap g_n [m] of a point from the plane of a triangle, and the barycentric coordinates of its foot, into
    ``share``.

    ``normal`` is e_n times twice the area on entry, and e_n on return.
    """
    square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]
    size, gap = math.sqrt(square), 0.0
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        share[a] = 0.0
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            share[a] += normal[d] * (
                (corners[b, e] - x[e]) * (corners[c, f] - x[f])
                - (corners[b, f] - x[f]) * (corners[c, e] - x[e])
            )
        share[a] /= square
    for d in range(3):
        normal[d] /= size
        gap += (x[d] - corners[0, d]) * normal[d]
    return gap


@device
def closest_on_triangle(x: Floats, corners: Floats, share: Floats) -> None:
    """Barycentric coordinates of the point of a triangle that is closest to x, into ``share``.

    The regions of the plane, told by products of the edges with x − corner: those of the corners, where x
    lies behind both edges' starts; of the edges, on the far side of one and between its ends; of the face,
    the rest (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5). Coordinates that a region has
    none of are exactly 0."""
    # of corner i: along the edge to the second corner, and along that to the third
    to_b_a, to_c_a = product_along(x, 0, 0, 1, corners), product_along(x, 0, 0, 2, corners)
    to_b_b, to_c_b = product_along(x, 1, 0, 1, corners), product_along(x, 1, 0, 2, corners)
    to_b_c, to_c_c = product_along(x, 2, 0, 1, corners), product_along(x, 2, 0, 2, corners)
    share[0], share[1], share[2] = 0.0, 0.0, 0.0
    if to_b_a <= 0.0 and to_c_a <= 0.0:
        share[0] = 1.0
        return
    if to_b_b >= 0.0 and to_c_b <= to_b_b:
        share[1] = 1.0
        return
    if to_c_c >= 0.0 and to_b_c <= to_c_c:
        share[2] = 1.0
        return
    # signed areas of x with each edge, times twice that of the triangle
    area_c = to_b_a * to_c_b - to_b_b * to_c_a
    if area_c <= 0.0 and to_b_a >= 0.0 and to_b_b <= 0.0:
        share[1] = to_b_a / (to_b_a - to_b_b)
        share[0] = 1.0 - share[1]
        return
    area_b = to_b_c * to_c_a - to_b_a * to_c_c
    if area_b <= 0.0 and to_c_a >= 0.0 and to_c_c <= 0.0:
        share[2] = to_c_a / (to_c_a - to_c_c)
        share[0] = 1.0 - share[2]
        return
    area_a = to_b_b * to_c_c - to_b_c * to_c_b
    ahead, behind = to_c_b - to_b_b, to_b_c - to_c_c
    if area_a <= 0.0 and ahead >= 0.0 and behind >= 0.0:
        share[2] = ahead / (ahead + behind)
        share[1] = 1.0 - share[2]
        return
    total = area_a + area_b + area_c
    share[1], share[2] = area_b / total, area_c / total
    share[0] = 1.0 - share[1] - share[2]
