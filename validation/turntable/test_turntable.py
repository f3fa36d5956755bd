"""Turntable: a block on a turning plate stays up to a speed, and slides outwards beyond."""
# cost: 450

import radius

from mpmfw.validation import CLASSICAL, Place, Runs, methods

SHIFTED = {"grid.lower": [-1.569, -0.583, -1.577], "grid.upper": [1.631, 1.017, 1.623]}
FASTER = {
    "bodies.plate.angular_velocity": [0.0, 3.5, 0.0],
    "bodies.block.angular_velocity": [0.0, 3.5, 0.0],
    "bodies.block.velocity": [0.0, 0.0, -2.1],
}
COARSE = {"grid.cell_size": 0.15, "grid.lower": [-1.65, -0.6, -1.65], "grid.upper": [1.65, 1.05, 1.65]}


def at_speed(name, values, **quick):
    """Return the runs at one speed, with the grid as it stands and shifted."""
    return Runs(
        name,
        methods=[*methods(), *methods([*CLASSICAL, "lcp"], when="full")],
        places=[Place("as it stands"), Place("shifted", SHIFTED, when="full")],
        set=values,
        quick=COARSE | quick,
    )


stays, slides = at_speed("stays", {}, **{"time.end": 0.2}), at_speed("slides", FASTER)


def turning(run, speed):
    """Record the plate's loss of speed."""
    change = run.of(radius.judge, "turning")
    run.gate(f"{speed}, {run.place.at}: turning of the plate, change", change, 0.0, unit="%")


@stays
def test_stays(run):
    run.gate(f"stays, {run.place.at}: creep", run.of(radius.judge, "creep"), 0.0, 1.0, "mm/s")
    turning(run, "stays")


@slides
def test_slides(run):
    run.gate(f"slides, {run.place.at}: way outwards, error", run.of(radius.judge, "way"), 0.0, 1.5, "%")
    turning(run, "slides")
