"""Damping the oscillations of an impact."""
# cost: 190

# How to damp the oscillations of an impact's contact force: nothing but sanity is gated, of the scene as
# it is shipped and of the sign of damping. References are of the fine finite elements. The answer again
# with a quarter of the material points.

import drawn

from mpmfw.validation import Runs, methods

scene = Runs(
    "",
    scene="colliding-rings",
    methods=[
        *methods(
            settings={
                "": {},
                "damping 0.1": {"contact.penalty.damping": 0.1},
                "damping 0.3": {"contact.penalty.damping": 0.3},
                "damping 1": {"contact.penalty.damping": 1.0},
                "kappa 0.1": {"contact.penalty.kappa": 0.1},
                "kappa 0.1, damping 1": {"contact.penalty.kappa": 0.1, "contact.penalty.damping": 1.0},
                "kappa 1": {"contact.penalty.kappa": 1.0},
                "kappa 1, damping 0.3": {"contact.penalty.kappa": 1.0, "contact.penalty.damping": 0.3},
                "kappa 1, damping 1": {"contact.penalty.kappa": 1.0, "contact.penalty.damping": 1.0},
                "flip": {"stepping.transfer": "flip"},
                "flip, 1 % pic": {"stepping.transfer": "flip", "stepping.pic_fraction": 0.01},
                "flip, 5 % pic": {"stepping.transfer": "flip", "stepping.pic_fraction": 0.05},
                "flip, 10 % pic": {"stepping.transfer": "flip", "stepping.pic_fraction": 0.1},
                "apic": {"stepping.transfer": "apic"},
                "tpic": {"stepping.transfer": "tpic"},
                "pic": {"stepping.transfer": "pic"},
                "apic, damping 1": {"stepping.transfer": "apic", "contact.penalty.damping": 1.0},
                "segments of 0.5 h": {
                    "bodies.left.segment": "0.5 cells",
                    "bodies.right.segment": "0.5 cells",
                },
            },
            when="full",
        ),
        *methods(
            settings={
                "points of 1 mm": {
                    "bodies.left.particles.size": "0.5 cells",
                    "bodies.right.particles.size": "0.5 cells",
                },
                "points of 1 mm, damping 1": {
                    "bodies.left.particles.size": "0.5 cells",
                    "bodies.right.particles.size": "0.5 cells",
                    "contact.penalty.damping": 1.0,
                },
            },
            when="full",
        ),
        *methods(
            settings={
                "": {},
                "damping 1": {"contact.penalty.damping": 1.0},
                "apic": {"stepping.transfer": "apic"},
            },
            when="quick",
        ),
    ],
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": True,
        "time.output_interval": "5 us",
    },
    quick={"bodies.left.particles.size": "0.5 cells", "bodies.right.particles.size": "0.5 cells"},
    binds=[
        "penalty, cpdi, apic, damping 1",
        "penalty, cpdi, damping 0.1",
        "penalty, cpdi, damping 0.3",
        "penalty, cpdi, damping 1",
        "penalty, cpdi, kappa 0.1, damping 1",
        "penalty, cpdi, kappa 1, damping 0.3",
        "penalty, cpdi, kappa 1, damping 1",
        "penalty, cpdi, points of 1 mm, damping 1",
    ],
)


@scene
def test_scene(run):
    for quantity, key, reference in (
        ("force noise, beside 100 us", "noise", 0.5345),
        ("force noise, beside 25 us", "jitter", 0.2034),
        ("force over 50 us, L2 error", "50", 0.0),
        ("force over 100 us, L2 error", "100", 0.0),
        ("force over 200 us, L2 error", "200", 0.0),
    ):
        run.gate(quantity, run.of(drawn.of_run, key), reference)
    for quantity, key in (
        ("energy lost, of the start", "lost"),
        ("of it in contact dashpots", "damping"),
        ("of it in the transfer", "transfer"),
    ):
        run.gate(quantity, run.of(drawn.of_run, key, scale=100.0), 0.0, None, "%")
    for quantity, key, reference, tolerance, unit in (
        ("rebound velocity", "rebound", 25.03, None, "m/s"),
        ("drift of linear momentum", "momentum", 0.0, (0.0, 1e-12), ""),
        ("(energy + dissipation) / E0, most", "most", 1.0, (0.0, 1.005), ""),
    ):
        run.gate(quantity, run.of(drawn.of_run, key), reference, tolerance, unit)
    if run.method.matches("*damping*"):
        run.gate(
            "least increment of damping work / E0",
            run.of(drawn.of_run, "least_damping"),
            binds=True,
            tolerance=(-1e-12, 1.0),
        )


def test_alone_1(case):
    with case.timed():
        value = drawn.of_elements(run="fine")["noise"]
    case.gate("force noise, beside 100 us", value, 0.5345, method="finite elements, 0.5 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="fine")["jitter"]
    case.gate("force noise, beside 25 us", value, 0.2034, method="finite elements, 0.5 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="fine")["50"]
    case.gate("force over 50 us, L2 error", value, 0.0, method="finite elements, 0.5 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="fine")["100"]
    case.gate("force over 100 us, L2 error", value, 0.0, method="finite elements, 0.5 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="fine")["200"]
    case.gate("force over 200 us, L2 error", value, 0.0, method="finite elements, 0.5 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="coarse")["noise"]
    case.gate("force noise, beside 100 us", value, 0.5345, method="finite elements, 2 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="coarse")["jitter"]
    case.gate("force noise, beside 25 us", value, 0.2034, method="finite elements, 2 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="coarse")["50"]
    case.gate("force over 50 us, L2 error", value, 0.0, method="finite elements, 2 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="coarse")["100"]
    case.gate("force over 100 us, L2 error", value, 0.0, method="finite elements, 2 mm, no damping")
    with case.timed():
        value = drawn.of_elements(run="coarse")["200"]
    case.gate("force over 200 us, L2 error", value, 0.0, method="finite elements, 2 mm, no damping")
