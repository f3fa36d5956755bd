"""Question: balanced two-pass contact against master and slave: symmetry, noise, accuracy, cost."""
# cost: 60

import questions
import sliding
from rolling import SERIES_ONLY

from mpmfw.validation import Place, Runs, methods


def passes(one, other):
    """Return two passes, and one pass with either body as master."""
    settings = {
        f"one pass, master {body}": {"contact.penalty.passes": "one", "contact.penalty.master": body}
        for body in (one, other)
    }
    return methods(settings={"": {}, **settings})


OFTEN = {**SERIES_ONLY, "time.output_interval": 0.002}

rings = Runs(
    "rings",
    "colliding-rings",
    passes("left", "right"),
    set={"output.particles": False, "output.ledger": False},
    quick={"time.end": "0.4 ms"},
)
no_slip = Runs("no slip", "rolling-cylinder-no-slip", passes("cylinder", "plane"), set=OFTEN, when="full")
slip = Runs("slip", "rolling-cylinder-slip", passes("cylinder", "plane"), set=OFTEN, when="full")
block = Runs(
    "sliding block",
    "../sliding-block/scene.toml",
    passes("block", "plane"),
    set={"output.particles": False},
    when="full",
)
#: What the surfaces of the two blocks are made of: like meshes, and one four times or eight times as coarse.
blocks = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    passes("lower", "upper"),
    [
        Place("like segments", when="full"),
        Place("upper segments h", {"bodies.upper.segment": "1 cells"}, when="full"),
        Place("upper segments 2h", {"bodies.upper.segment": "2 cells"}),
    ],
)


@rings
def test_rings(run):
    run.gate("rings: mirror error", run.of(questions.of_rings, "mirror"), 0.0, (0.0, 0.01), "h")
    impulse, force, noise, penetration = questions.IMPACT
    whole_impact = () if run.case.quick else (impulse, force, penetration)
    questions.record_impact(run, "rings", noise, *questions.COST, *whole_impact)


@no_slip
def test_no_slip(run):
    questions.record_roll(run, "rolling, no slip", "no slip", *questions.COST, noise=True)


@slip
def test_slip(run):
    questions.record_roll(run, "rolling, slip", "slip", *questions.COST, noise=True)


@block
def test_block(run):
    acceleration = run.of("acceleration", relative=True, scale=100.0)
    run.gate("sliding block: fitted acceleration, error", acceleration, 0.0, unit="%")
    run.gate("sliding block: T / (mu N), error", run.of(sliding.friction_error), 0.0, unit="%")


@blocks
def test_blocks(run):
    departure = run.of(questions.of_blocks, "departure")
    run.gate(f"blocks, {run.place.at}: largest departure of σ_yy", departure, 0.0, unit="%")
