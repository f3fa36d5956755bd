"""Blocks turned against the grid: a contact patch test in space, of blocks turned by (20, 35, 50) degrees.

Triangles and points of the upper block do not match those of the lower one in the last runs. At this
stiffness the usual residual force shows.
"""
# cost: 500

import numpy as np
from common import specified

from mpmfw.geometry.solid import turning
from mpmfw.validation import Place, Runs, methods

PRESSURE = 2e3  #: on both ends [Pa]
AXIS = turning(tuple(np.radians([20.0, 35.0, 50.0])))[:, 2]  #: of the stack, n


def stress(run):
    """Return −n·σ·n over the pressure, less one [%], at the points of all blocks: ``largest`` magnitude, and
    ``mean`` by volume and largest ``beside`` an interface, within a cell of it."""
    bodies = list(run["particles"].children)
    ratio, along, volume, ends = [], [], [], []
    for name in bodies:
        points = run["particles"][name].to_dataset().isel(time=-1)
        ratio.append(np.einsum("a,nab,b->n", AXIS, points["stress"].values, AXIS) / -PRESSURE)
        along.append(points["position"].values @ AXIS)
        volume.append(run["particles"][name].to_dataset().isel(time=0)["volume"].values)
        ends.append(along[-1].mean() + 0.5)
    interfaces, error = np.array(ends[:-1]), 100.0 * (np.concatenate(ratio) - 1.0)
    weights, h = np.concatenate(volume), float(run.attrs["cell_size"])
    near = np.abs(np.concatenate(along)[:, None] - interfaces).min(axis=1) < h
    return {
        "mean": float(np.average(error[near], weights=weights[near])),
        "beside": float(np.abs(error[near]).max()),
        "largest": float(np.abs(error).max()),
    }


SETTINGS = {"": {}, "normal given": specified(0.60845586, 0.193040571, 0.769751131)}
STIFF = {
    "": {},
    "kappa 16": {"contact.penalty.kappa": 16.0},
    "kappa 100": {"contact.penalty.kappa": 100.0, "settle.tolerance": 0.0002},
}
FOUR, EIGHT = {"grid.cell_size": 0.25}, {"grid.cell_size": 0.125}
PLACES = [Place("4 cells", FOUR), Place("8 cells", EIGHT, when="full")]

two = Runs(
    "two",
    methods=[
        *methods(),
        *methods(["bardenhagen"], settings=SETTINGS, when="full"),
        *methods(["none"], when="full"),
    ],
    places=PLACES,
    set={"output.surface": False},
)
three = Runs(
    "three", "three.toml", methods(["penalty", "bardenhagen"]), set={"output.surface": False}, when="full"
)
other_triangles = Runs(
    "other triangles",
    methods=methods(settings=STIFF),
    places=PLACES,
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
        value = run.of(stress, key)
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
    judge(run, f"other triangles, {run.place.at}", MEAN, (*BESIDE[:3], "penalty, cpdi, kappa 100"))
