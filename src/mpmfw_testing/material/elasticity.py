"""Rest, moduli, and independence of the observer."""

from __future__ import annotations

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, within
from mpmfw_testing.material.bench import Bench, dims_of, path, rotation
from mpmfw_testing.subject import Subject

#: Strain at which moduli are read off.
SMALL = 1e-6
#: Deviation of the moduli, of stresses that turn, and of plane strain, over K + 4 G / 3 and the strain.
MODULI, TURNED, PLANE = 1e-3, 1e-9, 1e-12


def rest(subject: Subject) -> None:
    """Without strain there is neither stress nor energy, however the body is turned. At F = 1 and at a
    rotation stress and energy are at most 1e-12 of K + 4 G / 3."""
    for dim in dims_of(subject):
        bench = Bench(subject, dim, 1)
        spin = np.zeros((1, dim, dim))
        for angle in (0.0, 0.7, 2.0):
            spin[0, 0, 1], spin[0, 1, 0] = -angle, angle
            stress = np.abs(bench.deform(rotation(spin))).max() / bench.modulus
            energy = np.abs(bench.energy()).max() / bench.modulus
            case: dict[str, object] = {"dim": dim, "rotation W_21": angle}
            within(float(stress), 1e-12, "there is stress without strain (over K + 4 G / 3)", case)
            within(float(energy), 1e-12, "there is energy without strain (over K + 4 G / 3)", case)


def moduli(subject: Subject) -> None:
    """At small strain the stress is that of bulk_modulus and shear_modulus. σ = K tr ε + 2 G dev ε at a
    strain of 1e-6, to 1e-3: wave speeds, and with them stable steps, are made of K and G.

    In every component; a plastic material must not flow yet.
    """
    rng = np.random.default_rng(3)
    for dim in dims_of(subject):
        bench = Bench(subject, dim, 8)
        strain = SMALL * rng.uniform(-1.0, 1.0, (8, dim, dim))
        strain = 0.5 * (strain + np.swapaxes(strain, 1, 2))
        k, g = float(bench.material.bulk_modulus), float(bench.material.shear_modulus)
        trace = np.einsum("nii->n", strain)[:, None, None]
        expected = (k - 2.0 * g / 3.0) * trace * np.eye(dim) + 2.0 * g * strain
        found = bench.deform(np.eye(dim) + strain)
        off = float(np.abs(found - expected).max()) / (bench.modulus * SMALL)
        said = {"bulk_modulus [Pa]": k, "shear_modulus [Pa]": g}
        within(off, MODULI, "the stress at small strain is not that of the moduli", {"dim": dim, **said})


def objectivity(subject: Subject) -> None:
    """An observer who turns sees the turned stress, and the same energy. Turned by Q(t) the same path gives Q
    σ Qᵀ, the same energy and the same loss, to 1e-9 of K + 4 G / 3."""
    for dim in dims_of(subject):
        plain, turned = Bench(subject, dim, 4), Bench(subject, dim, 4)
        spin = np.zeros((dim, dim))
        spin[0, 1], spin[1, 0], spin[-1, 0], spin[0, -1] = -1.0, 1.0, 1.0, -1.0
        for k, f in enumerate(path(dim, 4, 0.1, 40)):
            q = rotation(0.1 * k * spin)
            stress, seen = q @ plain.deform(f) @ q.T, turned.deform(q @ f)
            case: dict[str, object] = {"dim": dim, "step": k}
            pairs = (
                (stress, seen),
                (plain.energy(), turned.energy()),
                (plain.dissipated(), turned.dissipated()),
            )
            for what, (first, second) in zip(("stress", "energy", "loss"), pairs, strict=True):
                off = float(np.abs(first - second).max()) / plain.modulus
                within(off, TURNED, f"an observer who turns sees another {what} (over K + 4 G / 3)", case)


def full_stress(subject: Subject) -> None:
    """The stress for outputs is that of the step, and symmetric. ``stress_of_points`` is the stress of the
    step: symmetric, its plane part to 1e-9 of K + 4 G / 3."""
    for dim in dims_of(subject):
        bench = Bench(subject, dim, 4)
        for f in path(dim, 4, 0.05, 10):
            stress = bench.deform(f)
        full = bench.full_stress()
        scale, case = bench.modulus, {"dim": dim}
        within(
            float(np.abs(full[:, :dim, :dim] - stress).max()) / scale, TURNED,
            "the stress for outputs is not that of the step (over K + 4 G / 3)", dict(case),
        )  # fmt: skip
        for what, tensor in (("stress", stress), ("stress for outputs", full)):
            uneven = float(np.abs(tensor - np.swapaxes(tensor, 1, 2)).max()) / scale
            within(uneven, 1e-12, f"the {what} is not symmetric (over K + 4 G / 3)", dict(case))


def plane_strain(subject: Subject) -> None:
    """Two dimensions are plane strain. As 3D with F_zz = 1, to 1e-12 of K + 4 G / 3."""
    if not {2, 3} <= set(dims_of(subject)):
        raise Inapplicable("the material does not work in both dimensions")
    plane, space = Bench(subject, 2, 4), Bench(subject, 3, 4)
    for f in path(2, 4, 0.05, 10):
        in_plane, in_space = plane.deform(f), space.deform(_padded(f))
    pairs = (
        ("stress", in_plane, in_space[:, :2, :2]), ("energy", plane.energy(), space.energy()),
        ("stress for outputs", plane.full_stress(), space.full_stress()),
    )  # fmt: skip
    for what, first, second in pairs:
        off = float(np.abs(first - second).max()) / plane.modulus
        within(off, PLANE, f"the {what} in 2D is not that of plane strain (over K + 4 G / 3)", {})


def _padded(f: FloatArray) -> FloatArray:
    padded = np.tile(np.eye(3), (len(f), 1, 1))
    padded[:, :2, :2] = f
    return padded


#: In the order in which they are run.
CHECKS = (rest, moduli, objectivity, full_stress, plane_strain)
