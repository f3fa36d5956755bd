"""Spinning disc: angular momentum, radius and energy over one turn, and the inertia that answers a torque.

Every transfer with every scheme, every shape function, every treatment of rotational inertia, against the
static solution.
"""
# cost: 22

import torque
import turning
from classical import over

from mpmfw.validation import RECOMMENDED, SHAPES, Runs, methods

ROTATION = over("bodies.disc.rotation", "rotation {}", ("exact", "lumped"))


def stepping(transfer, scheme, **further):
    """Return a transfer and a scheme, with further options."""
    options = {"transfer": transfer, "scheme": scheme, **further}
    return {f"stepping.{key}": value for key, value in options.items()}


TRANSFERS = ("flip", "pic", "apic", "tpic", "aflip")
STEPPING = {
    **{f"{one}, {scheme}": stepping(one, scheme) for one in TRANSFERS for scheme in ("usl", "musl", "usf")},
    "aflip, usl, C not transported": stepping("aflip", "usl", transported=False),
    "flip, usl, 5 % pic": stepping("flip", "usl", pic_fraction=0.05),
}
PLAIN = [*methods([""], RECOMMENDED, when="quick"), *methods([""], SHAPES, when="full")]

turn = Runs("turn", methods=[*PLAIN, *methods([""], settings={**STEPPING, **ROTATION}, when="full")])
inertia = Runs(
    "inertia",
    methods=[*PLAIN, *methods([""], ["gimp", "cpdi", "cpdi2", "bspline"], ROTATION, when="full")],
    set={"bodies.disc.angular_velocity": 0.0},
    by=torque.inertia,
)


@turn
def test_turn(run):
    run.gates(
        turning.change,
        ("angular momentum, change per turn", "momentum", 0.0, 0.05, "%"),
        ("radius of gyration, mean growth over the static", "growth", 1.0),
        ("energy, change per turn", "energy", 0.0, None, "%"),
        ("strain energy over kinetic, mean", "strain", round(100.0 * turning.static()[1], 3), None, "%"),
    )


@inertia
def test_inertia(run):
    for where, key in (("the disc", "disc"), ("its rim", "rim")):
        error = 100.0 * run.results[key]
        run.gate(f"inertia under a torque on {where}, error", error, 0.0, 0.5, "%")
