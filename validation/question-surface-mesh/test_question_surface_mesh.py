"""Question: refinement of the surface mesh.

Both bodies of every scene with segments of h/8 to 2h, in rolling, static contact stress and an impact.
Lengths between the powers of two put the blocks' nodes off the grid's: 34, 25, 15 and 8 segments over ten
cells. Gates bind up to the longest that the guide recommends."""
# cost: 70

import blocks
from questions import COST, FEW_POINTS, IMPACT, ROLL, of_rings, of_rolling, record
from rolling import SERIES_ONLY

from mpmfw.validation import Runs, methods

POWERS = (0.125, 0.25, 0.5, 1, 2)
BOUND = [f"*, segments {length} h" for length in (0.125, 0.25, 0.3, 0.4, 0.5)]


def segments(bodies, lengths=POWERS, when=""):
    """Return segments of each length [h] on both bodies."""
    settings = {
        f"segments {length} h": {f"bodies.{body}.segment": f"{length} cells" for body in bodies}
        for length in lengths
    }
    return methods(settings=settings, when=when)


BLOCKS, CYLINDER, RINGS = ("lower", "upper"), ("cylinder", "plane"), ("left", "right")

at_rest = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    [
        *segments(BLOCKS, (0.125, 0.25, 0.3, 0.4, 0.5, 0.7, 1, 1.4, 2), "full"),
        *segments(BLOCKS, (0.25, 1), "quick"),
    ],
    binds=BOUND,
)
rolling = Runs(
    "rolling",
    "rolling-cylinder-slip",
    [*segments(CYLINDER, when="full"), *segments(CYLINDER, (0.25, 1), "quick")],
    set={**SERIES_ONLY, "time.output_interval": 0.002},
    quick={"grid.cell_size": 0.8},
)
rings = Runs("rings", "colliding-rings", segments(RINGS), set=FEW_POINTS, when="full")
#: κ = 1 instead of the shipped 0.25: whether long segments or stiff springs make the noise.
stiff_rings = Runs(
    "stiff rings",
    "colliding-rings",
    segments(RINGS),
    set={**FEW_POINTS, "contact.penalty.kappa": 1.0},
    when="full",
)


@at_rest
def test_blocks(run):
    most, off = (run.of(blocks.stress, key) for key in ("departure", "off the walls"))
    binds = run.method.matches(*BOUND)
    run.gate("blocks: largest departure of σ_yy", most, 0.0, (0.0, 3.0), "%", binds=binds)
    run.gate("blocks: largest departure off the walls", off, 0.0, unit="%")


@rolling
def test_rolling(run):
    noise = ("noise of the normal force", "noise", "", None, "%")
    record(run, "rolling", of_rolling, *ROLL, *COST, noise, roll="slip")


@rings
def test_rings(run):
    record(run, "rings", of_rings, *IMPACT, COST[0])


@stiff_rings
def test_stiff_rings(run):
    record(run, "rings, kappa 1", of_rings, *IMPACT[:3])
