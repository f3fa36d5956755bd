"""Impacts of spheres."""
# cost: 700

# Impacts of spheres in space: thrown obliquely, turned about a line in the plane of contact, and
# straight. Two that turn against each other, as gears do: their points of contact move alike, and
# friction has nothing to do.

import bounce
import drawn
import elastic
import spheres

from mpmfw.validation import CLASSICAL, Place, Runs, known_red, methods, together

oblique = Runs(
    "oblique",
    scene=spheres.scene,
    methods=[*methods(), *methods(CLASSICAL, when="full")],
    places=[
        *(
            Place(f"5, steel, {angle}°, R/h = 6", make={"test": "5 steel", "angle": angle, "cells": 6})
            for angle in (17, 45, 70)
        ),
        *(
            Place(
                f"5, steel, {angle}°, R/h = 10",
                make={"test": "5 steel", "angle": angle, "cells": 10},
                within={"along": (-2.5, 2.5), "spin": (-2.0, 2.0), "spin, rigid": (-2.0, 2.0)},
                when="full",
            )
            for angle in (17, 45, 70)
        ),
        *(
            Place(
                f"4, oxide, {angle}°, R/h = 6",
                make={"test": "4 oxide", "angle": angle, "cells": 6},
                when="full",
            )
            for angle in (10, 50)
        ),
        Place(
            "6, nylon, ω R / v_n = 1.5, R/h = 6", make={"test": "6 nylon", "spin": 3, "pace": 8, "cells": 6}
        ),
        *(
            Place(
                f"6, nylon, ω R / v_n = 0.5, R/h = {cells}",
                make={"test": "6 nylon", "spin": 1, "pace": 8, "cells": cells},
                open={"spin": "within 5 % or not as the cell size has it"},
                when="full",
            )
            for cells in (6, 10)
        ),
        Place(
            "6, nylon, ω R / v_n = 4.5, R/h = 6",
            make={"test": "6 nylon", "spin": 9, "pace": 8, "cells": 6},
            when="full",
        ),
        Place(
            "6, nylon, ω R / v_n = 1.5, R/h = 10",
            make={"test": "6 nylon", "spin": 3, "pace": 8, "cells": 10},
            within={"along": (-2.5, 2.5), "spin": (-2.0, 2.0)},
            when="full",
        ),
        Place(
            "6, nylon, ω R / v_n = 4.5, R/h = 10",
            make={"test": "6 nylon", "spin": 9, "pace": 8, "cells": 10},
            within={"spin, rigid": (-2.0, 2.0)},
            when="full",
        ),
        Place(
            "6, nylon at their speed, ω R / v_n = 1.5, R/h = 6",
            make={"test": "6 nylon", "spin": 3, "cells": 6},
            open={
                "along": "the circle of contact is 0.2 cells",
                "spin": "the circle of contact is 0.2 cells",
            },
            when="full",
        ),
        Place(
            "6, aluminium, ω R / v_n = 1.5, R/h = 6",
            make={"test": "6 aluminium", "spin": 3, "pace": 25, "cells": 6},
            when="full",
        ),
        Place(
            "7, two of copper, ω R / v_n = 1.5, R/h = 6",
            make={"test": "7 copper", "spin": 3, "pace": 18, "partner": "twin", "cells": 6},
            when="full",
        ),
        Place(
            "7, two of copper, ω R / v_n = 1.5, R/h = 10",
            make={"test": "7 copper", "spin": 3, "pace": 18, "partner": "twin", "cells": 10},
            within={"along": (-2.5, 2.5), "spin": (-2.0, 2.0)},
            when="full",
        ),
        Place(
            "8, nylon on a larger sphere, ω R / v_n = 1.5, R/h = 6",
            make={"test": "6 nylon", "spin": 3, "pace": 8, "partner": "cap", "cells": 6},
            when="full",
        ),
    ],
)


@known_red(
    "penalty, cpdi",
    "5, steel, 17°, R/h = 6: change of v_t against the elastic sphere",
    "11 % with the default kappa = 4; 3.5 % when the default was 1, with which the cell size was chosen",
)
@known_red(
    "penalty, cpdi",
    "5, steel, 17°, R/h = 6: change of ω R against the elastic sphere",
    "9.8 % with the default kappa = 4; 1.0 % when the default was 1, with which the cell size was chosen",
)
@oblique
def test_oblique(run):
    at = run.place.at
    if run.at("5*17°*", "5*45°*", "4*10°*", "6*0.5,*", "6*1.5,*", "7*", "8*"):
        run.gate(
            f"{at}: change of v_t against the elastic sphere",
            run.of(bounce.errors, "along"),
            0.0,
            5.0,
            "%",
            key="along",
        )
        run.gate(
            f"{at}: change of ω R against the elastic sphere",
            run.of(bounce.errors, "spin"),
            0.0,
            5.0,
            "%",
            key="spin",
        )
    if run.at("5*70°*", "4*50°*", "6*4.5*"):
        run.gate(
            f"{at}: change of v_t against the rigid sphere that slides",
            run.of(bounce.errors, "along, rigid"),
            0.0,
            1.0,
            "%",
        )
        run.gate(
            f"{at}: change of ω R against the rigid sphere that slides",
            run.of(bounce.errors, "spin, rigid"),
            0.0,
            2.5,
            "%",
            key="spin, rigid",
        )
    if run.at("5*17°*", "5*45°*", "4*10°*", "6*0.5,*", "6*1.5,*", "7*", "8*"):
        run.gate(
            f"{at}: velocity of the point of contact over what it had, less the elastic sphere's",
            run.of(bounce.errors, "contact"),
            0.0,
            unit="%",
        )
    run.gate(f"{at}: coefficient of restitution", run.of(bounce.impact, "restitution"), 1.0)


