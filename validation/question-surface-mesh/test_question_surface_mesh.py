"""Question: refinement of the surface mesh.

Both blocks of contact-stress with segments of h/8 to 2h. Lengths between the powers of two put their nodes
off the grid's: 34, 25, 15 and 8 segments over ten cells. Gates bind up to the longest that the guide
recommends."""
# cost: 10

from common import BLOCKS, stress

from mpmfw.validation import Runs, methods

BOUND = [f"*, segments {length} h" for length in (0.125, 0.25, 0.3, 0.4, 0.5)]


def segments(lengths, when):
    """Return segments of each length [h] on both bodies."""
    settings = {
        f"segments {length} h": {f"bodies.{body}.segment": f"{length} cells" for body in BLOCKS}
        for length in lengths
    }
    return methods(settings=settings, when=when)


at_rest = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    segments((0.125, 0.25, 0.3, 0.4, 0.5, 0.7, 1, 1.4, 2), "full") + segments((0.25, 1), "quick"),
    binds=BOUND,
)


@at_rest
def test_blocks(run):
    most, binds = run.of(stress, "departure"), run.method.matches(*BOUND)
    run.gate("blocks: largest departure of σ_yy", most, 0.0, (0.0, 3.0), "%", binds=binds)
