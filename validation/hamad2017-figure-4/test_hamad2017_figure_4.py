"""Colliding rings, figure 4 of [H17]: total contact force, its impulse, energies and symmetry.

Stiffer springs and finer cells have the same limits. The exact normal: by symmetry the rings meet at x = 0
only. [H17] with the stiffness that the scene has for the penalty contact.
"""
# cost: 290

import drawing
import rings
from classical import LITERAL, POSITION, specified
from rings_fem import collide, distance

from mpmfw.validation import CLASSICAL, RECOMMENDED, SHAPES, Runs, known_red, methods, together

STIFF = {"contact.penalty.kappa": 1.0}
FINE = {
    "grid.cell_size": "1 mm",
    "bodies.left.particles.size": "0.5 cells",
    "bodies.right.particles.size": "0.5 cells",
}
H17 = {"contact.hamad2017.kappa": 0.25}
OUTPUT = {"output.particles": False, "time.output_interval": "5 us"}

bound = Runs(
    "bound",
    "colliding-rings",
    [
        *methods(shape=RECOMMENDED, settings={"": {}, "kappa 1": STIFF}, when="full"),
        *methods(settings={"cells 1 mm": FINE, "cells 1 mm, kappa 1": {**FINE, **STIFF}}, when="full"),
        *methods(when="quick"),
    ],
    set=OUTPUT,
)
#: All other combinations, with the limits that tell methods apart.
others = Runs(
    "others",
    "colliding-rings",
    [
        *methods(["none", *CLASSICAL], SHAPES),
        *methods(shape=["linear", "gimp", "bspline"]),
        *methods(["bardenhagen"], SHAPES, {"criterion position": POSITION}),
        *methods(
            ["bardenhagen"],
            settings={"criterion position, exact normal": {**POSITION, **specified(1.0, 0.0)}},
        ),
        *methods(["hamad2017"], settings={"kappa 0.25": H17, "kappa 0.25, literal": {**H17, **LITERAL}}),
    ],
    set=OUTPUT,
    when="full",
)

#: Quantity, measure, reference, limits and unit: times in ms against the fine finite elements.
IMPULSE = (
    ("total impulse, error", "impulse_error", 0.0, 1.5, "%"),
    ("impulse curve, largest error", "impulse_curve_error", 0.0, (0.0, 5.0), "%"),
    ("force over 100 us, L2 error", "force_error_100us", 0.0, (0.0, 0.45), ""),
    ("kinetic energy, largest error", "energy_curve_error", 0.0, (0.0, 8.0), "%"),
)
APART = (
    ("final separation", "separation", 2.971, (2.971 - 0.06, 2.971 + 0.06), "ms"),
    ("(energy + dissipation) / E0, least", "energy_least", 1.0, (0.88, 1.005), ""),
    ("largest penetration", "largest_penetration", 0.0, (0.0, 0.15), "h"),
)
FURTHER = (
    ("force over 200 us, L2 error", "force_error_200us", 0.0, (0.0, 0.2), ""),
    ("first contact", "first_contact", 0.0667, (0.085 / 3, 0.105), "ms"),
    ("start of the interval without contact", "gap_start", 1.458, (1.458 - 0.06, 1.458 + 0.06), "ms"),
    ("end of the interval without contact", "gap_end", 1.741, (1.741 - 0.06, 1.741 + 0.06), "ms"),
    ("(energy + dissipation) / E0, most", "energy_most", 1.0, (0.88, 1.005), ""),
    ("drift of linear momentum", "momentum", 0.0, (0.0, 1e-12), ""),
    ("mirror error", "mirror", 0.0, (0.0, 0.01), "h"),
)
REBOUND = ("rebound velocity", "rebound", 25.03, None, "m/s")
SHOWN = (
    ("impulse within 0.5 % of its plateau, from", "plateau_start", 1.432, (1.432 - 0.06, 1.432 + 0.06), "ms"),
    ("impulse within 0.5 % of its plateau, until", "plateau_end", 1.76, (1.76 - 0.06, 1.76 + 0.06), "ms"),
    ("force over 50 us, L2 error", "force_error_50us", 0.0, None, ""),
    ("mean penetration", "penetration", "", None, "h"),
    REBOUND,
    ("energy lost in the transfer / E0", "transfer", 0.0, None, ""),
)


@known_red(
    "penalty, cpdi",
    "largest penetration",
    "0.29 h with the shipped kappa = 0.25, 0.11 h with kappa = 1, with which impulse curve and force over "
    "200 us do not hold",
)
@known_red(
    "penalty, cpdi2",
    "largest penetration",
    "0.29 h with the shipped kappa = 0.25, as with CPDI",
)
@bound
def test_bound(run):
    run.gates(rings.measures_of, *IMPULSE, *APART, *FURTHER)
    run.gates(rings.measures_of, *SHOWN, binds=False)


@others
def test_others(run):
    run.gates(rings.measures_of, *IMPULSE, *APART, REBOUND, binds=False)


def test_elements(case):
    names = ("total", "impulse", "force", "kinetic")
    for name, (quantity, _, _, tolerance, unit) in zip(names, IMPULSE, strict=True):
        with case.timed():
            value = (100.0 if unit else 1.0) * distance(collide(2e-3))[name]
        method = "finite elements, 4-node, 2 mm"
        case.gate(quantity, value, "", tolerance, unit, method, binds=False)


@together(bound, others)
def test_figure(case, runs):
    case.figure("", drawing.forces(runs))
