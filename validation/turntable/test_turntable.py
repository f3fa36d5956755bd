"""Turntable."""
# cost: 450

# A block on a turning plate: it stays up to a speed, and slides outwards beyond.

import radius

from mpmfw.validation import CLASSICAL, Place, Runs, methods

stays = Runs(
    "stays",
    scene="scene.toml",
    methods=[*methods(), *methods(CLASSICAL, when="full"), *methods(["lcp"], when="full")],
    places=[
        Place("as it stands"),
        Place(
            "shifted",
            set={"grid.lower": [-1.569, -0.583, -1.577], "grid.upper": [1.631, 1.017, 1.623]},
            when="full",
        ),
    ],
    quick={"grid.cell_size": 0.15, "grid.lower": [-1.65, -0.6, -1.65], "grid.upper": [1.65, 1.05, 1.65]},
)


@stays
def test_stays(run):
    at = run.place.at
    run.gate(
        f"stays, {at}: creep",
        run.of(radius.judge, "creep"),
        0.0,
        1.0,
        "mm/s",
        binds=run.method.matches("penalty, *"),
    )
    run.gate(f"stays, {at}: turning of the plate, change", run.of(radius.judge, "turning"), 0.0, unit="%")


slides = Runs(
    "slides",
    scene="scene.toml",
    methods=[*methods(), *methods(CLASSICAL, when="full"), *methods(["lcp"], when="full")],
    places=[
        Place("as it stands"),
        Place(
            "shifted",
            set={"grid.lower": [-1.569, -0.583, -1.577], "grid.upper": [1.631, 1.017, 1.623]},
            when="full",
        ),
    ],
    set={
        "bodies.plate.angular_velocity": [0.0, 3.5, 0.0],
        "bodies.block.angular_velocity": [0.0, 3.5, 0.0],
        "bodies.block.velocity": [0.0, 0.0, -2.1],
    },
    quick={"grid.cell_size": 0.15, "grid.lower": [-1.65, -0.6, -1.65], "grid.upper": [1.65, 1.05, 1.65]},
)


@slides
def test_slides(run):
    at = run.place.at
    run.gate(
        f"slides, {at}: way outwards, error",
        run.of(radius.judge, "way"),
        0.0,
        1.5,
        "%",
        binds=run.method.matches("penalty, *"),
    )
    run.gate(f"slides, {at}: turning of the plate, change", run.of(radius.judge, "turning"), 0.0, unit="%")