alike = Runs(
    "alike",
    scene=spheres.scene,
    methods=[*methods(), *methods(CLASSICAL, when="full")],
    places=[
        Place(
            "7, two of copper that turn as gears do, R/h = 6",
            make={"test": "7 copper", "spin": 3, "pace": 18, "partner": "twin", "sense": -1, "cells": 6},
        )
    ],
)


@alike
def test_alike(run):
    at = run.place.at
    run.gate(f"{at}: change of v_t over ω R", run.of(bounce.impact, "along", scale=100.0), 0.0, 1.0, "%")
    run.gate(f"{at}: change of ω R over ω R", run.of(bounce.impact, "spin", scale=100.0), 0.0, 1.0, "%")


straight = Runs(
    "straight",
    scene=spheres.scene,
    methods=[*methods(settings={"": {}, "kappa 8": {"contact.penalty.kappa": 8.0}}), *methods(CLASSICAL)],
    places=[
        Place("1, two of glass, R/h = 6", make={"test": "1 glass", "partner": "twin", "cells": 6}),
        Place(
            "1, two of glass, R/h = 10",
            make={"test": "1 glass", "partner": "twin", "cells": 10},
            within={"force": (-5.0, 5.0), "time": (-5.0, 5.0)},
        ),
        Place("1, two of limestone, R/h = 6", make={"test": "1 limestone", "partner": "twin", "cells": 6}),
        Place("2, aluminium, R/h = 6", make={"test": "2 aluminium", "pace": 25, "cells": 6}),
        Place(
            "2, aluminium, R/h = 10",
            make={"test": "2 aluminium", "pace": 25, "cells": 10},
            within={"force": (-5.0, 5.0), "time": (-5.0, 5.0)},
            open={"force": "seven per cent too low, with finer surfaces as well"},
        ),
        Place("2, magnesium, R/h = 6", make={"test": "2 magnesium", "pace": 25, "cells": 6}),
    ],
    binds=["penalty, cpdi, kappa 8"],
    when="full",
)


@straight
def test_straight(run):
    at = run.place.at
    run.gate(
        f"{at}: largest force against Hertz",
        run.of(bounce.against_hertz, "force"),
        0.0,
        binds=run.method.matches("penalty, cpdi, kappa 8"),
        unit="%",
        key="force",
    )
    run.gate(
        f"{at}: time of contact against Hertz",
        run.of(bounce.against_hertz, "time"),
        0.0,
        binds=run.method.matches("penalty, cpdi, kappa 8"),
        unit="%",
        key="time",
    )
    run.gate(f"{at}: coefficient of restitution", run.of(bounce.impact, "restitution"), 1.0)


@together(oblique, alike, straight)
def test_together_1(case, runs):
    for method, same in runs.by_method():
        case.gate(
            "linear momentum of both, change, of all runs",
            same.of(bounce.largest, of="momentum"),
            0.0,
            (0.0, 1e-12),
            method=method,
        )
        case.gate(
            "moment of contact on both in a step, over their angular momentum, of all runs",
            same.of(bounce.largest, of="moment"),
            0.0,
            (0.0, 1e-09),
            method=method,
        )
        case.gate(
            "energy and what is dissipated, over the start, of all runs",
            same.of(bounce.largest, of="energy"),
            1.0,
            (0.0, 1.005),
            method=method,
        )


@together(oblique, alike)
def test_together_2(case, runs):
    for method, same in runs.by_method():
        case.gate(
            "angular momentum of both, change, of all runs",
            same.of(bounce.largest, of="angular"),
            0.0,
            method=method,
            unit="%",
        )


def test_alone_3(case):
    with case.timed():
        value = elastic.sliding_limit()
    case.gate("elastic sphere, departure from sliding throughout in ψ", value, 0.0, 1e-06, method="reference")
    with case.timed():
        value = elastic.refined()
    case.gate(
        "elastic sphere at 45°, half as many springs and steps", value, 0.0, (0.0, 0.001), method="reference"
    )


@together(oblique)
def test_figure(case, runs):
    case.figure("", drawn.draw(runs))
