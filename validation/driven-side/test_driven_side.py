"""Driven side."""
# cost: 60

# σ_yy of uniaxial strain in a block that its sides press together, wherever they lie in a cell. Places:
# grids on whose lines the sides lie, or 0.3 cells past one. Turned by 30°: mean, and extremes by the
# distance from sides as they are at the start.

import strain

from mpmfw.validation import RECOMMENDED, SHAPES, Place, Runs, methods

scene = Runs(
    "",
    methods=[*methods([""], SHAPES, when="full"), *methods([""], when="quick")],
    places=[
        Place(
            "h = 0.1 m, sides at 0 h",
            set={"grid.cell_size": 0.1, "grid.lower": [-0.5, -0.5], "grid.upper": [1.6, 1.6]},
        ),
        Place(
            "h = 0.1 m, sides at 0.3 h",
            set={"grid.cell_size": 0.1, "grid.lower": [-0.53, -0.53], "grid.upper": [1.57, 1.57]},
        ),
    ],
)


@scene
def test_scene(run):
    at = run.place.at
    run.gate(f"least σ_yy, error, {at}", run.of(strain.extremes, "least"), 0.0, 2.0, "%")
    run.gate(f"largest σ_yy, error, {at}", run.of(strain.extremes, "largest"), 0.0, 2.0, "%")


scene_2 = Runs(
    "",
    methods=methods([""], RECOMMENDED),
    places=[
        Place(
            "h = 0.05 m, sides at 0 h",
            set={"grid.cell_size": 0.05, "grid.lower": [-0.5, -0.5], "grid.upper": [1.55, 1.55]},
        ),
        Place(
            "h = 0.05 m, sides at 0.3 h",
            set={"grid.cell_size": 0.05, "grid.lower": [-0.515, -0.515], "grid.upper": [1.535, 1.535]},
        ),
        Place(
            "h = 0.025 m, sides at 0 h",
            set={"grid.cell_size": 0.025, "grid.lower": [-0.5, -0.5], "grid.upper": [1.525, 1.525]},
        ),
        Place(
            "h = 0.025 m, sides at 0.3 h",
            set={"grid.cell_size": 0.025, "grid.lower": [-0.5075, -0.5075], "grid.upper": [1.5175, 1.5175]},
        ),
    ],
    when="full",
)


@scene_2
def test_scene_2(run):
    at = run.place.at
    run.gate(f"least σ_yy, error, {at}", run.of(strain.extremes, "least"), 0.0, 2.0, "%")
    run.gate(f"largest σ_yy, error, {at}", run.of(strain.extremes, "largest"), 0.0, 2.0, "%")


scene_2_2 = Runs(
    "",
    methods=methods([""]),
    places=[
        Place(
            "h = 0.1 m", set={"grid.cell_size": 0.1, "grid.lower": [-0.53, -0.53], "grid.upper": [1.57, 1.57]}
        ),
        Place(
            "h = 0.05 m",
            set={"grid.cell_size": 0.05, "grid.lower": [-0.515, -0.515], "grid.upper": [1.535, 1.535]},
            when="full",
        ),
    ],
    set={"bodies.block.geometry.angle": 0.5235987755982988},
    binds=["*"],
)


@scene_2_2
def test_scene_2_2(run):
    at = run.place.at
    run.gate(
        f"mean σ_yy, error, turned by 30°, {at}", run.of(strain.turned, "mean"), 0.0, 1.0, "%", binds=True
    )
    run.gate(
        f"largest error farther than 3 h from sides, turned by 30°, {at}",
        run.of(strain.turned, "far"),
        0.0,
        (0.0, 2.0),
        "%",
        binds=True,
    )
    run.gate(
        f"largest error within 3 h of one side, turned by 30°, {at}",
        run.of(strain.turned, "one"),
        0.0,
        unit="%",
    )
    run.gate(
        f"largest error within 3 h of two, turned by 30°, {at}", run.of(strain.turned, "two"), 0.0, unit="%"
    )
