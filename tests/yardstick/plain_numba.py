"""The plain loop in two dimensions as numba compiles it, written out in scalars: for systems without a C++
compiler.

Arithmetic and arrays are those of plain.cpp. It is read beside it, and for nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace

from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Indices

Six = tuple[Float, Float, Float, Float, Float, Float, Float]


@device
def _linear(xi: Float, _l: Float, inverse_h: Float) -> Six:
    base = math.floor(xi)
    t = xi - base
    return base, 1.0 - t, t, 0.0, -inverse_h, inverse_h, 0.0


@device
def _bspline(xi: Float, _l: Float, inverse_h: Float) -> Six:
    base = math.floor(xi - 0.5)
    t = xi - base
    w0, w1, w2 = 0.5 * (1.5 - t) * (1.5 - t), 0.75 - (t - 1.0) * (t - 1.0), 0.5 * (t - 0.5) * (t - 0.5)
    return base, w0, w1, w2, (t - 1.5) * inverse_h, -2.0 * (t - 1.0) * inverse_h, (t - 0.5) * inverse_h


@device
def _gimp(xi: Float, l: Float, inverse_h: Float) -> Six:
    base = math.floor(xi - l)
    u = xi - l - base
    b = max(u + 2.0 * l - 1.0, 0.0)
    a = 2.0 * l - b
    share, rise = 0.5 / l, a * (u + 0.5 * a)
    s = share * inverse_h
    return (
        base,
        (a - rise) * share,
        (rise + b - 0.5 * b * b) * share,
        0.5 * b * b * share,
        -a * s,
        (a - b) * s,
        b * s,
    )


@device
def _entry(
    nodes: Indices, weight: Floats, gradient: Floats, k: int, node: int, n: Float, dx: Float, dy: Float
) -> None:
    nodes[k] = node
    weight[k] = n
    gradient[k, 0] = dx
    gradient[k, 1] = dy


@kernel
def _fill_product(
    shape: int,
    x: Floats,
    half: Floats,
    extent: int,
    h: float,
    nodes: Indices,
    weight: Floats,
    gradient: Floats,
) -> None:
    inverse_h = 1.0 / h
    width = 2 if shape == 0 else 3
    for p in range(len(x)):
        xi, eta, l = x[p, 0] * inverse_h, x[p, 1] * inverse_h, half[p] * inverse_h
        if shape == 0:
            i, u0, u1, u2, a0, a1, a2 = _linear(xi, l, inverse_h)
            j, v0, v1, v2, b0, b1, b2 = _linear(eta, l, inverse_h)
        elif shape == 1:
            i, u0, u1, u2, a0, a1, a2 = _gimp(xi, l, inverse_h)
            j, v0, v1, v2, b0, b1, b2 = _gimp(eta, l, inverse_h)
        else:
            i, u0, u1, u2, a0, a1, a2 = _bspline(xi, l, inverse_h)
            j, v0, v1, v2, b0, b1, b2 = _bspline(eta, l, inverse_h)
        k = p * width * width
        node = int(i) * extent + int(j)
        for a in range(width):
            u, du = (u0, a0) if a == 0 else (u1, a1) if a == 1 else (u2, a2)
            _entry(nodes, weight, gradient, k, node, u * v0, du * v0, u * b0)
            _entry(nodes, weight, gradient, k + 1, node + 1, u * v1, du * v1, u * b1)
            if width == 3:
                _entry(nodes, weight, gradient, k + 2, node + 2, u * v2, du * v2, u * b2)
            k += width
            node += extent


@kernel
def _fill_cpdi(
    x: Floats,
    f: Floats,
    edges: Floats,
    extent: int,
    h: float,
    nodes: Indices,
    weight: Floats,
    gradient: Floats,
) -> None:
    inverse_h = 1.0 / h
    for p in range(len(x)):
        r00 = f[p, 0, 0] * edges[p, 0, 0] + f[p, 0, 1] * edges[p, 1, 0]
        r01 = f[p, 0, 0] * edges[p, 0, 1] + f[p, 0, 1] * edges[p, 1, 1]
        r10 = f[p, 1, 0] * edges[p, 0, 0] + f[p, 1, 1] * edges[p, 1, 0]
        r11 = f[p, 1, 0] * edges[p, 0, 1] + f[p, 1, 1] * edges[p, 1, 1]
        scale = 0.25 / (r00 * r11 - r01 * r10)
        for c in range(4):
            s, t = 1.0 if c & 1 else -1.0, 1.0 if c & 2 else -1.0
            xi, eta = (x[p, 0] + s * r00 + t * r01) * inverse_h, (x[p, 1] + s * r10 + t * r11) * inverse_h
            gx, gy = (s * r11 - t * r10) * scale, (t * r00 - s * r01) * scale
            i, j = math.floor(xi), math.floor(eta)
            a, b = xi - i, eta - j
            node, k = int(i) * extent + int(j), p * 16 + c * 4
            n00, n01, n10, n11 = (1.0 - a) * (1.0 - b), (1.0 - a) * b, a * (1.0 - b), a * b
            _entry(nodes, weight, gradient, k, node, 0.25 * n00, gx * n00, gy * n00)
            _entry(nodes, weight, gradient, k + 1, node + 1, 0.25 * n01, gx * n01, gy * n01)
            _entry(nodes, weight, gradient, k + 2, node + extent, 0.25 * n10, gx * n10, gy * n10)
            _entry(nodes, weight, gradient, k + 3, node + extent + 1, 0.25 * n11, gx * n11, gy * n11)


@kernel
def _project(
    nodes: Indices,
    phi: Floats,
    m: Floats,
    v: Floats,
    x: Floats,
    c: Floats,
    xi: Floats,
    mi: Floats,
    pi: Floats,
    fi: Floats,
    vi: Floats,
) -> None:
    entries = len(nodes) // len(m)
    for i in range(len(mi)):
        mi[i] = pi[i, 0] = pi[i, 1] = fi[i, 0] = fi[i, 1] = 0.0
    for p in range(len(m)):
        c00, c01, c10, c11 = c[p, 0, 0], c[p, 0, 1], c[p, 1, 0], c[p, 1, 1]
        vx = v[p, 0] - c00 * x[p, 0] - c01 * x[p, 1]
        vy = v[p, 1] - c10 * x[p, 0] - c11 * x[p, 1]
        for k in range(p * entries, (p + 1) * entries):
            i = nodes[k]
            phi_m, qx, qy = phi[k] * m[p], xi[i, 0], xi[i, 1]
            mi[i] += phi_m
            pi[i, 0] += phi_m * (vx + c00 * qx + c01 * qy)
            pi[i, 1] += phi_m * (vy + c10 * qx + c11 * qy)
    for i in range(len(mi)):
        inverse = 1.0 / mi[i] if mi[i] > 0.0 else 0.0
        vi[i, 0] = pi[i, 0] * inverse
        vi[i, 1] = pi[i, 1] * inverse


@kernel
def _force(
    nodes: Indices,
    dphi: Floats,
    volume: Floats,
    stress: Floats,
    mi: Floats,
    pi: Floats,
    fi: Floats,
    vi: Floats,
    dt: float,
) -> None:
    entries = len(nodes) // len(volume)
    for p in range(len(volume)):
        s00, s01 = -volume[p] * stress[p, 0, 0], -volume[p] * stress[p, 0, 1]
        s10, s11 = -volume[p] * stress[p, 1, 0], -volume[p] * stress[p, 1, 1]
        for k in range(p * entries, (p + 1) * entries):
            i, gx, gy = nodes[k], dphi[k, 0], dphi[k, 1]
            fi[i, 0] += s00 * gx + s01 * gy
            fi[i, 1] += s10 * gx + s11 * gy
    for i in range(len(mi)):
        inverse = 1.0 / mi[i] if mi[i] > 0.0 else 0.0
        for d in range(2):
            pi[i, d] += dt * fi[i, d] if mi[i] > 0.0 else 0.0
            vi[i, d] = pi[i, d] * inverse


@kernel
def _gather(
    nodes: Indices,
    phi: Floats,
    dphi: Floats,
    xi: Floats,
    vi: Floats,
    v0: Floats,
    v: Floats,
    x: Floats,
    l: Floats,
    c: Floats,
    flip: float,
    dt: float,
) -> None:
    entries = len(nodes) // len(x)
    for p in range(len(x)):
        px, py, nx, ny, ox, oy = x[p, 0], x[p, 1], 0.0, 0.0, 0.0, 0.0
        l00 = l01 = l10 = l11 = b00 = b01 = b10 = b11 = d00 = d01 = d11 = 0.0
        for k in range(p * entries, (p + 1) * entries):
            i, w, gx, gy = nodes[k], phi[k], dphi[k, 0], dphi[k, 1]
            vx, vy, qx, qy = vi[i, 0], vi[i, 1], xi[i, 0] - px, xi[i, 1] - py
            nx, ny, ox, oy = nx + w * vx, ny + w * vy, ox + w * v0[i, 0], oy + w * v0[i, 1]
            l00, l01, l10, l11 = l00 + vx * gx, l01 + vx * gy, l10 + vy * gx, l11 + vy * gy
            if entries > 4:
                b00, b01, b10, b11 = (
                    b00 + w * vx * qx,
                    b01 + w * vx * qy,
                    b10 + w * vy * qx,
                    b11 + w * vy * qy,
                )
                d00, d01, d11 = d00 + w * qx * qx, d01 + w * qx * qy, d11 + w * qy * qy
        v[p, 0] = flip * (v[p, 0] + nx - ox) + (1.0 - flip) * nx
        v[p, 1] = flip * (v[p, 1] + ny - oy) + (1.0 - flip) * ny
        x[p, 0], x[p, 1] = px + dt * nx, py + dt * ny
        l[p, 0, 0], l[p, 0, 1], l[p, 1, 0], l[p, 1, 1] = l00, l01, l10, l11
        if entries > 4:  # B D⁻¹, in the place of L
            s = 1.0 / (d00 * d11 - d01 * d01)
            l00, l01 = (b00 * d11 - b01 * d01) * s, (b01 * d00 - b00 * d01) * s
            l10, l11 = (b10 * d11 - b11 * d01) * s, (b11 * d00 - b10 * d01) * s
        a, b, e, f = 1.0 + dt * l00, dt * l01, dt * l10, 1.0 + dt * l11
        s = 1.0 / (a * f - b * e)
        c[p, 0, 0], c[p, 0, 1] = (l00 * f - l01 * e) * s, (l01 * a - l00 * b) * s
        c[p, 1, 0], c[p, 1, 1] = (l10 * f - l11 * e) * s, (l11 * a - l10 * b) * s


@kernel
def _material(
    l: Floats, f: Floats, v0: Floats, volume: Floats, stress: Floats, bulk: float, shear: float, dt: float
) -> None:
    lame = bulk - 2.0 * shear / 3.0
    for p in range(len(volume)):
        f00, f01, f10, f11 = f[p, 0, 0], f[p, 0, 1], f[p, 1, 0], f[p, 1, 1]
        a, b, c, d = 1.0 + dt * l[p, 0, 0], dt * l[p, 0, 1], dt * l[p, 1, 0], 1.0 + dt * l[p, 1, 1]
        f00, f01, f10, f11 = a * f00 + b * f10, a * f01 + b * f11, c * f00 + d * f10, c * f01 + d * f11
        f[p, 0, 0], f[p, 0, 1], f[p, 1, 0], f[p, 1, 1] = f00, f01, f10, f11
        j = f00 * f11 - f01 * f10
        volume[p] = j * v0[p]
        pressure = lame * math.log(j) - shear
        stress[p, 0, 0] = (shear * (f00 * f00 + f01 * f01) + pressure) / j
        stress[p, 1, 1] = (shear * (f10 * f10 + f11 * f11) + pressure) / j
        stress[p, 0, 1] = stress[p, 1, 0] = shear * (f00 * f10 + f01 * f11) / j


def calls(shape: str, x: SimpleNamespace) -> dict[str, Callable[[], object]]:
    """The stages of a step of problem ``x``, which they change in place."""
    table = (x.nodes, x.weight, x.gradient)
    domain = (x.position, x.deformation, x.half_edges)
    nodal = (x.node_mass, x.momentum, x.force)

    def fill() -> None:
        if shape == "cpdi":
            _fill_cpdi(*domain, x.nodes_per_axis, x.h, *table)
        else:
            kind = ("linear", "gimp", "bspline").index(shape)
            _fill_product(kind, x.position, x.half_length, x.nodes_per_axis, x.h, *table)

    points = (x.mass, x.velocity, x.position, x.affine, x.node_position)
    moving = (x.velocity, x.position, x.velocity_gradient, x.affine)
    fields = (x.node_position, x.node_velocity, x.start_velocity)
    solid = (x.velocity_gradient, x.deformation, x.initial_volume, x.volume, x.stress)
    return {
        "shape": fill,
        "projection": lambda: _project(x.nodes, x.weight, *points, *nodal, x.start_velocity),
        "force": lambda: _force(x.nodes, x.gradient, x.volume, x.stress, *nodal, x.node_velocity, x.dt),
        "gather": lambda: _gather(*table, *fields, *moving, x.flip, x.dt),
        "material": lambda: _material(*solid, x.bulk, x.shear, x.dt),
    }
