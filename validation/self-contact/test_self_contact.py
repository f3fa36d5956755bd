"""Self-contact: two arms of one body that are pressed together bear what the arms of two bodies bear."""
# cost: 60

import arms

from mpmfw.validation import Place, Runs, each, methods

pressed = Runs(
    "pressed",
    scene=arms.arms,
    methods=[
        *methods(["penalty", "lcp"], bound=True),
        *methods(shape=["gimp", "bspline"], bound=True, when="full"),
    ],
    places=[Place("arm/h = 4", make={"cells": 4})],
    by=arms.compare,
)
fine = Runs(
    "fine", scene=arms.arms, places=[Place("arm/h = 8", make={"cells": 8}, when="full")], by=arms.compare
)


@each(pressed, fine)
def test_pressed(run):
    at = run.place.at
    run.gate(f"contact force, {at}", run.of(lambda found: found, "force"), 0.0, 2.0, "%", key="force")
    run.gate(f"gap, mean difference, {at}", run.of(lambda found: found, "gap"), 0.0, 0.02, "cells", key="gap")
    run.gate(
        f"force before they touch, {at}", run.of(lambda found: found, "early"), 0.0, 0.5, "%", key="early"
    )
