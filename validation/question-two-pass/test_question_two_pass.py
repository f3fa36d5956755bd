"""Question: balanced two-pass contact against master and slave: symmetry, noise, accuracy, cost."""
# cost: 60

import blocks
import incline
from questions import COST, IMPACT, ROLL, of_rings, of_rolling, record
from rolling import SERIES_ONLY

from mpmfw.validation import Place, Runs, each, methods


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
pressed = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    passes("lower", "upper"),
    [
        Place("like segments", when="full"),
        Place("upper segments h", {"bodies.upper.segment": "1 cells"}, when="full"),
        Place("upper segments 2h", {"bodies.upper.segment": "2 cells"}),
    ],
)


NOISE = ("noise of the normal force", "noise", "", None, "%")


@rings
def test_rings(run):
    impulse, force, noise, penetration = IMPACT
    whole = () if run.case.quick else (impulse, force, penetration)
    record(run, "rings", of_rings, ("mirror error", "mirror", 0.0, (0.0, 0.01), "h"), noise, *COST, *whole)


@each(no_slip, slip)
def test_rolling(run):
    record(run, f"rolling, {run.runs}", of_rolling, *ROLL, *COST, NOISE, roll=run.runs)


@block
def test_block(run):
    acceleration = run.of("acceleration", relative=True, scale=100.0)
    run.gate("sliding block: fitted acceleration, error", acceleration, 0.0, unit="%")
    friction = run.of(incline.sliding, "friction", scale=100.0)
    run.gate("sliding block: T / (mu N), error", friction, 0.0, unit="%")


@pressed
def test_pressed(run):
    departure = run.of(blocks.stress, "departure")
    run.gate(f"blocks, {run.place.at}: largest departure of σ_yy", departure, 0.0, unit="%")
