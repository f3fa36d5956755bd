"""Question: how stiff the contact springs should be: penetration, accuracy and stable time step over κ.

Of two blocks at rest the penetration is p h / (κ M), and the limit of the time step 2 / sqrt(ω_bulk² + ω²)
= (h/c) / sqrt(1 + κ). From κ = 0.1 on, below which the penetration is deeper than a segment is long.
"""
# cost: 70

import blocks
import questions
from classical import over
from rolling import SERIES_ONLY

from mpmfw.validation import Runs, methods, together


def stiffnesses(values, when=""):
    """Return penalty contact with each κ."""
    return methods(settings=over("contact.penalty.kappa", "kappa {:.3g}", values), when=when)


DECADES = (0.01, 0.1, 1.0, 10.0, 100.0)
HALF_DECADES = [10.0 ** (k / 2) for k in range(-4, 5)]

at_rest = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    [*stiffnesses(HALF_DECADES, "full"), *stiffnesses(DECADES[1:4], "quick")],
    set={"output.stability": True},
)
rolling = Runs("rolling", "rolling-cylinder-no-slip", stiffnesses(DECADES), set=SERIES_ONLY, when="full")
rings = Runs("rings", "colliding-rings", stiffnesses(DECADES), set=questions.FEW_POINTS, when="full")


@at_rest
def test_at_rest(run):
    for quantity, key, unit in (("penetration", "depth", "h"), ("limit of the time step", "limit", "h/c")):
        value, closed = (run.of(blocks.of_blocks, name) for name in (key, f"closed {key}"))
        run.gate(f"blocks: {quantity}", value, closed, unit=unit)
    run.gate("blocks: largest departure of σ_yy", run.of(questions.of_blocks, "departure"), 0.0, unit="%")


@together(at_rest)
def test_exponent(case, runs):
    case.gate("blocks: exponent of the penetration in kappa", runs.of(blocks.exponent), -1.0, (-1.03, -0.97))


@rolling
def test_rolling(run):
    questions.record_roll(run, "rolling", "no slip", *questions.WHOLE_COST)


@rings
def test_rings(run):
    questions.record_impact(run, "rings", *questions.IMPACT, *questions.WHOLE_COST)
