"""Question: how stiff the contact springs should be: penetration and stable time step over κ.

Of two blocks at rest the penetration is p h / (κ M), and the limit of the time step 2 / sqrt(ω_bulk² + ω²)
= (h/c) / sqrt(1 + κ). From κ = 0.1 on, below which the penetration is deeper than a segment is long.
"""
# cost: 10

import math

import blocks
import numpy as np
from classical import over

from mpmfw.validation import Runs, methods, together

MODULUS, DENSITY = 20e6, 1000.0  #: K + 4 G / 3 [Pa] and density of the two blocks [kg/m³]
LINEAR = 0.1  #: least κ of the fit


def stiffnesses(values, when=""):
    """Return penalty contact with each κ."""
    return methods(settings=over("contact.penalty.kappa", "kappa {:.3g}", values), when=when)


HALF_DECADES = [10.0 ** (k / 2) for k in range(-4, 5)]

at_rest = Runs(
    "blocks",
    "../contact-stress/scene.toml",
    [*stiffnesses(HALF_DECADES, "full"), *stiffnesses((0.1, 1.0, 10.0), "quick")],
    set={"output.stability": True},
)


def kappa_of(run):
    """Return the stiffness factor of a run."""
    return run.method.set["contact.penalty.kappa"]


def depth(tree):
    """Return the penetration at the end [h]."""
    return -float(tree["series"]["min_gap"].isel(pair=0, time=-1)) / float(tree.attrs["cell_size"])


def limit(tree):
    """Return the limit of the time step at the end [h/c]."""
    seconds = float(tree["series"]["time_step_limit"][-1])
    return seconds * math.sqrt(MODULUS / DENSITY) / float(tree.attrs["cell_size"])


@at_rest
def test_at_rest(run):
    kappa = kappa_of(run)
    run.gate("blocks: penetration", run.of(depth), blocks.PRESSURE / (kappa * MODULUS), unit="h")
    run.gate("blocks: limit of the time step", run.of(limit), 1.0 / math.sqrt(1.0 + kappa), unit="h/c")
    run.gate("blocks: largest departure of σ_yy", run.of(blocks.stress, "departure"), 0.0, unit="%")


@together(at_rest)
def test_exponent(case, runs):
    depths = {kappa_of(run): run.of(depth) for run in runs if kappa_of(run) >= LINEAR}
    exponent = np.polyfit(np.log(list(depths)), np.log(list(depths.values())), 1)[0]
    case.gate("blocks: exponent of the penetration in kappa", exponent, -1.0, (-1.03, -0.97))
