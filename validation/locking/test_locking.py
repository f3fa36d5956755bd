"""Locking: discs that meet and a roller between plates, of a material that nearly keeps its volume."""
# cost: 60

import squeezed

from mpmfw.validation import Place, Runs, methods


def places(at, **make):
    """Return a place for the default, whose gates bind, and one for the change of volume at every point."""
    return [Place(f"{at}, {how}", make={**make, "volumetric": how}) for how in ("auto", "pointwise")]


def binds(run):
    """Return True for the default."""
    return run.place.make["volumetric"] == "auto"


discs = Runs(
    "discs",
    scene=squeezed.discs,
    methods=methods(["lcp"]),
    places=places("ν = 0.499, R/h = 8", cells=8, poisson=0.499),
)
ordinary = Runs(
    "ordinary",
    scene=squeezed.discs,
    methods=methods(["lcp"]),
    places=[
        Place(how, make={"cells": 8, "poisson": 0.3, "volumetric": how}) for how in ("pointwise", "averaged")
    ],
    when="full",
)
finer = Runs(
    "finer",
    scene=squeezed.discs,
    methods=methods(["lcp"]),
    places=[Place("ν = 0.499, R/h = 16", make={"cells": 16, "poisson": 0.499, "volumetric": "auto"})],
    when="full",
)
splines = Runs(
    "splines",
    scene=squeezed.roller,
    methods=methods(shape=["bspline"]),
    places=[Place(how, make={"poisson": 0.499, "volumetric": how}) for how in ("auto", "averaged")],
    when="full",
)
rollers = Runs(
    "rollers",
    scene=squeezed.roller,
    places=places("ν = 0.499, R/h = 10", poisson=0.499),
    when="full",
)


@discs
def test_discs(run):
    run.gates(
        squeezed.impact,
        ("time of half the impulse, error, {at}", "time", 0.0, 2.0, "%"),
        ("largest force, error, {at}", "force", 0.0, 2.0, "%"),
        binds=binds(run),
    )


@finer
def test_finer_discs(run):
    run.gates(
        squeezed.impact,
        ("time of half the impulse, error, {at}", "time", 0.0),
        ("largest force, error, {at}", "force", 0.0),
    )


@splines
def test_rollers_of_splines(run):
    error = run.of(squeezed.force, poisson=0.499)
    run.gate(f"force of the roller, error, B-splines, {run.place.at}", error, 0.0, None, "%")


@rollers
def test_rollers(run):
    error = run.of(squeezed.force, poisson=0.499)
    run.gate(f"force of the roller, error, {run.place.at}", error, 0.0, 5.0, "%", binds=binds(run))


@ordinary
def test_restitution_of_discs_that_do_not_lock(run):
    run.gates(squeezed.impact, ("restitution, ν = 0.3, {at}", "restitution", 1.0))
