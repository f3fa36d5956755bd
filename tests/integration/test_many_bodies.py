"""Scenes of more than a few bodies: pairs are listed as they come near, nothing has a place for every two
bodies.
"""

import math

import numpy as np
import pytest
import xarray as xr

import mpmfw
from mpmfw.api import ContactStrategy, hookimpl
from mpmfw.results.analysis import energy_kept
from mpmfw.runs.simulation import Simulation
from mpmfw.state.windows import FEW
from scenes_for_tests import body_of, scene_of, with_changes

METHODS = ("none", "penalty")


#: The rows meet so fast that discs go deep into each other and normals lean, of which runs warn.
FAST = pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")


def many_discs(count, contact, **changes):
    """Touching discs of three cells across on a square lattice, every second row and column of which moves
    against the others at 0.1 m/s.
    """
    side = math.ceil(math.sqrt(count))
    bodies = {}
    for k in range(count):
        i, j = divmod(k, side)
        geometry = {"type": "disc", "centre": [3.0 * i + 0.03, 3.0 * j + 0.07], "radius": 1.5}
        velocity = [0.1 * (1 - 2 * (i % 2)), 0.1 * (1 - 2 * (j % 2))]
        bodies[f"d{k}"] = body_of(geometry, 0.5, layout="fitted", velocity=velocity)
    contact = {"method": contact, "friction": 0.3}
    made = scene_of(bodies, 1.0, [-7.5] * 2, [3.0 * side + 6.0] * 2, end=1.0, outputs=2, contact=contact)
    return with_changes(made, **changes)


def small(count, contact, **changes):
    """As few points as carry contact, and no frames but where they are asked for."""
    least = {"shape__method": "linear", "output": {"particles": False, "surface": False}}
    return many_discs(count, contact, **{**least, **changes})


def sizes_of(owner, path, seen):
    """Sizes of all arrays that an object holds, and those that it holds hold, by the way to them."""
    if id(owner) in seen:
        return
    seen.add(id(owner))
    inner = {}
    if isinstance(owner, np.ndarray):
        yield path, owner.size
    elif isinstance(owner, dict):
        inner = owner
    elif isinstance(owner, list | tuple) and len(owner) < 100:
        inner = dict(enumerate(owner))
    elif type(owner).__module__.startswith("mpmfw"):
        names = (*getattr(owner, "__dict__", {}), *getattr(type(owner), "__slots__", ()))
        inner = {name: getattr(owner, name, None) for name in names}
    for name, value in inner.items():
        yield from sizes_of(value, f"{path}.{name}", seen)


def all_sizes(count, method):
    """Number of pairs, and sizes of the arrays of state, plug-ins and frame after a step."""
    sim = Simulation(small(count, method, output={"stability": True}))
    sim.advance(1)
    held = [sim.state, *sim.registry.plugins.values(), sim._recorder.frame(1.0).series]
    named = {getattr(each, "name", type(each).__name__): each for each in held}
    # Plug-ins hold one another: an array is reached by the same way in every run
    return len(sim.state.pairs), dict(sizes_of(dict(sorted(named.items())), "", set()))


@pytest.mark.parametrize("method", METHODS)
def test_no_array_has_a_place_for_every_two_bodies(method):
    """Four times the bodies: what is in proportion grows by four, and at most by half more since fewer are at
    an edge.
    """
    (few_pairs, few), (pairs, many) = (all_sizes(count, method) for count in (100, 400))
    assert pairs < 24 * 400  # of 79 800
    assert pairs < 1.3 * 4 * few_pairs
    assert {
        path: (few.get(path, 0), size) for path, size in many.items() if size > 6 * max(few.get(path, 0), 200)
    } == {}
    assert len(many) > 40


