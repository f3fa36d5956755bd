"""A column of sand that collapses: its run-out against experiments."""
# cost: 90

import collapse

from mpmfw.validation import CLASSICAL, Place, Runs, methods

#: Angle of friction whose shear on a plane, arctan sin φ with ψ = 0, is an angle of repose of 31°.
FITTED = 36.9


def places(*rows, angle=FITTED):
    """Return places of an aspect, cells in the width, and when."""
    return [
        Place(
            f"a = {aspect}, W/h = {cells}, φ = {angle}°",
            make={"aspect": aspect, "cells": cells, "angle": angle},
            when=when,
        )
        for aspect, cells, when in rows
    ]


gated = Runs(
    "column",
    scene=collapse.scene,
    methods=methods([CLASSICAL[1]], ["gimp"], bound=True),
    places=places((1.2, 10, ""), (1.2, 20, "full"), (3.0, 10, "full"), (3.0, 20, "full")),
)
shown = Runs(
    "others",
    scene=collapse.scene,
    methods=methods([CLASSICAL[1]], ["gimp"]),
    places=[
        *places((0.5, 10, "full"), (0.5, 20, "full"), (1.2, 40, "full")),
        *places((1.2, 10, "full"), (1.2, 20, "full"), angle=31.0),
    ],
)


@gated
def test_column(run):
    judge(run, binds=True)


@shown
def test_others(run):
    judge(run, binds=False)


def judge(run, binds):
    """Record the run-out, the height and the volume at the end."""
    run.gates(
        collapse.deposit,
        ("run-out at the toe, error, {at}", "toe", 0.0, 10.0, "%"),
        ("gain of volume, {at}", "volume", 0.0, 6.5, "%"),
        aspect=run.place.make["aspect"],
        binds=binds,
    )
    run.gates(
        collapse.deposit,
        ("run-out of 99 %, error, {at}", "most", 0.0, None, "%"),
        ("height at the wall over the width, {at}", "height", 0.0, None),
        aspect=run.place.make["aspect"],
        binds=False,
    )
