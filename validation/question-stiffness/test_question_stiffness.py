"""Question: how stiff the contact springs should be."""
# cost: 70

# The stiffness factor κ: penetration, accuracy and stable time step, from 0.01 to 100. Of two blocks at
# rest the penetration is p h / (κ M), and the limit of the time step 2 / sqrt(ω_bulk² + ω²) = (h/c) /
# sqrt(1 + κ). From κ = 0.1 on, below which the penetration is deeper than a segment is long.

import blocks
import questions

from mpmfw.validation import Runs, methods, together

blocks_runs = Runs(
    "blocks",
    scene="../contact-stress/scene.toml",
    methods=[
        *methods(
            settings={
                "kappa 0.01": {"contact.penalty.kappa": 0.01},
                "kappa 0.0316": {"contact.penalty.kappa": 0.03162277660168379},
                "kappa 0.1": {"contact.penalty.kappa": 0.1},
                "kappa 0.316": {"contact.penalty.kappa": 0.31622776601683794},
                "kappa 1": {"contact.penalty.kappa": 1.0},
                "kappa 3.16": {"contact.penalty.kappa": 3.1622776601683795},
                "kappa 10": {"contact.penalty.kappa": 10.0},
                "kappa 31.6": {"contact.penalty.kappa": 31.622776601683793},
                "kappa 100": {"contact.penalty.kappa": 100.0},
            },
            when="full",
        ),
        *methods(
            settings={
                "kappa 0.1": {"contact.penalty.kappa": 0.1},
                "kappa 1": {"contact.penalty.kappa": 1.0},
                "kappa 10": {"contact.penalty.kappa": 10.0},
            },
            when="quick",
        ),
    ],
    set={"output.stability": True},
)


@blocks_runs
def test_blocks_runs(run):
    run.gate(
        "blocks: penetration",
        run.of(blocks.of_blocks, "depth"),
        run.of(blocks.of_blocks, "closed depth"),
        unit="h",
    )
    run.gate(
        "blocks: limit of the time step",
        run.of(blocks.of_blocks, "limit"),
        run.of(blocks.of_blocks, "closed limit"),
        unit="h/c",
    )
    run.gate("blocks: largest departure of σ_yy", run.of(questions.of_blocks, "departure"), 0.0, unit="%")


rolling = Runs(
    "rolling",
    scene="rolling-cylinder-no-slip",
    methods=methods(
        settings={
            "kappa 0.01": {"contact.penalty.kappa": 0.01},
            "kappa 0.1": {"contact.penalty.kappa": 0.1},
            "kappa 1": {"contact.penalty.kappa": 1.0},
            "kappa 10": {"contact.penalty.kappa": 10.0},
            "kappa 100": {"contact.penalty.kappa": 100.0},
        }
    ),
    set={"output.particles": False, "output.surface": False, "output.ledger": False},
    when="full",
)


@rolling
def test_rolling(run):
    for quantity, key, reference, unit in (
        ("rolling: displacement, error", "displacement", 0.0, "%"),
        ("rolling: acceleration, error", "acceleration", 0.0, "%"),
        ("rolling: spin, error", "spin", 0.0, "%"),
        ("rolling: mean penetration", "penetration", "", "h"),
        ("rolling: steps", "steps", "", ""),
        ("rolling: CPU time", "cpu", "", "s"),
    ):
        run.gate(quantity, run.of(questions.of_rolling, key, roll="no slip"), reference, None, unit)


rings = Runs(
    "rings",
    scene="colliding-rings",
    methods=methods(
        settings={
            "kappa 0.01": {"contact.penalty.kappa": 0.01},
            "kappa 0.1": {"contact.penalty.kappa": 0.1},
            "kappa 1": {"contact.penalty.kappa": 1.0},
            "kappa 10": {"contact.penalty.kappa": 10.0},
            "kappa 100": {"contact.penalty.kappa": 100.0},
        }
    ),
    set={
        "output.particles": False,
        "output.ledger": False,
        "bodies.left.particles.size": "0.5 cells",
        "bodies.right.particles.size": "0.5 cells",
    },
    when="full",
)


@rings
def test_rings(run):
    for quantity, key, unit in (
        ("rings: impulse curve, largest error", "impulse_curve_error", "%"),
        ("rings: force over 100 us, L2 error", "force_error_100us", ""),
        ("rings: noise of the force", "noise", "%"),
        ("rings: largest penetration", "largest_penetration", "h"),
        ("rings: steps", "steps", ""),
        ("rings: CPU time", "cpu", "s"),
    ):
        run.gate(quantity, run.of(questions.of_rings, key), "", None, unit)


@together(blocks_runs)
def test_together_1(case, runs):
    case.gate("blocks: exponent of the penetration in kappa", runs.of(blocks.exponent), -1.0, (-1.03, -0.97))
