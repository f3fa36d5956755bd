"""Question: balanced two-pass or master and slave."""
# cost: 60

# Balanced two-pass contact against master and slave: symmetry, force noise, accuracy, contact stress,
# cost. What the surfaces of the two blocks are made of: like meshes, and one four times or eight times
# as coarse.

import questions
import sliding

from mpmfw.validation import Place, Runs, methods

rings = Runs(
    "rings",
    scene="colliding-rings",
    methods=methods(
        settings={
            "": {},
            "one pass, master left": {"contact.penalty.passes": "one", "contact.penalty.master": "left"},
            "one pass, master right": {"contact.penalty.passes": "one", "contact.penalty.master": "right"},
        }
    ),
    set={"output.particles": False, "output.ledger": False},
    quick={"time.end": "0.4 ms"},
)


@rings
def test_rings(run):
    run.gate("rings: mirror error", run.of(questions.of_rings, "mirror"), 0.0, (0.0, 0.01), "h")
    run.gate("rings: noise of the force", run.of(questions.of_rings, "noise"), unit="%")
    if not run.case.quick:
        for quantity, key, unit in (
            ("rings: impulse curve, largest error", "impulse_curve_error", "%"),
            ("rings: force over 100 us, L2 error", "force_error_100us", ""),
            ("rings: largest penetration", "largest_penetration", "h"),
        ):
            run.gate(quantity, run.of(questions.of_rings, key), "", None, unit)
    run.gate("rings: CPU time of a step", run.of(questions.of_rings, "step"), unit="ms")
    run.gate("rings: share of contact", run.of(questions.of_rings, "share"), unit="%")


scene = Runs(
    "",
    scene="rolling-cylinder-no-slip",
    methods=methods(
        settings={
            "": {},
            "one pass, master cylinder": {
                "contact.penalty.passes": "one",
                "contact.penalty.master": "cylinder",
            },
            "one pass, master plane": {"contact.penalty.passes": "one", "contact.penalty.master": "plane"},
        }
    ),
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": False,
        "time.output_interval": 0.002,
    },
    when="full",
)


@scene
def test_scene(run):
    for quantity, key in (
        ("rolling, no slip: displacement, error", "displacement"),
        ("rolling, no slip: acceleration, error", "acceleration"),
        ("rolling, no slip: spin, error", "spin"),
    ):
        run.gate(quantity, run.of(questions.of_rolling, key, roll="no slip"), 0.0, None, "%")
    run.gate("rolling, no slip: noise of the normal force", run.of(questions.rolling_noise), unit="%")
    for quantity, key, unit in (
        ("rolling, no slip: mean penetration", "penetration", "h"),
        ("rolling, no slip: CPU time of a step", "step", "ms"),
        ("rolling, no slip: share of contact", "share", "%"),
    ):
        run.gate(quantity, run.of(questions.of_rolling, key, roll="no slip"), "", None, unit)


scene_2 = Runs(
    "",
    scene="rolling-cylinder-slip",
    methods=methods(
        settings={
            "": {},
            "one pass, master cylinder": {
                "contact.penalty.passes": "one",
                "contact.penalty.master": "cylinder",
            },
            "one pass, master plane": {"contact.penalty.passes": "one", "contact.penalty.master": "plane"},
        }
    ),
    set={
        "output.particles": False,
        "output.surface": False,
        "output.ledger": False,
        "time.output_interval": 0.002,
    },
    when="full",
)


@scene_2
def test_scene_2(run):
    for quantity, key in (
        ("rolling, slip: displacement, error", "displacement"),
        ("rolling, slip: acceleration, error", "acceleration"),
        ("rolling, slip: spin, error", "spin"),
    ):
        run.gate(quantity, run.of(questions.of_rolling, key, roll="slip"), 0.0, None, "%")
    run.gate("rolling, slip: noise of the normal force", run.of(questions.rolling_noise), unit="%")
    for quantity, key, unit in (
        ("rolling, slip: mean penetration", "penetration", "h"),
        ("rolling, slip: CPU time of a step", "step", "ms"),
        ("rolling, slip: share of contact", "share", "%"),
    ):
        run.gate(quantity, run.of(questions.of_rolling, key, roll="slip"), "", None, unit)


scene_2_2 = Runs(
    "",
    scene="../sliding-block/scene.toml",
    methods=methods(
        settings={
            "": {},
            "one pass, master block": {"contact.penalty.passes": "one", "contact.penalty.master": "block"},
            "one pass, master plane": {"contact.penalty.passes": "one", "contact.penalty.master": "plane"},
        }
    ),
    set={"output.particles": False},
    when="full",
)


@scene_2_2
def test_scene_2_2(run):
    run.gate(
        "sliding block: fitted acceleration, error",
        run.of("acceleration", scale=100.0, relative=True),
        0.0,
        unit="%",
    )
    run.gate("sliding block: T / (mu N), error", run.of(sliding.friction_error), 0.0, unit="%")


blocks = Runs(
    "blocks",
    scene="../contact-stress/scene.toml",
    methods=methods(
        settings={
            "": {},
            "one pass, master lower": {"contact.penalty.passes": "one", "contact.penalty.master": "lower"},
            "one pass, master upper": {"contact.penalty.passes": "one", "contact.penalty.master": "upper"},
        }
    ),
    places=[
        Place("like segments", when="full"),
        Place("upper segments h", set={"bodies.upper.segment": "1 cells"}, when="full"),
        Place("upper segments 2h", set={"bodies.upper.segment": "2 cells"}),
    ],
)


@blocks
def test_blocks(run):
    at = run.place.at
    run.gate(
        f"blocks, {at}: largest departure of σ_yy", run.of(questions.of_blocks, "departure"), 0.0, unit="%"
    )
