"""Time step and contact events as series, and the warnings that come of them."""

import json
import re

import numpy as np
import pytest

from contact_scenes import impact
from mpmfw import run
from mpmfw.errors import ResultsWarning


def colliding(kappa=1.0, gap=0.01, end=0.12, **keys):
    """Two equal blocks that meet."""
    mapping = impact(gap=gap, speed=1.0, slide=0.0, right="soft")
    mapping["contact"] |= {"method": "penalty", "penalty": {"kappa": kappa}}
    mapping["time"] = {"end": end, "output_interval": 0.01}
    return {**mapping, "output": {"stability": True}, **keys}


def test_steps_and_limits_are_recorded():
    tree = run(colliding(gap=0.25, end=0.3))  # apart by more than the search radius for half of the time
    series = tree["series"].to_dataset()
    owners = json.loads(tree.attrs["time_step_owners"])
    named = {owners[int(index)] for index in series["time_step_owner"].values}
    assert named == set(owners) == {"bulk wave speed (h / c)", "penalty springs and bulk"}
    steps = (0.01 / series["time_step"].values[1:]).round().sum()
    assert steps == tree.attrs["steps"]
    assert (
        series["time_step"].values[1:] <= 0.5 * (1.0 + 1e-12) * series["time_step_limit"].max().item()
    ).all()


def test_contacts_are_counted_in_steps():
    """A block touches for 2 L / c; nodes at the rim bounce more often, but none for fewer than 3 steps."""
    series = run(colliding())["series"].to_dataset().isel(pair=0)
    assert np.isnan(series["steps_per_contact"].values[0])
    assert np.nanmin(series["steps_per_contact"]) >= 3
    assert series["penetration"].max() > 0.0
    assert series["penetration"].max() >= 0.99 * (-series["min_gap"] / 0.1).max()


def test_contacts_are_those_of_the_step_whose_force_is_recorded():
    """With one output for each step, penetration and force come and go in the same frames, and a contact ends
    in the first frame without the force that it had."""
    scene = colliding(end=0.12)
    scene["time"] |= {"step": 4e-4, "output_interval": 4e-4}
    series = run(scene)["series"].to_dataset().isel(pair=0)
    pushed = np.abs(series["contact_force"].values).max(axis=1) > 0.0
    assert pushed.any()
    assert not pushed[-1]
    np.testing.assert_array_equal(series["penetration"].values > 0.0, pushed)
    last = np.flatnonzero(pushed)[-1]
    ended = np.flatnonzero(np.isfinite(series["steps_per_contact"].values))
    assert ended[-1] == last + 1


@pytest.mark.parametrize(
    ("kappa", "said"),
    [
        (0.1, r"left-right: the bodies penetrate by .* cells at time .*, more than 0\.15"),
        (0.01, r"suspect: left-right: penetration of .* cells at"),
    ],
)
def test_soft_springs_are_reported(kappa, said):
    with pytest.warns(ResultsWarning, match=said):
        tree = run(colliding(kappa=kappa))
    (warning,) = json.loads(tree.attrs["warnings"])
    assert re.search(said, warning)
    assert tree.attrs["status"].startswith("suspect") == said.startswith("suspect")


@pytest.mark.filterwarnings("ignore:suspect. energy of .* without a source")  # the step is past the limit
def test_contacts_that_steps_do_not_resolve_are_reported():
    scene = colliding(kappa=200.0, allow_unstable=True)
    scene["time"]["step"] = 1.5e-3
    with pytest.warns(ResultsWarning, match=r"left-right: a contact lasted [12] steps, fewer than 3"):
        run(scene)
