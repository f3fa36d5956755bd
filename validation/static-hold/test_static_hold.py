"""Static hold: a block that friction must hold (tan θ ≤ μ), with every contact and every shape function.

Linear functions take MUSL by themselves, see the README. The drift's limit is a tenth of the
displacement's, which a block creeping at this rate would reach in ten seconds. What is left after settling
is an oscillation, whose fit is far smaller. In space, friction is not along a grid line; nodes with next to
no mass, beyond the faces, take 10⁴ steps and more to balance.
"""
# cost: 150

import numpy as np
from common import LITERAL, MASTER, POSITION

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Place, Runs, methods

HEIGHT = 0.3  # of the block [m]


def displacement(run):
    """Of the block's centre at the end, over its height."""
    return float(np.hypot(*_moved(run["series"].to_dataset())[-1])) / HEIGHT


def way(run):
    """Return the largest distance of the block's centre from where it began, in cells."""
    return float(np.linalg.norm(_moved(run["series"]), axis=1).max()) / float(run.attrs["cell_size"])


def drift(run):
    """Slope of the line fitted to the way along the plane in the last second, over the height [1/s]."""
    series = run["series"].to_dataset()
    time = series["time"].values
    last = time >= time[-1] - 1.0
    return float(np.polyfit(time[last], _moved(series)[last, 0], 1)[0]) / HEIGHT


def _moved(series):
    """Return the displacement of the block's centre, (time, axis) [m]."""
    centre = series["centre_of_mass"].sel(body="block").values
    return centre - centre[0]


ON_LINES = {
    "bodies.block.geometry.lower": [0.5, 0.537, 0.5],
    "bodies.block.geometry.upper": [1.25, 0.912, 1.25],
    "bodies.plane.geometry.lower": [0.0, 0.0, 0.0],
    "bodies.plane.geometry.upper": [2.0, 0.537, 2.0],
}
USL = {"USL": {"stepping.scheme": "usl"}}
FORMS = {"criterion position": POSITION, "normal master": MASTER}

block = Runs(
    "block",
    methods=[
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], SHAPES, FORMS, when="full"),
        *methods(["hamad2017"], settings={"": {}, "literal": LITERAL}, when="full"),
        *methods(["bardenhagen", "penalty"], ["linear"], USL, when="full"),
    ],
    set={"output.particles": False},
)
in_space = Runs(
    "in space",
    "in-space.toml",
    methods(["penalty", "bardenhagen"]),
    [
        Place("off the grid lines"),
        Place("faces on grid lines", ON_LINES, open={"way": "nodes beyond the faces have next to no mass"}),
    ],
    when="full",
)


@block
def test_block(run):
    run.gate("displacement after 2 s / height", run.of(displacement), 0.0, (0.0, 1e-3))
    run.gate("fitted drift in the last second / height", run.of(drift), 0.0, 1e-4)


@in_space
def test_in_space(run):
    run.gate(f"in space, {run.place.at}: way in 10⁴ steps", run.of(way), 0.0, (0.0, 1e-6), "h", key="way")
