"""A run that is stopped at a step and loaded into a simulation built anew ends with the same bytes."""

import copy
import itertools
import os
import random

import numpy as np
import pytest

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available
from mpmfw.runs.restart import read_snapshot, write_snapshot
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene, shipped_scenes
from scenes_for_tests import solid, two_blocks

pytestmark = pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")  # settling is cut short

_ROLLS = {"grid.cell_size": 0.8, "settle.max_time": 0.02, "time.end": 0.02}
#: The shipped scenes with few points, few steps of settling and few after it; contact begins at once, or
#: within nine steps.
COARSE = {
    "colliding-rings": {
        "grid.cell_size": 0.008,
        "time.end": "0.2 ms",
        "output.stability": True,
        "output.contact_moment": "centre_of_mass",
    },
    "colliding-rings-4-a-cell": {"grid.cell_size": 0.008, "time.end": "0.2 ms"},
    "contact-stress": {
        "grid.cell_size": 0.25,
        "settle.max_time": 0.01,
        "time.end": 0.006,
        "time.output_interval": 0.001,
    },
    "column-collapse": {"grid.cell_size": 0.04, "time.end": 0.02},
    "taylor-bar": {"grid.cell_size": "1.6 mm", "time.end": "4 us"},
    "footing": {"grid.cell_size": 0.25, "time.end": 0.02},
    "roller": {"grid.cell_size": 0.25, "settle.max_time": 0.02, "time.end": 0.02},
    "wheel": {"grid.cell_size": 0.2, "time.end": 0.02},
    "rolling-cylinder-no-slip": _ROLLS,
    "rolling-cylinder-no-slip-rigid": _ROLLS,
    "rolling-cylinder-slip": {**_ROLLS, "output.ledger": True},
    "rolling-cylinder-slip-rigid": _ROLLS,
    "rolling-sphere-no-slip": _ROLLS,
    "rolling-sphere-no-slip-rigid": _ROLLS,
    "rolling-sphere-slip": _ROLLS,
    "rolling-sphere-slip-rigid": _ROLLS,
    "sliding-block": {
        "grid.cell_size": 0.2,
        "grid.lower": [-1.0, -0.8],
        "grid.upper": [3.8, 1.4],
        "settle.max_time": 0.008,
        "time.end": 0.01,
        "output.stability": True,
    },
}


def run(simulation, step=-1, path=None):
    """All frames of a run that is saved after a step and goes on, and the number of its steps, with those of
    settling.
    """
    frames = []
    count = 0

    def after_step():
        nonlocal count
        count += 1
        if count == step:
            write_snapshot(str(path), simulation.snapshot())

    simulation.run(lambda frame: frames.append(copy.deepcopy(frame)), None, after_step)
    return frames, count


def array_bytes(saved):
    """All values but seconds."""
    seconds = ("simulation/clock", "simulation/_settled")
    return {place: array.tobytes() for place, array in saved.items() if not place.startswith(seconds)}


def same_frames(frames, others):
    assert len(frames) == len(others)
    for one, other in zip(frames, others, strict=True):
        assert one.time == other.time
        assert one.pairs == other.pairs
        for group in ("particles", "surface", "series", "contact"):
            a, b = getattr(one, group), getattr(other, group)
            assert list(a) == list(b)
            for name in a:
                assert np.asarray(a[name]).tobytes() == np.asarray(b[name]).tobytes(), (group, name)


def stop_and_go_on(make, path, step):
    """The run of a simulation, and that of another which is loaded after a step of the first."""
    first = make()
    frames, steps = run(first, step, path)
    assert steps >= step
    second = make()
    second.restore(read_snapshot(str(path))[0])
    rest, left = run(second)
    assert left == steps - step
    same_frames(frames[len(frames) - len(rest) :], rest)
    assert array_bytes(first.snapshot()) == array_bytes(second.snapshot())
    assert first.remarks() == second.remarks()


#: Steps after which a run is saved: in settling, and after it; bodies touch before or after.
STEPS = {
    "colliding-rings": (2, 20),
    "rolling-cylinder-slip-rigid": (2, 10),  # eleven steps with some shapes
    "rolling-cylinder-no-slip-rigid": (2, 10),
}


#: Methods with which a run stops by itself.
STOP = {
    "contact-stress": {("hamad2017", "cubic_bspline")},
    "sliding-block": {("particles", "linear")},
}


def cases():
    """Yield every scene with its own methods, which the conformance kit asks one by one; in the long form
    with all."""
    for name in COARSE:
        scene = load_scene(name)
        own = [(scene.contact.method, scene.shape.method)]
        every = set(itertools.product(available("contact"), available("shape"))) - STOP.get(name, set())
        yield from ((name, *each) for each in (sorted(every) if "MPMFW_ALL_RESTARTS" in os.environ else own))


def test_every_shipped_scene_is_here():
    assert set(COARSE) == set(shipped_scenes())


@pytest.mark.parametrize(("name", "contact", "shape"), list(cases()))
def test_every_shipped_scene(tmp_path, name, contact, shape):
    chosen = {"contact.method": contact, "shape.method": shape}
    scene = load_scene(name, set=COARSE[name] | chosen)
    try:
        Simulation(scene)
    except SceneError as refused:
        assert "MPMFW_ALL_RESTARTS" in os.environ
        pytest.skip(str(refused))
    step = random.Random(name + contact + shape).randrange(*STEPS.get(name, (2, 15)))
    stop_and_go_on(lambda: Simulation(scene), tmp_path / "saved", step)


LAYER = {"contact__penalty__interface_thickness": 0.01}
PRESSED = {
    "bodies__left__sides": [{"side": "left", "pressure": 1e4}],
    "bodies__right__sides": [{"side": "right", "velocity": [-0.5, "free"]}],
}
WAYS = {
    "musl-apic": {"stepping__scheme": "musl", "stepping__transfer": "apic"},
    "usf-tpic": {"stepping__scheme": "usf", "stepping__transfer": "tpic"},
    "aflip": {"stepping__transfer": "aflip"},
    "exact": {"bodies__left__rotation": "exact", "bodies__right__rotation": "spin"},
    "layer": LAYER,
    "pressed": PRESSED,
    "damped": {"materials__soft__damping": {"bulk": 1e-4, "shear": 1e-4}},
    "averaged": {f"bodies__{name}__volumetric": "averaged" for name in ("left", "right")},
    "nearest": {"time__outputs": "nearest", "output__particle_interval": 0.004},
    "pairs": {
        "bodies__third": solid([-0.2, 0.251], [0.3, 0.751], 0.125, velocity=[0.0, -1.0]),
        "contact__pairs": {
            "left-third": {"method": "lcp"},
            "right-third": {"method": "penalty", "penalty": {"kappa": 2.0}},
        },
    },
}


@pytest.mark.parametrize("way", WAYS)
def test_every_way_of_stepping_loading_and_recording(tmp_path, way):
    recorded = {"output__ledger": way != "layer", "output__stability": True}
    scene = two_blocks("penalty", time__end=0.02, time__output_interval=0.002, **recorded, **WAYS[way])
    stop_and_go_on(lambda: Simulation(scene), tmp_path / "saved", 7)
