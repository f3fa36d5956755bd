"""Static hold."""
# cost: 150

# A block that friction must hold, with every contact and every shape function. [H17] with increments
# that add up below Coulomb's cap, and to the letter. Linear functions take MUSL by themselves, see the
# README. A tenth of the displacement's limit, which a block creeping at this rate would reach in ten
# seconds. What is left after settling is an oscillation, whose fit is far smaller. tan 20°, below μ In
# space, friction not along a grid line, 10⁴ steps Decision 50: nodes with next to no mass, beyond the
# faces, take 10⁴ steps and more to balance.

import holding

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Place, Runs, methods

scene = Runs(
    "",
    methods=[
        *methods(["bardenhagen"], when="quick"),
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            SHAPES,
            settings={
                "criterion position": {"contact.bardenhagen.criterion": "position"},
                "normal master": {"contact.bardenhagen.normal": "master"},
            },
            when="full",
        ),
        *methods(
            ["hamad2017"],
            settings={"": {}, "literal": {"contact.hamad2017.friction_law": "literal"}},
            when="full",
        ),
        *methods(
            ["bardenhagen", "penalty"], ["linear"], settings={"USL": {"stepping.scheme": "usl"}}, when="full"
        ),
    ],
    set={"output.particles": False},
)


@scene
def test_scene(run):
    run.gate("displacement after 2 s / height", run.of(holding.displacement), 0.0, (0.0, 0.001))
    run.gate("fitted drift in the last second / height", run.of(holding.drift), 0.0, 0.0001)
    run.gate("T / N in the last second", run.of(holding.friction), 0.36397023426620234)


in_space = Runs(
    "in space",
    scene="in-space.toml",
    methods=methods(["penalty", "bardenhagen"]),
    places=[
        Place("off the grid lines"),
        Place(
            "faces on grid lines",
            set={
                "bodies.block.geometry.lower": [0.5, 0.537, 0.5],
                "bodies.block.geometry.upper": [1.25, 0.912, 1.25],
                "bodies.plane.geometry.lower": [0.0, 0.0, 0.0],
                "bodies.plane.geometry.upper": [2.0, 0.537, 2.0],
            },
            open={"way": "nodes beyond the faces have next to no mass"},
        ),
    ],
    when="full",
)


@in_space
def test_in_space(run):
    at = run.place.at
    run.gate(
        f"in space, {at}: way in 10⁴ steps",
        run.of(holding.creep, "way"),
        0.0,
        (0.0, 1e-06),
        "h",
        binds=run.method.matches("penalty, *"),
        key="way",
    )
    run.gate(
        f"in space, {at}: change of it in the last 8000 steps", run.of(holding.creep, "later"), 0.0, unit="h"
    )
