"""Spinning disc."""
# cost: 22

# Angular momentum, radius and energy of a disc over one turn, and the inertia that answers a torque:
# every transfer with every scheme, every shape function, every treatment of rotational inertia. Against
# the static solution. Those that auto runs with USL and aflip.

import torque
import turning

from mpmfw.validation import RECOMMENDED, SHAPES, Runs, methods

turn = Runs(
    "turn",
    methods=[
        *methods([""], RECOMMENDED, when="quick"),
        *methods([""], SHAPES, when="full"),
        *methods(
            [""],
            settings={
                "flip, usl": {"stepping.transfer": "flip", "stepping.scheme": "usl"},
                "flip, musl": {"stepping.transfer": "flip", "stepping.scheme": "musl"},
                "flip, usf": {"stepping.transfer": "flip", "stepping.scheme": "usf"},
                "pic, usl": {"stepping.transfer": "pic", "stepping.scheme": "usl"},
                "pic, musl": {"stepping.transfer": "pic", "stepping.scheme": "musl"},
                "pic, usf": {"stepping.transfer": "pic", "stepping.scheme": "usf"},
                "apic, usl": {"stepping.transfer": "apic", "stepping.scheme": "usl"},
                "apic, musl": {"stepping.transfer": "apic", "stepping.scheme": "musl"},
                "apic, usf": {"stepping.transfer": "apic", "stepping.scheme": "usf"},
                "tpic, usl": {"stepping.transfer": "tpic", "stepping.scheme": "usl"},
                "tpic, musl": {"stepping.transfer": "tpic", "stepping.scheme": "musl"},
                "tpic, usf": {"stepping.transfer": "tpic", "stepping.scheme": "usf"},
                "aflip, usl": {"stepping.transfer": "aflip", "stepping.scheme": "usl"},
                "aflip, musl": {"stepping.transfer": "aflip", "stepping.scheme": "musl"},
                "aflip, usf": {"stepping.transfer": "aflip", "stepping.scheme": "usf"},
                "aflip, usl, C not transported": {
                    "stepping.transfer": "aflip",
                    "stepping.scheme": "usl",
                    "stepping.transported": False,
                },
                "flip, usl, 5 % pic": {
                    "stepping.transfer": "flip",
                    "stepping.scheme": "usl",
                    "stepping.pic_fraction": 0.05,
                },
                "rotation exact": {"bodies.disc.rotation": "exact"},
                "rotation lumped": {"bodies.disc.rotation": "lumped"},
            },
            when="full",
        ),
    ],
)


@turn
def test_turn(run):
    for quantity, key, reference, tolerance, unit in (
        ("angular momentum, change per turn", "momentum", 0.0, 0.05, "%"),
        ("radius of gyration, mean growth over the static", "growth", 1.0, None, ""),
        ("energy, change per turn", "energy", 0.0, None, "%"),
    ):
        run.gate(quantity, run.of(turning.change, key), reference, tolerance, unit)
    run.gate(
        "strain energy over kinetic, mean",
        run.of(turning.change, "strain"),
        run.of(turning.change, "static strain"),
        unit="%",
    )


scene = Runs(
    "",
    methods=[
        *methods([""], RECOMMENDED, when="quick"),
        *methods([""], SHAPES, when="full"),
        *methods(
            [""],
            ["gimp", "cpdi", "cpdi2", "bspline"],
            settings={
                "rotation exact": {"bodies.disc.rotation": "exact"},
                "rotation lumped": {"bodies.disc.rotation": "lumped"},
            },
            when="full",
        ),
    ],
    set={"bodies.disc.angular_velocity": 0.0},
    by=torque.inertia,
)


@scene
def test_scene(run):
    run.gate(
        "inertia under a torque on the disc, error", run.of(torque.answer, "disc", scale=100.0), 0.0, 0.5, "%"
    )
    run.gate(
        "inertia under a torque on its rim, error", run.of(torque.answer, "rim", scale=100.0), 0.0, 0.5, "%"
    )
