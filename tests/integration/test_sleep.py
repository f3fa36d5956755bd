"""Bodies at rest sleep: who does, what wakes them, and that nothing is lost meanwhile."""

from typing import Any

import numpy as np
import pytest
from test_restart import stop_and_go_on

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of, solid, with_changes

SLEEP = {"sleep": {}}


def block(lower, upper, **more):
    """A rectangle of points of half a cell."""
    return solid(lower, upper, 0.125, **more)


def scene(bodies, contact="penalty", **changes):
    """Bodies in a channel of cells of 0.25 m."""
    table = {"method": contact, "friction": 0.2}
    return with_changes(
        scene_of(bodies, 0.25, [-4.0, -4.0], [12.0, 8.0], end=1.0, outputs=4, contact=table), **changes
    )


def hit(contact="penalty", **changes):
    """A block flies towards two that touch, and a fourth lies behind."""
    bodies = {
        "flying": block([-0.5, -0.5], [0.5, 0.5], velocity=[4.0, 0.3]),
        "first": block([4.5, -0.5], [5.5, 0.5]),
        "second": block([5.5, -0.5], [6.5, 0.5]),
        "behind": block([9.5, -0.5], [10.5, 0.5]),
    }
    return scene(bodies, contact, **changes)


def stack(**changes):
    """A block on a held one under gravity, settled."""
    bodies = {
        "base": block([-1.0, -0.5], [1.0, 0.0], sides=[{"side": "bottom", "fixed": True}]),
        "block": block([-0.5, 0.0], [0.5, 1.0]),
    }
    gravity = {"gravity": {"vector": [0.0, -1.0]}, "settle": {"tolerance": 1e-3}}
    return scene(bodies, **gravity, sleep={"strain": 1e-4}, **changes)


class Watch:
    """Runs a scene and keeps who slept when, and the series of the outputs."""

    def __init__(self, given, threads=1):
        self.simulation = Simulation(given, threads=threads)
        self.changes: list[tuple[float, set[str]]] = []
        self.series: list[dict[str, Any]] = []
        self.simulation.run(
            write=lambda frame: self.series.append({k: np.copy(v) for k, v in frame.series.items()}),
            after_step=self.look,
        )

    def look(self):
        sleep, state = self.simulation._sleep, self.simulation.state
        if sleep is not None and self.simulation.started:
            asleep = {body.name for body in state.bodies if sleep.inactive[body.index]}
            if asleep != (self.changes[-1][1] if self.changes else set()):
                self.changes.append((state.time, asleep))


@pytest.mark.parametrize("contact", ["penalty", "bardenhagen"])
def test_a_hit_wakes_those_that_touch_and_nothing_else_changes(contact):
    """Friction, springs and the order of contacts are those of the run without sleep; so is the momentum."""
    fixed = {"time__step": 4e-4, "allow_unstable": True}
    awake, slept = Watch(hit(contact, **fixed)), Watch(hit(contact, **fixed, **SLEEP))
    assert [names for _, names in slept.changes] == [{"first", "second", "behind"}, {"behind"}]
    assert slept.changes[1][0] < 1.0 < slept.changes[1][0] + 0.5  # the gap of 4 m is gone at 1 s
    for name in ("centre_of_mass", "linear_momentum", "contact_force"):
        for one, other in zip(awake.series, slept.series, strict=True):
            scale = max(np.abs(each[name]).max() for each in awake.series)
            assert np.abs(one[name] - other[name]).max() <= 1e-6 * scale
    before, after = (slept.series[k]["linear_momentum"].sum(axis=0) for k in (0, -1))
    np.testing.assert_allclose(after, before, rtol=1e-12)


def test_several_threads_give_the_same_bits():
    """Bodies fall asleep and wake in a run on two threads as in one on a single thread."""
    alone, shared = (Watch(hit(**SLEEP), threads) for threads in (1, 2))
    assert [names for _, names in shared.changes] == [{"first", "second", "behind"}, {"behind"}]
    for one, other in zip(alone.series, shared.series, strict=True):
        for name in one:
            np.testing.assert_array_equal(one[name], other[name], err_msg=name)


