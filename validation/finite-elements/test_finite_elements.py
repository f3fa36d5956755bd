"""The finite-element program: verified by itself, then against the shipped reference."""

import itertools

import numpy as np
from rings_fem import Collision, collide, distance
from rings_fem import verification as verify

from mpmfw.results.analysis import contact_phases
from mpmfw.validation import Case

#: By element size [mm]: how far the reference's own coarser runs lie from its fine one, in the L2 norm of the
#: force averaged over 100 µs and in the impulse curve (README of the reference), plus a quarter; a half where
#: it gives one digit.
LIMITS = {2.0: (0.24, 0.030), 1.0: (0.15, 0.018), 0.5: (0.045, 0.006)}
FIRST_CONTACT = 4e-3 / 60.0  #: exact [s]


def test_finite_elements(case: Case) -> None:
    """Elements, then vibration, then the collision at falling element sizes."""
    check_elements(case)
    check_vibration(case)
    collisions = []
    for size in (2e-3, 1e-3) if case.quick else (2e-3, 1e-3, 0.5e-3):
        with case.timed():
            collisions.append(collide(size))
        check_conservation(case, collisions[-1])
        check_distance(case, collisions[-1])
    check_convergence(case, collisions)
    check_coarse(case, collisions[0])


def check_elements(case: Case) -> None:
    """Patch test, rotation, gradients: exact up to round-off, or to the error of a central difference."""
    with case.timed():
        patches = [verify.patch_test(np.array(gradient)) for gradient in verify.HOMOGENEOUS]
    for said in patches[0]:
        worst = max(patch[said] for patch in patches)
        case.gate(f"patch test: {said}", worst, reference=0.0, tolerance=(0.0, 1e-12), method="elements")
    with case.timed():
        rotation = verify.rotation_error(1.0)
        internal, contact = verify.internal_gradient_error(), verify.contact_gradient_error()
        balance = verify.contact_balance_error()
    case.gate("force of a rigid rotation by 1 rad", rotation, 0.0, (0.0, 1e-12), method="elements")
    case.gate("force against energy differences", internal, 0.0, (0.0, 1e-7), method="elements")
    case.gate("force against energy differences", contact, 0.0, (0.0, 1e-7), method="contact")
    case.gate("resultant and moment", balance, reference=0.0, tolerance=(0.0, 1e-12), method="contact")


def check_vibration(case: Case) -> None:
    """Breathing mode of one ring against the Bessel functions; errors by element size [m]."""
    errors: dict[float, float] = {}
    for size in (2e-3, 1e-3):
        with case.timed():
            errors[size] = verify.breathing_error(size)
        quantity = "breathing frequency of a ring, error"
        case.gate(quantity, 100.0 * errors[size], 0.0, (-0.1, 0.1), "%", f"{1e3 * size:g} mm")
    order = float(np.log2(errors[2e-3] / errors[1e-3]))
    case.gate("order of its convergence", order, reference=2.0, tolerance=(1.8, 2.2), method="2 and 1 mm")


def check_conservation(case: Case, collision: Collision) -> None:
    """Energy and momentum, and the time at which the rings meet."""
    method = f"{1e3 * collision.size:g} mm"
    quantity = "energy balance, largest departure"
    case.gate(quantity, 100.0 * collision.energy_error, 0.0, (0.0, 0.2), "%", method)
    case.gate("linear momentum", collision.momentum_error, 0.0, (0.0, 1e-12), method=method)
    step = collision.time[1]
    phases = contact_phases(collision.time, collision.force)
    # Polygons of N corners that meet side to corner are R (1 - cos(π/N)) further apart than circles.
    corner = 0.04 * (1.0 - np.cos(np.pi * collision.size / 0.24)) / 60.0
    case.gate(
        "first contact",
        1e3 * phases.first,
        reference=1e3 * FIRST_CONTACT,
        tolerance=(1e3 * (FIRST_CONTACT - step), 1e3 * (FIRST_CONTACT + corner + 2.0 * step)),
        unit="ms",
        method=method,
    )


def check_distance(case: Case, collision: Collision) -> None:
    """Curves and stresses against the fine reference."""
    method, apart = f"{1e3 * collision.size:g} mm", distance(collision)
    force, impulse = LIMITS[1e3 * collision.size]
    case.gate("force averaged over 100 µs, L2 error", apart["force"], 0.0, (0.0, force), method=method)
    for quantity, value, most in (
        ("impulse curve, largest error over the total", apart["impulse"], 100.0 * impulse),
        ("total impulse, error", abs(apart["total"]), 1.5),
        ("kinetic energy, largest error over the start", apart["kinetic"], 8.0),
    ):
        case.gate(quantity, 100.0 * value, reference=0.0, tolerance=(0.0, most), unit="%", method=method)
    for snapshot, mean, most in zip(
        collision.snapshots[1:], (3.200, 6.229, 1.855), (8.024, 14.085, 3.822), strict=True
    ):
        at = f"{1e3 * snapshot.time:.1f} ms"
        for quantity, value, exact, part in (
            (f"von Mises stress, mean, {at}", snapshot.mean, mean, 0.15),
            (f"von Mises stress, 95th percentile, {at}", snapshot.percentile(95.0), most, 0.10),
        ):
            within = ((1.0 - part) * exact, (1.0 + part) * exact)
            case.gate(quantity, 1e-6 * value, reference=exact, tolerance=within, unit="MPa", method=method)


def check_convergence(case: Case, collisions: list[Collision]) -> None:
    """Each halving of the elements brings both curves closer to the fine ones."""
    for coarse, fine in itertools.pairwise(collisions):
        before, after = distance(coarse), distance(fine)
        method = f"{1e3 * coarse.size:g} to {1e3 * fine.size:g} mm"
        for name in ("force", "impulse"):
            quantity, ratio = f"{name} error left by halving the elements", after[name] / before[name]
            case.gate(quantity, ratio, reference="below 1", tolerance=(0.0, 0.8), method=method)


def check_coarse(case: Case, collision: Collision) -> None:
    """The curve of 2 mm against the shipped one of 2 mm: another program, so not the same to the digit."""
    apart = distance(collision, "coarse")
    force, impulse = 0.5 * LIMITS[2.0][0], 50.0 * LIMITS[2.0][1]
    method = "2 mm, against the shipped 2 mm"
    quantity = "force averaged over 100 µs, L2 difference"
    case.gate(quantity, apart["force"], 0.0, (0.0, force), method=method)
    quantity = "impulse curve, largest difference over the total"
    case.gate(quantity, 100.0 * apart["impulse"], 0.0, (0.0, impulse), "%", method)
