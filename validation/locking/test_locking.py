"""Locking: discs that meet and a roller between plates, of a material that nearly keeps its volume."""
# cost: 40

import numpy as np
from common import disc, elastic, rectangle, scene
from scipy.optimize import brentq

from mpmfw.validation import Place, Runs, methods

YOUNG, RADIUS, POISSON = 1e6, 0.5, 0.499
#: Half of the discs' impulse at this time [s], and their largest force [N/m]: limits of smaller cells with ν
#: from 0.49 to 0.499.
TIME, FORCE = 0.0445, 24600.0
RUBBER = elastic(1e3, YOUNG, POISSON, "neo_hookean")


def two_discs(volumetric):
    """Return two discs of 8 cells in the radius that meet head-on at 1 m/s each, off the grid lines."""
    more = {"particles": {"size": "0.5 cells", "layout": "fitted"}, "volumetric": volumetric}
    bodies = {
        name: disc(side * 0.5005 + 0.0137, 0.0071, RADIUS, velocity=[-side, 0.0], **more)
        for name, side in (("left", -1.0), ("right", 1.0))
    }
    tables = {"time": {"outputs": "nearest"}, "contact": {"method": "lcp"}}
    output = {"ledger": True, "particles": False, "surface": False}
    box = [-1.6, -0.9], [1.6, 0.9]
    return scene(RADIUS / 8, *box, 0.11, 0.0005, RUBBER, bodies, **tables, output=output)


def impact(tree):
    """Return errors of the ``time`` at which half of the impulse has passed and of the largest ``force``, a
    mean over 4.5 ms [%]."""
    series = tree["series"].to_dataset()
    time, force = series["time"].values, -series["contact_force"].values[:, 0, 0]
    passed = np.cumsum(force * np.gradient(time))
    return {
        "time": 100.0 * float(np.interp(0.5, passed / passed[-1], time) / TIME - 1.0),
        "force": 100.0 * float(np.convolve(force, np.ones(9) / 9.0, "same").max() / FORCE - 1.0),
    }


def roller(volumetric):
    """Return a roller of ten cells to the radius between two hard plates that close at 0.1 m/s."""

    def plate(side, low, high, speed):
        moved = {"sides": [{"side": side, "velocity": [0.0, speed]}], "velocity": [0.0, speed]}
        return rectangle(-0.4, low, 0.4, high, material="hard", particles={"size": 0.025}, **moved)

    more = {"particles": {"size": 0.025, "layout": "fitted"}, "volumetric": volumetric}
    bodies = {
        "roller": disc(0.0, 0.0, RADIUS, **more),
        "low": plate("bottom", -0.65, -0.5, 0.05),
        "high": plate("top", 0.5, 0.65, -0.05),
    }
    hard = {"hard": elastic(5e4, 5e7, 0.3, "neo_hookean")}
    box, output = ([-0.9, -0.8], [0.9, 0.8]), {"particles": False}
    return scene(0.05, *box, 0.4, 0.002, RUBBER, bodies, materials=hard, output=output)


def closing(force, modulus):
    """Return how far both plates close on the roller under a ``force`` a length [m] (Johnson, eq. 5.57)."""
    half_width = np.sqrt(4.0 * force * RADIUS / (np.pi * modulus))
    return 2.0 * force / (np.pi * modulus) * (2.0 * np.log(4.0 * RADIUS / half_width) - 1.0)


def force(tree):
    """Return the error of the force while the plates close by 2 to 4 %, by least squares [%]."""
    series = tree["series"]["contact_force"].sel(axis="y")
    series = 0.5 * (series.sel(pair="roller-low") - series.sel(pair="roller-high"))
    late, modulus = series.where(series["time"] > 0.2, drop=True), YOUNG / (1.0 - POISSON**2)
    ways = 0.1 * late["time"].values
    exact = np.array(
        [brentq(lambda each, way=way: closing(each, modulus) - way, 1e-3, YOUNG) for way in ways]
    )
    return 100.0 * float(late.values @ exact / (exact @ exact) - 1.0)


def places(at):
    """Return a place for the default, whose gates bind, and one for the change of volume at every point."""
    return [Place(f"{at}, {how}", make={"volumetric": how}) for how in ("auto", "pointwise")]


@Runs("discs", two_discs, methods(["lcp"]), places("ν = 0.499, R/h = 8"))
def test_discs(run):
    run.gates(
        impact,
        ("time of half the impulse, error, {at}", "time", 0.0, 2.0, "%"),
        ("largest force, error, {at}", "force", 0.0, 2.0, "%"),
        binds=run.place.make["volumetric"] == "auto",
    )


@Runs("rollers", roller, places=places("ν = 0.499, R/h = 10"), when="full")
def test_rollers(run):
    binds = run.place.make["volumetric"] == "auto"
    run.gate(f"force of the roller, error, {run.place.at}", run.of(force), 0.0, 5.0, "%", binds=binds)
