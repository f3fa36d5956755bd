"""Question: balanced two-pass contact against master and slave: the symmetry of the rings."""
# cost: 20

import rings

from mpmfw.validation import Runs, methods

ONE_PASS = {
    f"one pass, master {body}": {"contact.penalty.passes": "one", "contact.penalty.master": body}
    for body in ("left", "right")
}

impact = Runs(
    "rings",
    "colliding-rings",
    methods(settings={"": {}, **ONE_PASS}),
    set={"output.particles": False, "output.ledger": False},
    quick={"time.end": "0.4 ms"},
)


@impact
def test_rings(run):
    run.gate("rings: mirror error", run.of(rings.mirror_error), 0.0, (0.0, 0.01), "h")
