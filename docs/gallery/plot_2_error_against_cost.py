"""
Error against cost
==================

A study runs a grid of methods and resolutions, measures the error of each, and puts it beside its CPU time.
Those that no other run beats in both are the Pareto front. A block slides down an incline; the error is that
of its acceleration against
:math:`g(\\sin\\theta - \\mu\\cos\\theta)`. The shipped study ``sliding-block`` has all methods, and repeats
every run for its cost.

Classical contact runs with its defaults and with its best settings. With averaged normals, the default, the
block's corners catch on the plane, and it does not slide; with the normal of the stiffer body it does."""

import mpmfw
from mpmfw import plots
from mpmfw.studies.conclusion import conclusions

study = {
    "title": "Sliding block, coarse",
    "scene": "sliding-block",
    "under": "0.02 %",
    "vary": {
        "contact": ["bardenhagen", "bardenhagen(criterion=position, normal=master)", "penalty"],
        "shape": ["gimp", "cpdi"],
        "cell_size": [0.2, 0.1],
    },
    "set": {"time.end": 0.4},
    "error": {"kind": "closed-form", "quantity": "acceleration"},
    "cost": {"repeats": 1},
}
dataset = mpmfw.study(study, jobs=1)
figure = plots.front(dataset)
figure

# %% What is on the front, the cheapest first. A run may be on the front with a large error: it is not beaten
# at its cost, no more.

mpmfw.pareto(dataset)

# %%
# Where the time goes, at the finer cells:

figure = plots.stages(dataset)
figure

# %%
# In words, as ``mpmfw study`` ends:

print(*conclusions(dataset), sep="\n")