def test_a_stack_at_rest_sleeps_and_bears_its_weight():
    """Its contact force stays that of the equilibrium, and is recorded as such."""
    watch = Watch(stack(time__end=0.6, time__output_interval=0.2))
    assert [names for _, names in watch.changes] == [{"base", "block"}]
    last = watch.series[-1]
    np.testing.assert_allclose(abs(last["contact_force"][0, 1]), 1000.0 * 1.0, rtol=2e-3)
    np.testing.assert_array_equal(last["centre_of_mass"], watch.series[-2]["centre_of_mass"])


def test_a_load_that_changes_wakes():
    """A pressure that begins at 0.5 s acts from then on as if nobody had slept."""
    side = {"side": "left", "pressure": [[0.0, 0.0], [0.5, 0.0], [0.6, 2e3], [1.0, 2e3]]}
    pushed = {"pushed": block([-0.5, -0.5], [0.5, 0.5], sides=[side]), "other": block([6.0, 5.0], [7.0, 6.0])}
    awake, slept = Watch(scene(pushed)), Watch(scene(pushed, **SLEEP))
    assert [names for _, names in slept.changes] == [{"pushed", "other"}, {"other"}]
    assert 0.5 <= slept.changes[1][0] < 0.505
    moved = awake.series[-1]["centre_of_mass"][0]
    np.testing.assert_allclose(slept.series[-1]["centre_of_mass"][0], moved, rtol=1e-6, atol=1e-9)
    assert moved[0] > 0.1
    side["velocity"] = [[0.0, 0.0, "free"], [0.5, 0.0, "free"], [0.6, 1.0, "free"]]
    del side["pressure"]
    watch = Watch(scene(pushed, **SLEEP))
    assert [names for _, names in watch.changes] == [{"pushed", "other"}, {"other"}]
    gravity = {"table": [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.6, 0.0, -5.0]]}
    watch = Watch(scene({**pushed, "pushed": block([0.0, 0.0], [1.0, 1.0])}, gravity=gravity, **SLEEP))
    assert [names for _, names in watch.changes] == [{"pushed", "other"}, set()]


def test_the_top_of_a_flight_is_no_rest():
    """A body that gravity turns back is slow for a while, longer than it would have to be at rest, and does
    not stop.
    """
    bodies = {
        "thrown": block([0.0, 0.0], [1.0, 1.0], velocity=[0.0, 0.05]),
        "other": block([6.0, 5.0], [7.0, 6.0]),
    }
    weak = {"gravity": {"vector": [0.0, -0.1]}, "sleep": {"strain": 1e-4, "crossings": 1}}
    watch = Watch(scene(bodies, **weak))
    slow = 2.0 * watch.simulation._sleep.bound[0] / 0.1
    assert slow > 5.0 * watch.simulation._sleep.patience[0]
    assert watch.changes == []
    np.testing.assert_allclose(watch.series[-1]["centre_of_mass"][0, 1], 0.5, rtol=1e-3)  # 0.05 t − 0.05 t²


@pytest.mark.parametrize("step", [342, 976])
def test_resumes_to_the_bit(tmp_path, step):
    """Saved at 0.3 s, while some sleep, and at 0.8 s, after they were hit."""
    stop_and_go_on(lambda: Simulation(hit(**SLEEP, time__end=1.2)), tmp_path / "saved", step)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"contact__method": "none"}, "sleep: expected a contact with a velocity field for each body"),
        ({"contact__method": "lcp"}, "sleep: contact 'lcp' cannot leave bodies out"),
        ({"contact__penalty": {"passes": "one", "master": "first"}}, "sleep: contact 'penalty(master=first, passes=one)'"),  # noqa: E501
        ({"output__ledger": True}, "sleep: output.ledger measures all bodies in every step"),
    ],
)  # fmt: skip
def test_what_is_refused(changes, said):
    with pytest.raises(SceneError) as refused:
        Simulation(hit(**SLEEP, **changes))
    assert str(refused.value).startswith(said)


def test_the_side_under_a_sleeping_body_keeps_its_force():
    run = mpmfw.run(stack())
    force = run["series"]["side_reaction"].sel(axis="y").isel(side=0)
    asleep = force.values[-3:]
    assert (asleep > 0.5 * force.values[1:].max()).all()
    assert np.ptp(asleep) < 0.05 * asleep.mean()
