"""Measure a step on a graphics card: four kernels without contact, quadratic B-splines in the plane, one
thread a point, float64, with mpmfw's arrays. mpmfw does not use them.

    python tests/benchmarks/gpu.py [--counts 17600,100000,1000000]

It needs a card and numba-cuda; with NUMBA_ENABLE_CUDASIM=1 a few points run without a card."""

import argparse
import time

import numpy as np
from numba import cuda

MU, LAM, DT = 1.0e3, 1.5e3, 1e-4


@cuda.jit(device=True, inline=True)
def weights(x, w, s):
    """Set three functions along an axis, and their derivatives; return the first node (cells of 1 m)."""
    base = int(x - 0.5)
    d = x - base - 1.0
    w[0], w[1], w[2] = 0.5 * (0.5 - d) ** 2, 0.75 - d * d, 0.5 * (0.5 + d) ** 2
    s[0], s[1], s[2] = d - 0.5, -2.0 * d, d + 0.5
    return base


@cuda.jit
def project(x, v, affine, stress, volume, mass, m_i, mv_i, f_i):
    p = cuda.grid(1)
    if p >= len(mass):
        return
    wx, sx = cuda.local.array(3, "f8"), cuda.local.array(3, "f8")
    wy, sy = cuda.local.array(3, "f8"), cuda.local.array(3, "f8")
    i, j = weights(x[p, 0], wx, sx), weights(x[p, 1], wy, sy)
    for a in range(3):
        for b in range(3):
            w, qx, qy = wx[a] * wy[b] * mass[p], i + a - x[p, 0], j + b - x[p, 1]
            gx, gy = sx[a] * wy[b] * volume[p], wx[a] * sy[b] * volume[p]
            cuda.atomic.add(m_i, (i + a, j + b), w)
            for d in range(2):
                at = v[p, d] + affine[p, d, 0] * qx + affine[p, d, 1] * qy
                cuda.atomic.add(mv_i, (i + a, j + b, d), w * at)
                cuda.atomic.add(f_i, (i + a, j + b, d), -stress[p, d, 0] * gx - stress[p, d, 1] * gy)


@cuda.jit
def advance_nodes(m_i, mv_i, f_i, v_i, start):
    i, j = cuda.grid(2)
    if i < m_i.shape[0] and j < m_i.shape[1]:
        for d in range(2):
            m = m_i[i, j]
            start[i, j, d] = mv_i[i, j, d] / m if m > 0.0 else 0.0
            v_i[i, j, d] = (mv_i[i, j, d] + DT * f_i[i, j, d]) / m if m > 0.0 else 0.0
            mv_i[i, j, d] = f_i[i, j, d] = 0.0
        m_i[i, j] = 0.0


@cuda.jit
def gather(x, v, affine, grad, v_i, start):
    p = cuda.grid(1)
    if p >= len(x):
        return
    wx, sx = cuda.local.array(3, "f8"), cuda.local.array(3, "f8")
    wy, sy = cuda.local.array(3, "f8"), cuda.local.array(3, "f8")
    i, j = weights(x[p, 0], wx, sx), weights(x[p, 1], wy, sy)
    for d in range(2):
        new = old = gx = gy = bx = by = 0.0
        for a in range(3):
            for b in range(3):
                w, u = wx[a] * wy[b], v_i[i + a, j + b, d]
                new, old = new + w * u, old + w * start[i + a, j + b, d]
                gx, gy = gx + sx[a] * wy[b] * u, gy + wx[a] * sy[b] * u
                bx, by = bx + w * u * (i + a - x[p, 0]), by + w * u * (j + b - x[p, 1])
        grad[p, d, 0], grad[p, d, 1], affine[p, d, 0], affine[p, d, 1] = gx, gy, 4.0 * bx, 4.0 * by
        v[p, d] += new - old
        x[p, d] += DT * new


@cuda.jit
def update(grad, deformation, stress, volume, start_volume):
    p = cuda.grid(1)
    if p >= len(volume):
        return
    f = deformation[p]
    a, b = 1.0 + DT * grad[p, 0, 0], DT * grad[p, 0, 1]
    c, d = DT * grad[p, 1, 0], 1.0 + DT * grad[p, 1, 1]
    f00, f01 = a * f[0, 0] + b * f[1, 0], a * f[0, 1] + b * f[1, 1]
    f10, f11 = c * f[0, 0] + d * f[1, 0], c * f[0, 1] + d * f[1, 1]
    f[0, 0], f[0, 1], f[1, 0], f[1, 1] = f00, f01, f10, f11
    j = f00 * f11 - f01 * f10
    pressure = LAM * (j - 1.0)
    stress[p, 0, 0] = MU / j * (f00 * f00 + f01 * f01 - 1.0) + pressure
    stress[p, 1, 1] = MU / j * (f10 * f10 + f11 * f11 - 1.0) + pressure
    stress[p, 0, 1] = stress[p, 1, 0] = MU / j * (f00 * f10 + f01 * f11)
    volume[p] = j * start_volume[p]


def measure(count, per=4, steps=200):
    """Nanoseconds a point and step, and microseconds a step."""
    side = int(np.sqrt(count)) // per * per
    axis = (np.arange(side) + 0.5) / per + 4.0
    x = np.stack(np.meshgrid(axis, axis, indexing="ij"), -1)
    x = x.reshape(side // per, per, side // per, per, 2).swapaxes(1, 2).reshape(-1, 2).copy()  # by cell
    n, nodes = len(x), (side // per + 8,) * 2
    rng = np.random.default_rng(0)
    v = 0.02 * rng.standard_normal((n, 2))
    eye = np.broadcast_to(np.eye(2), (n, 2, 2)).copy()
    own = [x, v, np.zeros((n, 2, 2)), np.zeros((n, 2, 2)), eye, np.zeros((n, 2, 2)), np.full(n, 1.0 / per**2)]
    x, v, affine, grad, deformation, stress, volume = map(cuda.to_device, own)
    mass, start_volume = cuda.to_device(own[6]), cuda.to_device(own[6])
    m_i, mv_i, f_i, v_i, start = (
        cuda.to_device(np.zeros(nodes + tail)) for tail in ((), (2,), (2,), (2,), (2,))
    )
    blocks, patches = -(-n // 128), (-(-nodes[0] // 16),) * 2

    def step():
        project[blocks, 128](x, v, affine, stress, volume, mass, m_i, mv_i, f_i)
        advance_nodes[patches, (16, 16)](m_i, mv_i, f_i, v_i, start)
        gather[blocks, 128](x, v, affine, grad, v_i, start)
        update[blocks, 128](grad, deformation, stress, volume, start_volume)

    before = (own[6][:, None] * own[1]).sum(0)
    step()
    cuda.synchronize()
    least = np.inf
    for _ in range(5):
        begin = time.perf_counter()
        for _ in range(steps // 5):
            step()
        cuda.synchronize()
        least = min(least, (time.perf_counter() - begin) / (steps // 5))
    after = (own[6][:, None] * v.copy_to_host()).sum(0)
    assert np.allclose(before, after, atol=1e-12 * n), (before, after)
    return n, 1e9 * least / n, 1e6 * least


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--counts", default="17600,100000,1000000")
    for count in map(int, parser.parse_args().counts.split(",")):
        n, ns, us = measure(count)
        print(f"{n} points: {ns:.2f} ns a point, {us:.0f} us a step", flush=True)
