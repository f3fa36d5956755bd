"""A ring that is compressed between platens: its inner radius measures their friction."""
# cost: 60

import compressed

from mpmfw.validation import Place, Runs, methods

smooth = Runs(
    "smooth",
    scene=compressed.scene,
    methods=[*methods(), *methods(["lcp"], bound=True), *methods(shape=["gimp"])],
    places=[Place("m = 0", make={"cells": 4, "factor": 0.0}, within={"mean": (-1.0, 1.0)})],
    when="full",
)
rough = Runs(
    "rough",
    scene=compressed.scene,
    methods=[*methods(), *methods(["lcp"], bound=True, when="full")],
    places=[
        Place("m = 0.1", make={"cells": 4, "factor": 0.1}, within={"mean": (-4.0, 4.0)}),
        Place("m = 0.2", make={"cells": 4, "factor": 0.2}, within={"mean": (-4.0, 4.0)}, when="full"),
        Place("m = 0.2, finer", make={"cells": 8, "factor": 0.2}, within={"mean": (-4.0, 4.0)}, when="full"),
        Place("m = 0.5, finer", make={"cells": 8, "factor": 0.5}, when="full"),
    ],
)


def judge(run):
    """Record the inner radius at a reduction of the height of 40 %."""
    args = {"factor": run.place.make["factor"]}
    mean, barrel = (run.of(compressed.inner_radius, key, **args) for key in ("mean", "barrel"))
    quantity = f"inner radius against Avitzur's bound, error, {run.place.at}"
    run.gate(quantity, mean, 0.0, None, "%", key="mean")
    run.gate(f"inner radius, rim less middle, {run.place.at}", barrel, 0.0, None, "%", binds=False)


@smooth
def test_smooth(run):
    judge(run)


@rough
def test_rough(run):
    judge(run)
