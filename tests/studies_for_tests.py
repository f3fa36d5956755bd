"""Small studies: a coarse block on an inclined plane, cheap to run, with a closed form of its own."""

import copy

from mpmfw.campaigns.judging import Judge
from mpmfw.studies.loading import load_study
from mpmfw.studies.study import make_grid
from scenes_for_tests import scene_of, solid

#: A block of 6 × 4 points on a plane, not settled: a run of milliseconds. Surfaces lie off the grid lines.
SLIDING = scene_of(
    {
        "block": solid([0.11, 0.013], [0.71, 0.413], 0.1),
        "plane": solid([-0.2, -0.2], [1.4, 0.013], 0.1, sides=[{"side": "bottom", "fixed": True}]),
    },
    *(0.2, [-0.6, -0.6], [1.8, 1.0]),
    end=0.02,
    outputs=10,
    contact={"method": "penalty", "friction": 0.1},
    gravity={"magnitude": 10.0, "tilt": 0.4},
    reference={"kind": "sliding-block"},
)


def tiny_study(**changes):
    """Two contacts at two cell sizes; ``changes`` replace whole tables."""
    study = {
        "title": "tiny",
        "scene": copy.deepcopy(SLIDING),
        "vary": {"contact": ["separate", "penalty"], "cell_size": [0.2, 0.1]},
        "error": {"quantity": "end-displacement"},
        "cost": {"repeats": 1},
    }
    return {**study, **changes}


def judge_of(study):
    """All that is checked before the first run."""
    loaded = load_study(study)
    grid = make_grid(loaded)
    return Judge(loaded.tables.error, grid, loaded.at, loaded.beside), grid
