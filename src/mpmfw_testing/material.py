"""The checks of materials, on points that are deformed by hand, between points of another body."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.history import put, take
from mpmfw.state.structs import Body, State
from mpmfw.state.windows import make_grid
from mpmfw_testing.bench import dims_of, in_each_dimension, points_at_rest, set_up
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.generic import repeatable, runs, saved, sent, unchanged
from mpmfw_testing.subject import Subject

#: Points of another body before and behind those of the material.
OTHERS = 2
#: Stress that the others are given [Pa], so that a change of it is seen.
MARK = 12345.678
#: Length of a step [s], for materials whose stress depends on the rate.
STEP = 1e-5
#: Strain of paths; arrays that a step of the bench writes, or that the material may.
SIZE, WRITTEN = 0.05, ("deformation_gradient", "volume", "stress")
#: Strain at which moduli are read off.
SMALL = 1e-6
#: Deviation of the moduli, of stresses that turn, and of plane strain, over K + 4 G / 3 and the strain.
MODULI, TURNED, PLANE = 1e-3, 1e-9, 1e-12
#: Work that is neither stored nor lost, over the largest work of the path; strains and steps of that path.
UNEXPLAINED, SIZES, STEPS = 0.02, (1e-3, 0.1, 0.4), 2000
#: Energy that may come back, over K + 4 G / 3.
RETURNED = 1e-14
#: Stretch of a step, and steps, of points that open without end; deviation of their volume.
OPENING, OPENED, VOLUME = 1.03, 60, 1e-12


class Bench:
    """So many points of a material under deformations that are given; a session along one path."""

    def __init__(self, material: Any, dim: int, count: int = 4) -> None:
        total = count + 2 * OTHERS
        self.dim, self.own, self.material = dim, slice(OTHERS, OTHERS + count), material
        material.slices = (self.own,)
        position = np.random.default_rng(1).uniform(1.0, 2.0, (total, dim))
        self.particles = points_at_rest(position, np.ones(total), [0, total], MARK)
        grid = make_grid(1.0, np.zeros(dim), np.zeros(dim) + 4.0, 1)
        k, g = float(material.bulk_modulus), float(material.shear_modulus)
        ranges = (slice(0, OTHERS), self.own, slice(self.own.stop, total))
        bodies = tuple(
            Body(f"body {i}", i, own, 0, 1.0, k, g, (0.0,) * dim, (1.0,) * dim, ())
            for i, own in enumerate(ranges)
        )
        self.state = State(self.particles, grid, bodies, ())
        self.setup, self.hook = set_up(material, self.state)
        self.modulus = k + 4.0 * g / 3.0  #: [Pa]
        self.rest = iter(path(dim, count, SIZE, 20))

    def deform(self, deformation_gradient: FloatArray) -> FloatArray:
        """Return the Cauchy stress of the points (n, dim, dim) [Pa] after a step to F (n, dim, dim)."""
        p = self.particles
        p.deformation_gradient[self.own] = deformation_gradient
        p.volume[self.own] = p.initial_volume[self.own] * np.linalg.det(deformation_gradient)
        self.hook.update_stress(particles=p, dt=STEP)
        return p.stress[self.own].copy()

    def energy(self) -> FloatArray:
        """Return the stored energy of the points, (n,) [J/m^3]."""
        return np.array(self.material.energy_of_points(self.particles, self.own), dtype=float)

    def dissipated(self) -> FloatArray:
        """Return the energy that the points have lost, (n,) [J/m^3]."""
        return np.array(self.material.dissipated_by_points(self.particles, self.own), dtype=float)

    def full_stress(self) -> FloatArray:
        """Return the full stress of the points, (n, 3, 3) [Pa]."""
        return np.asarray(self.material.stress_of_points(self.particles, self.own), dtype=float)

    def advance(self) -> Iterator[tuple[str, AnyArray]]:
        """Go ten steps along the path; yield the stress of each, then the other results."""
        for k, f in zip(range(10), self.rest, strict=False):
            yield f"stress in {self.dim}D, step {k}", self.deform(f)
        n = self.own.stop - self.own.start
        for name, found, shape in (
            ("energy_of_points", self.energy(), (n,)),
            ("stress_of_points", self.full_stress(), (n, 3, 3)),
            ("dissipated_by_points", self.dissipated(), (n,)),
        ):
            if found.shape != shape:
                raise Violation(f"{name} has the shape {found.shape}; expected {shape}", {"dim": self.dim})
            yield f"{name} in {self.dim}D", found

    def save(self) -> dict[str, AnyArray]:
        """Return the history of the points and the material."""
        return take({"state": self.state, "material": self.material})

    def load(self, kept: dict[str, AnyArray]) -> None:
        """Take it, and go on along the second half of the path."""
        put(kept, {"state": self.state, "material": self.material})
        for _ in range(10):
            next(self.rest)


def path(dim: int, count: int, size: float, steps: int, seed: int = 0) -> FloatArray:
    """Return deformations (steps + 1, n, dim, dim) with stretch and shear of ``size``, and back, turning."""
    rng = np.random.default_rng(seed)
    direction, spin = rng.uniform(-1.0, 1.0, (2, count, dim, dim))
    spin = 0.5 * (spin - np.swapaxes(spin, 1, 2))
    time = np.linspace(0.0, 1.0, steps + 1)
    strain = size * np.sin(3.0 * time)[:, None, None, None] * direction
    return np.asarray(rotation(time[:, None, None, None] * spin) @ (np.eye(dim) + strain))


def rotation(spin: FloatArray) -> FloatArray:
    """Return Cayley's rotation (1 − W/2)⁻¹ (1 + W/2) of antisymmetric W (…, dim, dim)."""
    one = np.eye(spin.shape[-1])
    return np.asarray(np.linalg.solve(one - 0.5 * spin, one + 0.5 * spin))


