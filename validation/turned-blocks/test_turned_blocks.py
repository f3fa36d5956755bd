"""Blocks turned against the grid: a contact patch test in space, of blocks turned by (20, 35, 50) degrees.

Triangles and points of the upper block do not match those of the lower one in the last runs. At this
stiffness the usual residual force shows.
"""
# cost: 500

import normals
from classical import specified

from mpmfw.validation import Place, Runs, methods

SETTINGS = {"": {}, "normal given": specified(0.60845586, 0.193040571, 0.769751131)}
STIFF = {
    "": {},
    "kappa 16": {"contact.penalty.kappa": 16.0},
    "kappa 100": {"contact.penalty.kappa": 100.0, "settle.tolerance": 0.0002},
}
FOUR, EIGHT = {"grid.cell_size": 0.25}, {"grid.cell_size": 0.125}

two = Runs(
    "two",
    methods=[
        *methods(),
        *methods(["bardenhagen"], settings=SETTINGS, when="full"),
        *methods(["none"], when="full"),
    ],
    places=[Place("4 cells", FOUR), Place("8 cells", EIGHT, when="full")],
    set={"output.surface": False},
)
three = Runs(
    "three", "three.toml", methods(["penalty", "bardenhagen"]), set={"output.surface": False}, when="full"
)
other_triangles = Runs(
    "other triangles",
    methods=methods(settings=STIFF),
    places=[Place("4 cells", FOUR), Place("8 cells", EIGHT)],
    set={
        "output.surface": False,
        "bodies.upper.particles.size": "0.4 cells",
        "bodies.upper.segment": "0.4 cells",
    },
    binds=["penalty, *"],
    when="full",
)


def judge(run, blocks, *gates):
    """Record departures of the stress from the closed form."""
    for quantity, key, tolerance, bound in gates:
        value = run.of(normals.stress, key)
        run.gate(f"{blocks}: {quantity}", value, 0.0, tolerance, "%", binds=run.method.matches(bound))


MEAN = ("mean stress beside the interface, error", "mean", 1.0, "penalty, *")
BESIDE = ("largest departure beside the interface", "beside", (0.0, 1.0), "penalty, *")
LARGEST = ("largest departure of all points", "largest", (0.0, 1.0), "penalty, *")


@two
def test_two(run):
    judge(run, f"two blocks, {run.place.at}", MEAN, BESIDE, LARGEST)


@three
def test_three(run):
    mean = ("mean stress beside the interfaces, error", *MEAN[1:])
    judge(run, "three blocks, 4 cells", mean, LARGEST)


@other_triangles
def test_other_triangles(run):
    square = ("root of the mean square of all points", "l2", None, "penalty, *")
    judge(run, f"other triangles, {run.place.at}", MEAN, (*BESIDE[:3], "penalty, cpdi, kappa 100"), square)
