"""Impact of two equal bars: pressure, duration and velocities, for every method.

A coarse cell is thicker than the bars, which then are one cell of their own thick.
"""
# cost: 60

import pulse
from classical import POSITION, specified

from mpmfw.validation import CLASSICAL, RECOMMENDED, SHAPES, Runs, methods, together

ALONG = specified(1.0, 0.0)
COARSE = {
    "grid.cell_size": 0.5,
    "bodies.left.geometry.lower": [-9.95, 0.0],
    "bodies.left.geometry.upper": [0.05, 0.5],
    "bodies.right.geometry.lower": [0.11, 0.0],
    "bodies.right.geometry.upper": [10.11, 0.5],
}
GIVEN = {"": {}, "normal specified": ALONG, "position, normal specified": {**POSITION, **ALONG}}
CELLS = {"L/h = 20": COARSE, "L/h = 40": {"grid.cell_size": 0.25}}

bars = Runs(
    "bars",
    methods=[
        *methods(["none", CLASSICAL[1], "penalty"], SHAPES, when="full"),
        *methods(["bardenhagen"], SHAPES, GIVEN, when="full"),
        *methods(["separate"], when="full"),
        *methods(["penalty", "bardenhagen"], settings=CELLS, when="full"),
        *methods(shape=RECOMMENDED, when="quick"),
    ],
    set={"output.particles": False, "output.surface": False, "output.gap": False},
)


@bars
def test_bars(run):
    for quantity, key, scale, tolerance, unit in (
        ("plateau, error", "plateau", 100.0, 3.0, "%"),
        ("contact duration, error", "duration", 100.0, 5.0, "%"),
        ("gap where contact begins", "early", 1.0, None, "h"),
        ("plateau, rms ripple", "ripple", 1.0, None, "%"),
    ):
        run.gate(quantity, run.of(pulse.against_closed_form, key, scale), 0.0, tolerance, unit)
    run.gate("velocity after it, error", run.of(pulse.rebound, scale=100.0), 0.0, 2.0, "%")


@together(bars)
def test_figure(case, runs):
    case.figure("", pulse.draw(runs))