def openings(subject: Subject) -> Iterator[Callable[[Any], Bench]]:
    """Yield four points of each dimension."""
    for dim in dims_of(subject):
        yield functools.partial(Bench, dim=dim)


@in_each_dimension
def changes_nothing_else(subject: Subject, dim: int) -> None:
    """It writes the stress of its own points, and nothing else."""
    bench = Bench(subject.make(), dim)
    p = bench.particles
    for f in path(dim, 4, SIZE, 5):
        with unchanged("update_stress", p, but=WRITTEN):
            bench.deform(f)
        if not np.array_equal(p.deformation_gradient[bench.own], f):
            raise Violation("update_stress changes deformation_gradient")
    if (np.delete(p.stress, np.r_[bench.own], axis=0) != MARK).any():
        raise Violation("update_stress writes the stress of points of another material")


@in_each_dimension
def volume(subject: Subject, dim: int) -> None:
    """The volume stays det F V⁰, to 1e-12 of it. Points open by 3 % along each axis in 60 steps.

    Forces and outputs use V beside F. A material that replaces F, which small strains must not do, changes V
    with it."""
    bench = Bench(subject.make(), dim)
    p, own = bench.particles, bench.own
    for step in range(OPENED):
        bench.deform(OPENING * p.deformation_gradient[own])
        expected = np.linalg.det(p.deformation_gradient[own]) * p.initial_volume[own]
        off = np.abs(p.volume[own] / expected - 1.0).max()
        within(off, VOLUME, "after update_stress the volume is not det F V⁰", {"step": step})


@in_each_dimension
def each_for_itself(subject: Subject, dim: int) -> None:
    """A point's stress, energy and loss depend on its own deformations alone. They are bitwise the same in
    another order and company."""
    many, few, order = Bench(subject.make(), dim, 6), Bench(subject.make(), dim, 3), np.array([4, 1, 5])
    for f in path(dim, 6, SIZE, 10):
        stress, alone = many.deform(f), few.deform(f[order])
    _require_same(
        {"stress": stress[order], "energy": many.energy()[order], "loss": many.dissipated()[order]},
        {"stress": alone, "energy": few.energy(), "loss": few.dissipated()},
        0.0, "the {} of a point depends on the points beside it",
    )  # fmt: skip


