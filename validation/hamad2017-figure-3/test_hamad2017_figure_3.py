"""Colliding rings, figure 3 of [H17]: von Mises stress beside that of fine finite elements."""
# cost: 160

import drawing
import stresses
from classical import POSITION

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods, together

rings = Runs(
    "rings",
    scene="colliding-rings",
    methods=[
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], settings={"criterion position": POSITION}, when="full"),
        *methods(shape=RECOMMENDED, settings={"kappa 1": {"contact.penalty.kappa": 1.0}}, when="full"),
        *methods(when="quick"),
    ],
    set={"time.output_interval": "0.4 ms", "time.outputs": "exact", "output.energy": False},
)


#: Quantity, key of the measures, the fine elements' value in MPa, and the share of it that gates allow.
STRESSES = (
    ("von Mises stress, 95th percentile, 0.4 ms", "p95 0.4 ms", 8.024, 0.10),
    ("von Mises stress, mean, 0.4 ms", "mean 0.4 ms", 3.2, 0.15),
    ("von Mises stress, 95th percentile, 1.6 ms", "p95 1.6 ms", 14.085, 0.10),
    ("von Mises stress, mean, 1.6 ms", "mean 1.6 ms", 6.229, 0.15),
    ("von Mises stress, 95th percentile, 3.2 ms", "p95 3.2 ms", 3.822, 0.10),
    ("von Mises stress, mean, 3.2 ms", "mean 3.2 ms", 1.855, 0.15),
)


def around(reference, share):
    """Return the limits of a gate: the reference less and plus a share of it."""
    return reference * (1 - share), reference * (1 + share)


@rings
def test_rings(run):
    for quantity, key, reference, share in STRESSES:
        value = run.of(stresses.of_run, key, scale=1e-06)
        run.gate(quantity, value, reference, around(reference, share), "MPa")
    run.gate("outline, largest distance", run.of(stresses.outline_distance), unit="mm")


def test_elements(case):
    for quantity, key, reference, share in STRESSES:
        with case.timed():
            value = 1e-06 * drawing.stresses()[key]
        method = "finite elements, 4-node, 2 mm"
        case.gate(quantity, value, reference, around(reference, share), "MPa", method, binds=False)


@together(rings)
def test_figure(case, runs):
    case.figure("", drawing.beside_finite_elements(runs))
