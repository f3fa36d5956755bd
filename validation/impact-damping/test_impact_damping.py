"""Damping the oscillations of an impact's contact force.

Nothing but sanity is gated, of the scene as it is shipped and of the sign of damping. References are of the
fine finite elements. The answer again with a quarter of the material points.
"""
# cost: 190

import noise
from classical import over

from mpmfw.validation import Runs, methods

HALF_CELLS = {"bodies.left.particles.size": "0.5 cells", "bodies.right.particles.size": "0.5 cells"}
DAMPED = {"contact.penalty.damping": 1.0}


def flip(share):
    """Return FLIP with a share of PIC."""
    return {"stepping.transfer": "flip", "stepping.pic_fraction": share}


springs = Runs(
    "springs",
    "colliding-rings",
    [
        *methods(
            settings={
                "": {},
                **over("contact.penalty.damping", "damping {:g}", (0.1, 0.3, 1.0)),
                "kappa 0.1": {"contact.penalty.kappa": 0.1},
                "kappa 0.1, damping 1": {"contact.penalty.kappa": 0.1, **DAMPED},
                "kappa 1": {"contact.penalty.kappa": 1.0},
                "kappa 1, damping 0.3": {"contact.penalty.kappa": 1.0, "contact.penalty.damping": 0.3},
                "kappa 1, damping 1": {"contact.penalty.kappa": 1.0, **DAMPED},
                **over("stepping.transfer", "{}", ("flip", "apic", "tpic", "pic")),
                **{f"flip, {100 * share:g} % pic": flip(share) for share in (0.01, 0.05, 0.1)},
                "apic, damping 1": {"stepping.transfer": "apic", **DAMPED},
                "segments of 0.5 h": {f"bodies.{ring}.segment": "0.5 cells" for ring in ("left", "right")},
                "points of 1 mm": HALF_CELLS,
                "points of 1 mm, damping 1": {**HALF_CELLS, **DAMPED},
            },
            when="full",
        ),
        *methods(settings={"": {}, "damping 1": DAMPED}, when="quick"),
    ],
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": True,
        "time.output_interval": "5 us",
    },
    quick=HALF_CELLS,
    binds=["*damping*"],
)
NOISE = (
    ("force noise, beside 100 us", "noise", 0.5345),
    ("force noise, beside 25 us", "jitter", 0.2034),
    ("force over 50 us, L2 error", "50", 0.0),
    ("force over 100 us, L2 error", "100", 0.0),
    ("force over 200 us, L2 error", "200", 0.0),
)


@springs
def test_springs(run):
    run.gates(noise.of_run, *NOISE)
    run.gates(
        noise.of_run,
        ("energy lost, of the start", "lost", 0.0, None, "%"),
        ("of it in contact dashpots", "damping", 0.0, None, "%"),
        ("of it in the transfer", "transfer", 0.0, None, "%"),
        scale=100.0,
    )
    run.gates(
        noise.of_run,
        ("rebound velocity", "rebound", 25.03, None, "m/s"),
        ("drift of linear momentum", "momentum", 0.0, (0.0, 1e-12)),
        ("(energy + dissipation) / E0, most", "most", 1.0, (0.0, 1.005)),
    )
    if run.method.matches("*damping*"):
        least = run.of(noise.of_run, "least_damping")
        run.gate("least increment of damping work / E0", least, tolerance=(-1e-12, 1.0), binds=True)


def test_elements(case):
    for size, name in (("0.5 mm", "fine"), ("2 mm", "coarse")):
        for quantity, key, reference in NOISE:
            with case.timed():
                value = noise.of_elements(run=name)[key]
            case.gate(quantity, value, reference, method=f"finite elements, {size}, no damping")