@in_each_dimension
def rest(subject: Subject, dim: int) -> None:
    """Without strain there is neither stress nor energy, however the body is turned. At F = 1 and at a
    rotation stress and energy are at most 1e-12 of K + 4 G / 3."""
    bench = Bench(subject.make(), dim, 1)
    spin = np.zeros((1, dim, dim))
    for angle in (0.0, 0.7, 2.0):
        spin[0, 0, 1], spin[0, 1, 0] = -angle, angle
        stress = np.abs(bench.deform(rotation(spin))).max()
        case = {"rotation W_21": angle}
        for name, found in (("stress", stress), ("energy", np.abs(bench.energy()).max())):
            text = f"there is {name} without strain (over K + 4 G / 3)"
            within(found / bench.modulus, 1e-12, text, case)


@in_each_dimension
def moduli(subject: Subject, dim: int) -> None:
    """At small strain the stress is that of bulk_modulus and shear_modulus. σ = K tr ε + 2 G dev ε at a
    strain of 1e-6, to 1e-3: wave speeds, and with them stable steps, are made of K and G.

    In every component; a plastic material must not flow yet.
    """
    bench = Bench(subject.make(), dim, 8)
    strain = SMALL * np.random.default_rng(3).uniform(-1.0, 1.0, (8, dim, dim))
    strain = 0.5 * (strain + np.swapaxes(strain, 1, 2))
    k, g = float(bench.material.bulk_modulus), float(bench.material.shear_modulus)
    trace = np.einsum("nii->n", strain)[:, None, None]
    expected = (k - 2.0 * g / 3.0) * trace * np.eye(dim) + 2.0 * g * strain
    off = np.abs(bench.deform(np.eye(dim) + strain) - expected).max() / (bench.modulus * SMALL)
    case = {"bulk_modulus [Pa]": k, "shear_modulus [Pa]": g}
    within(off, MODULI, "the stress at small strain is not that of the moduli", case)


@in_each_dimension
def objectivity(subject: Subject, dim: int) -> None:
    """An observer who turns sees the turned stress, and the same energy. Turned by Q(t) the same path gives Q
    σ Qᵀ, the same energy and the same loss, to 1e-9 of K + 4 G / 3."""
    plain, turned = Bench(subject.make(), dim), Bench(subject.make(), dim)
    spin = np.zeros((dim, dim))
    spin[0, 1], spin[1, 0], spin[-1, 0], spin[0, -1] = -1.0, 1.0, 1.0, -1.0
    for k, f in enumerate(path(dim, 4, 0.1, 40)):
        q = rotation(0.1 * k * spin)
        stress, seen = q @ plain.deform(f) @ q.T, turned.deform(q @ f)
        _require_same(
            {"stress": stress, "energy": plain.energy(), "loss": plain.dissipated()},
            {"stress": seen, "energy": turned.energy(), "loss": turned.dissipated()},
            TURNED * plain.modulus, "an observer who turns sees another {}", step=k,
        )  # fmt: skip


@in_each_dimension
def full_stress(subject: Subject, dim: int) -> None:
    """The stress for outputs is that of the step, and symmetric. ``stress_of_points`` is the stress of the
    step: symmetric, its plane part to 1e-9 of K + 4 G / 3."""
    bench = Bench(subject.make(), dim)
    for f in path(dim, 4, SIZE, 10):
        stress = bench.deform(f)
    full = bench.full_stress()
    off = np.abs(full[:, :dim, :dim] - stress).max() / bench.modulus
    within(off, TURNED, "the stress for outputs is not that of the step (over K + 4 G / 3)")
    for name, tensor in (("stress", stress), ("stress for outputs", full)):
        uneven = np.abs(tensor - np.swapaxes(tensor, 1, 2)).max() / bench.modulus
        within(uneven, 1e-12, f"the {name} is not symmetric (over K + 4 G / 3)")


