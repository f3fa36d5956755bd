"""Colliding rings, figure 3 of [H17]: von Mises stress."""
# cost: 160

# [H17] figure 3: von Mises stress in the colliding rings, beside finite elements. 95th percentile to 10
# %, mean to 15 % of the fine ones.

import elements
import stresses

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, full, methods, together

rings = Runs(
    "rings",
    scene="colliding-rings",
    methods=[
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            settings={"criterion position": {"contact.bardenhagen.criterion": "position"}},
            when="full",
        ),
        *methods(shape=RECOMMENDED, settings={"kappa 1": {"contact.penalty.kappa": 1.0}}, when="full"),
        *methods(when="quick"),
    ],
    set={"time.output_interval": "0.4 ms", "time.outputs": "exact", "output.energy": False},
)


@rings
def test_rings(run):
    for quantity, key, reference, tolerance in (
        ("von Mises stress, 95th percentile, 0.4 ms", "p95 0.4 ms", 8.024, (7.2216, 8.8264)),
        ("von Mises stress, mean, 0.4 ms", "mean 0.4 ms", 3.2, (2.72, 3.6799999999999997)),
        ("von Mises stress, 95th percentile, 1.6 ms", "p95 1.6 ms", 14.085, (12.6765, 15.493500000000003)),
        ("von Mises stress, mean, 1.6 ms", "mean 1.6 ms", 6.229, (5.29465, 7.163349999999999)),
        ("von Mises stress, 95th percentile, 3.2 ms", "p95 3.2 ms", 3.822, (3.4398, 4.2042)),
        ("von Mises stress, mean, 3.2 ms", "mean 3.2 ms", 1.855, (1.5767499999999999, 2.13325)),
    ):
        run.gate(quantity, run.of(stresses.of_run, key, scale=1e-06), reference, tolerance, "MPa")
    run.gate("outline, largest distance", run.of(stresses.outline_distance), unit="mm")


def test_alone_1(case):
    with case.timed():
        value = 1e-06 * elements.stresses()["p95 0.4 ms"]
    case.gate(
        "von Mises stress, 95th percentile, 0.4 ms",
        value,
        8.024,
        (7.2216, 8.8264),
        "MPa",
        method="finite elements, 4-node, 2 mm",
        binds=False,
    )
    with case.timed():
        value = 1e-06 * elements.stresses()["mean 0.4 ms"]
    case.gate(
        "von Mises stress, mean, 0.4 ms",
        value,
        3.2,
        (2.72, 3.6799999999999997),
        "MPa",
        method="finite elements, 4-node, 2 mm",
        binds=False,
    )
    with case.timed():
        value = 1e-06 * elements.stresses()["p95 1.6 ms"]
    case.gate(
        "von Mises stress, 95th percentile, 1.6 ms",
        value,
        14.085,
        (12.6765, 15.493500000000003),
        "MPa",
        method="finite elements, 4-node, 2 mm",
        binds=False,
    )
    with case.timed():
        value = 1e-06 * elements.stresses()["mean 1.6 ms"]
    case.gate(
        "von Mises stress, mean, 1.6 ms",
        value,
        6.229,
        (5.29465, 7.163349999999999),
        "MPa",
        method="finite elements, 4-node, 2 mm",
        binds=False,
    )
    with case.timed():
        value = 1e-06 * elements.stresses()["p95 3.2 ms"]
    case.gate(
        "von Mises stress, 95th percentile, 3.2 ms",
        value,
        3.822,
        (3.4398, 4.2042),
        "MPa",
        method="finite elements, 4-node, 2 mm",
        binds=False,
    )
    with case.timed():
        value = 1e-06 * elements.stresses()["mean 3.2 ms"]
    case.gate(
        "von Mises stress, mean, 3.2 ms",
        value,
        1.855,
        (1.5767499999999999, 2.13325),
        "MPa",
        method="finite elements, 4-node, 2 mm",
        binds=False,
    )


@together(rings)
def test_figure(case, runs):
    case.figure("", elements.beside(runs))


@full
@together(rings)
def test_figure_methods(case, runs):
    case.figure("methods", elements.over_time(runs))
