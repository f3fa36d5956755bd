"""Impact of two equal bars."""
# cost: 60

# Pressure, duration and velocities of a one-dimensional impact, for every method, classical contact in
# three forms. A coarse cell is thicker than the bars, which then are one cell of their own thick.

import pulse

from mpmfw.validation import RECOMMENDED, SHAPES, Runs, methods, together

scene = Runs(
    "",
    methods=[
        *methods(["none", "bardenhagen(criterion=position, normal=master)", "penalty"], SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            SHAPES,
            settings={
                "": {},
                "normal specified": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [1.0, 0.0],
                },
                "position, normal specified": {
                    "contact.bardenhagen.criterion": "position",
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [1.0, 0.0],
                },
            },
            when="full",
        ),
        *methods(["separate"], when="full"),
        *methods(
            ["penalty", "bardenhagen"],
            settings={
                "L/h = 20": {
                    "grid.cell_size": 0.5,
                    "bodies.left.geometry.lower": [-9.95, 0.0],
                    "bodies.left.geometry.upper": [0.05, 0.5],
                    "bodies.right.geometry.lower": [0.11, 0.0],
                    "bodies.right.geometry.upper": [10.11, 0.5],
                },
                "L/h = 40": {"grid.cell_size": 0.25},
            },
            when="full",
        ),
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(["bardenhagen"], when="quick"),
    ],
    set={"output.particles": False, "output.surface": False, "output.gap": False},
)


@scene
def test_scene(run):
    run.gate("plateau, error", run.of(pulse.against_closed_form, "plateau", scale=100.0), 0.0, 3.0, "%")
    run.gate(
        "contact duration, error", run.of(pulse.against_closed_form, "duration", scale=100.0), 0.0, 5.0, "%"
    )
    run.gate("gap where contact begins", run.of(pulse.against_closed_form, "early"), 0.0, unit="h")
    run.gate("plateau, rms ripple", run.of(pulse.against_closed_form, "ripple"), 0.0, unit="%")
    run.gate("velocity after it, error", run.of(pulse.rebound, scale=100.0), 0.0, 2.0, "%")


@together(scene)
def test_figure(case, runs):
    case.figure("", pulse.draw(runs))
