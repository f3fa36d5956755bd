"""Question: how stiff the contact springs should be: penetration and stable time step over κ.

Of two blocks at rest the penetration is p h / (κ M), from κ = 0.1 on, below which it is deeper than a segment
is long. The limit of the time step is (h/c) / sqrt(1 + κ).
"""
# cost: 10

import numpy as np
from common import over

from mpmfw.validation import Runs, methods, together


def stiffnesses(values, when=""):
    """Return penalty contact with each κ."""
    return methods(settings=over("contact.penalty.kappa", "kappa {:.3g}", values), when=when)


HALF_DECADES = [10.0 ** (k / 2) for k in range(-2, 5)]

at_rest = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    [*stiffnesses(HALF_DECADES, "full"), *stiffnesses((0.1, 1.0, 10.0), "quick")],
)


def kappa_of(run):
    """Return the stiffness factor of a run."""
    return run.method.set["contact.penalty.kappa"]


def depth(tree):
    """Return the penetration at the end [h]."""
    return -float(tree["series"]["min_gap"].isel(pair=0, time=-1)) / float(tree.attrs["cell_size"])


@at_rest
def test_at_rest(run):
    """Run every stiffness."""


@together(at_rest)
def test_exponent(case, runs):
    depths = {kappa_of(run): run.of(depth) for run in runs}
    exponent = np.polyfit(np.log(list(depths)), np.log(list(depths.values())), 1)[0]
    case.gate("blocks: exponent of the penetration in kappa", exponent, -1.0, (-1.03, -0.97))
