"""Sliding block."""
# cost: 70

# Acceleration and friction force of a sliding block against Coulomb's law, with every contact and every
# shape function, classical contact in its stronger forms too. Height of the interface over a grid line,
# in cells of 0.1 m; the scene's is 0.13. [H17] with increments that add up below Coulomb's cap, and to
# the letter. The closed form is the scene's own: a = g (sin θ − μ cos θ) = 2.402 m/s².

import friction
import normals

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods

slides = Runs(
    "slides",
    methods=[
        *methods(CONTACTS, RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            SHAPES,
            settings={
                "criterion position": {"contact.bardenhagen.criterion": "position"},
                "normal master": {"contact.bardenhagen.normal": "master"},
                "normal specified": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [0.0, -1.0],
                },
                "normal specified, criterion position": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [0.0, -1.0],
                    "contact.bardenhagen.criterion": "position",
                },
            },
            when="full",
        ),
        *methods(
            ["bardenhagen", "penalty"],
            settings={
                "interface on a grid line": {
                    "bodies.block.geometry": {
                        "type": "rectangle",
                        "lower": [0.03, 0.0],
                        "upper": [0.63, 0.3],
                    },
                    "bodies.plane.geometry": {
                        "type": "rectangle",
                        "lower": [-0.4, -0.213],
                        "upper": [3.2, 0.0],
                    },
                },
                "interface in mid-cell": {
                    "bodies.block.geometry": {
                        "type": "rectangle",
                        "lower": [0.03, 0.05],
                        "upper": [0.63, 0.35],
                    },
                    "bodies.plane.geometry": {
                        "type": "rectangle",
                        "lower": [-0.4, -0.163],
                        "upper": [3.2, 0.05],
                    },
                },
            },
            when="full",
        ),
        *methods(
            ["hamad2017"],
            settings={"": {}, "literal": {"contact.hamad2017.friction_law": "literal"}},
            when="full",
        ),
    ],
    set={"output.particles": False},
    quick={"time.end": 0.5},
)


@slides
def test_slides(run):
    run.gate("fitted acceleration, error", run.of("acceleration", scale=100.0, relative=True), 0.0, 0.5, "%")
    run.gate("mean T / (mu N), error", run.of(friction.forces, "friction", scale=100.0), 0.0, 0.5, "%")
    run.gate("mean N / (m g cos theta)", run.of(friction.forces, "normal"), 1.0)


def test_alone_1(case):
    with case.timed():
        value = normals.steepest_tilt(interface=0.13)
    case.gate(
        "steepest averaged normal at the leading corner, interface as in the scene",
        value,
        "locks above 13.3",
        unit="deg",
    )
    with case.timed():
        value = normals.steepest_tilt(interface=0.0)
    case.gate(
        "steepest averaged normal at the leading corner, interface on a grid line",
        value,
        "locks above 13.3",
        unit="deg",
    )
    with case.timed():
        value = normals.steepest_tilt(interface=0.5)
    case.gate(
        "steepest averaged normal at the leading corner, interface in mid-cell",
        value,
        "locks above 13.3",
        unit="deg",
    )