def plane_strain(subject: Subject) -> None:
    """Two dimensions are plane strain. As 3D with F_zz = 1, to 1e-12 of K + 4 G / 3."""
    if not {2, 3} <= set(dims_of(subject)):
        raise Inapplicable("the material does not work in both dimensions")
    plane, space = Bench(subject.make(), 2), Bench(subject.make(), 3)
    for f in path(2, 4, SIZE, 10):
        padded = np.tile(np.eye(3), (len(f), 1, 1))
        padded[:, :2, :2] = f
        in_plane, in_space = plane.deform(f), space.deform(padded)
    _require_same(
        {"stress": in_plane, "energy": plane.energy(), "stress for outputs": plane.full_stress()},
        {"stress": in_space[:, :2, :2], "energy": space.energy(), "stress for outputs": space.full_stress()},
        PLANE * plane.modulus, "the {} in 2D is not that of plane strain",
    )  # fmt: skip


def _require_same(
    first: dict[str, FloatArray], second: dict[str, FloatArray], bound: float, message: str, **case: object
) -> None:
    """Require that results of the same names differ by at most ``bound`` [Pa]; ``{}`` stands for the name."""
    for name, values in first.items():
        within(np.abs(values - second[name]).max(), bound, message.format(name), case)


def _history(bench: Bench, steps: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return work, stored and lost energy at every step, (n_steps, n) [J/m^3]."""
    done, energy, lost = [np.zeros(steps.shape[1])], [], []
    before: FloatArray | None = None
    for k, f in enumerate(steps):
        stress = bench.deform(f)
        piola = np.linalg.det(f)[:, None, None] * stress @ np.swapaxes(np.linalg.inv(f), 1, 2)
        if before is not None:
            done.append(done[-1] + 0.5 * np.einsum("nij,nij->n", before + piola, f - steps[k - 1]))
        before = piola
        energy.append(bench.energy())
        lost.append(bench.dissipated())
    return np.array(done), np.array(energy), np.array(lost)


@in_each_dimension
def work(subject: Subject, dim: int) -> None:
    """The work of the stress is stored or lost. Along paths of 2000 steps ∫ P : dF is the change of the
    stored energy and the loss, to 2 % of the largest work.

    At every step, at strains of 0.1, 10 and 40 %, with rotation and most of the way back. A stress that is
    not the gradient of its energy misses it by its own size.
    """
    for size in SIZES:
        done, energy, lost = _history(Bench(subject.make(), dim), path(dim, 4, size, STEPS))
        unexplained = np.abs(done - (energy - energy[0]) - (lost - lost[0]))
        share = unexplained / np.abs(done).max(axis=0)
        step, point = np.unravel_index(int(np.argmax(share)), share.shape)
        case = {
            "strain": size, "step": int(step), "work [J/m^3]": float(done[step, point]),
            "unexplained [J/m^3]": float(unexplained[step, point]),
        }  # fmt: skip
        text = "the work of the stress is neither stored nor lost (a share of the largest work)"
        within(share.max(), UNEXPLAINED, text, case)


@in_each_dimension
def loss(subject: Subject, dim: int) -> None:
    """Lost energy never comes back, and the material declares that it loses some. The loss grows or stays in
    every step, to 1e-14 of K + 4 G / 3.

    A material that says ``dissipates = False`` loses nothing.
    """
    bench = Bench(subject.make(), dim)
    _, _, lost = _history(bench, path(dim, 4, SIZES[1], 200))
    if not bench.material.dissipates and np.any(lost):
        text = "the material loses energy, and says dissipates = False: no series has it"
        raise Violation(text)
    back = -np.diff(lost, axis=0).min() / bench.modulus
    within(back, RETURNED, "energy that was lost comes back (over K + 4 G / 3)")


#: Those first whose failure makes others fail as well.
CHECKS = (
    runs, changes_nothing_else, volume, each_for_itself, repeatable, saved, rest, moduli, objectivity,
    full_stress, plane_strain, work, loss, sent,
)  # fmt: skip