def row_meets_row(method, count=FEW + 4, **changes):
    """Two rows of discs, ten cells apart, that meet at 120 m/s."""
    half = count // 2
    scene = small(count, method, **{"time": {"end": 0.15, "output_interval": 0.0125}, **changes})
    for k, body in enumerate(scene["bodies"].values()):
        column, row = k % half, k // half
        body["geometry"]["centre"] = [9.0 * column + 0.03, 13.0 * row + 0.07]
        body["velocity"] = [0.0, 60.0 * (1 - 2 * row)]
    scene["grid"].update(lower=[-8.0, -8.0], upper=[9.0 * half, 21.0])
    return scene


@FAST
def test_pairs_that_meet_during_the_run_are_in_the_results_of_memory_and_file(tmp_path):
    scene = row_meets_row("none")
    half = len(scene["bodies"]) // 2
    kept = mpmfw.run(scene)
    written = mpmfw.run(scene, output=tmp_path / "run.nc")
    for tree in (kept, written):
        gaps = tree["series"]["min_gap"]
        meeting = gaps.sel(pair=[f"d{k}-d{k + half}" for k in range(half)])
        assert np.isnan(meeting.values[0]).all()  # too far at the start to be listed
        assert np.isfinite(meeting.values[-1]).all()
        assert (meeting.min("time") < 0.5).all()
        assert f"d0-d{half + 2}" not in gaps["pair"].values
    xr.testing.assert_identical(kept["series"].to_dataset(), written["series"].to_dataset())


@FAST
@pytest.mark.parametrize("method", ["bardenhagen", "penalty"])
def test_a_body_moves_and_is_pushed_as_it_is_where_all_pairs_are_listed(method, monkeypatch):
    scene = row_meets_row(method)
    near = mpmfw.run(scene)["series"].to_dataset()
    monkeypatch.setattr("mpmfw.runs.build.FEW", 1000)
    every = mpmfw.run(scene)["series"].to_dataset()
    assert every.sizes["pair"] == 36 * 35 // 2 > near.sizes["pair"]
    for name in near.data_vars:
        one, other = near[name], every[name]
        if "pair" in one.dims:
            listed = one.notnull()
            other = other.sel(pair=near["pair"])
            assert listed.values[-1].all()
            if name != "min_gap":
                left = every[name].drop_sel(pair=near["pair"].values)
                assert (left == 0.0).all()  # what is not listed does nothing
                assert (other.where(~listed, 0.0) == 0.0).all()
            other = other.where(listed)
        np.testing.assert_array_equal(one.values, other.values, err_msg=str(name))
    assert (near["contact_force"].sum("time") != 0.0).any()
    assert np.isfinite(energy_kept(near)).all()


def test_pairs_that_the_scene_names_are_listed_from_the_start():
    scene = row_meets_row("penalty")
    scene["contact"]["pairs"] = [{"bodies": ["d20", "d3"], "friction": 0.7}]
    sim = Simulation(scene)
    assert (sim.state.pairs[0].label, sim.state.pairs[0].friction) == ("d3-d20", 0.7)
    assert np.isfinite(sim._recorder.frame(0.0).series["min_gap"]).all()
    effects = {effect.name: effect for effect in sim.effects}
    assert effects["contact"].reason == "penalty (Penalty), pairs: those that come near"
    assert effects["friction"].reason == "d3-d20, μ = 0.3 in pairs without another value"


def test_a_strategy_that_does_not_take_pairs_as_they_come_is_given_all():
    class Plain(ContactStrategy):
        name = "plain"

        @hookimpl
        def setup(self, setup):
            self.pairs = setup.pairs

    n = FEW + 1
    sim = Simulation(small(n, "none"), contact=Plain())
    assert sim.state.near is None
    assert len(sim.contact.pairs) == n * (n - 1) // 2


def test_a_file_of_many_bodies_grows_in_proportion(tmp_path):
    """Bytes of two frames; HDF5's lists of who uses a dimension would make it grow with the square."""

    def size(n):
        path = tmp_path / f"{n}.nc"
        mpmfw.run(many_discs(n, "penalty", time={"end": 1e-4, "output_interval": 1e-4}), output=path)
        return path.stat().st_size

    assert size(80) < 2.3 * size(40)
