"""A smooth wall that holds soil, gives way to it, or pushes it: the pressures of Rankine and
Coulomb."""
# cost: 40

import pushed

from mpmfw.validation import Place, Runs, methods

wall = Runs(
    "wall",
    scene=pushed.scene,
    methods=[*methods([""]), *methods([""], ["gimp", "bspline"], when="full")],
    places=[
        *(Place(f"{state}, H/h = 8", make={"state": state, "cells": 8}) for state in pushed.RATIOS),
        *(
            Place(f"{state}, H/h = 16", make={"state": state, "cells": 16}, when="full")
            for state in ("active", "passive")
        ),
    ],
)
cone = Runs(
    "cone",
    scene=pushed.scene,
    methods=methods([""]),
    places=[
        Place(f"{state}, Drucker-Prager", make={"state": state, "cells": 8, "model": "drucker_prager"})
        for state in ("active", "passive")
    ],
    when="full",
)


rough = Runs(
    "rough",
    scene=pushed.rough,
    methods=methods(),
    places=[
        Place("δ = 20°, H/h = 16", make={"cells": 16, "angle": 20.0}),
        Place("δ = 10°, H/h = 16", make={"cells": 16, "angle": 10.0}, when="full"),
        Place(
            "δ = 20°, H/h = 16, pointwise",
            make={"cells": 16, "angle": 20.0, "volumetric": "pointwise"},
            open={"force": "each point keeps its volume, and the soil locks"},
            when="full",
        ),
    ],
)


@rough
def test_rough(run):
    measure, angle = pushed.coulomb, run.place.make["angle"]
    run.gate(
        f"force on the rough wall against Coulomb, error, {run.place.at}",
        run.of(measure, "force", angle=angle),
        0.0,
        5.0,
        "%",
        key="force",
    )
    run.gate(
        f"friction over pressure against tan δ, error, {run.place.at}",
        run.of(measure, "friction", angle=angle),
        0.0,
        1.0,
        "%",
    )


@wall
def test_wall(run):
    state = run.place.make["state"]
    error, change = (0.1, 0.1) if state == "at rest" else (3.0, 10.0)
    run.gates(
        pushed.pressure,
        ("force on the wall, error, {at}", "force", 0.0, error, "%"),
        ("change of the force over the last third, {at}", "varies", 0.0, change, "%"),
        binds=run.method.matches("cpdi"),
        state=state,
    )


@cone
def test_cone(run):
    run.gates(
        pushed.pressure, ("force on the wall, error, {at}", "force", 0.0), state=run.place.make["state"]
    )
