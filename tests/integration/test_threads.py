"""Several threads of a run give the same bits as one, and one thread loads nothing of them."""

import gc
import hashlib
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from test_restart import array_bytes
from test_resume import same_results, stopped

import mpmfw
from mpmfw.errors import ResultsWarning, SceneError, SimulationError
from mpmfw.plugin.discovery import available
from mpmfw.runs.limits import cores
from mpmfw.runs.run import resume
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_shape.linear import Linear
from scenes_for_tests import ball_on_a_box, box, disc, one_body, two_blocks, with_changes

pytestmark = pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")  # more threads than cores

SHAPES = list(available("shape"))
NUMBERS = (2, 3, 5)
STEPS = 20


def bits(scene, threads, **methods):
    """All values that a simulation keeps after some steps."""
    simulation = Simulation(scene, threads=threads, **methods)
    simulation.advance(STEPS)
    return array_bytes(simulation.snapshot())


def check_same(scene, numbers=NUMBERS, **methods):
    one = bits(scene, 1, **methods)
    for threads in numbers:
        shared = bits(scene, threads, **methods)
        assert list(shared) == list(one)
        assert [name for name in one if one[name] != shared[name]] == [], threads


# -- the same bits


@pytest.mark.parametrize(
    ("contact", "shape"),
    [
        *((contact, "cpdi") for contact in available("contact")),
        *(("penalty", shape) for shape in SHAPES if shape != "cpdi"),
    ],
)
def test_every_contact_and_every_shape(contact, shape):
    check_same(two_blocks("none", shape__method=shape), (3,), contact=contact)


@pytest.mark.parametrize("contact", ["penalty", "bardenhagen"])
def test_every_number(contact):
    check_same(two_blocks(contact, output__ledger=True))


@pytest.mark.parametrize(
    ("contact", "shape"), [("bardenhagen", "linear"), ("penalty", "cpdi"), ("penalty", "bspline")]
)
def test_in_space(shape, contact):
    check_same(with_changes(ball_on_a_box(), shape__method=shape), (3,), contact=contact)


@pytest.mark.parametrize(
    ("scheme", "transfer"),
    [*(("usl", each) for each in ("pic", "apic", "tpic", "aflip")), ("musl", "flip"), ("usf", "aflip")],
)
def test_every_scheme_and_transfer(scheme, transfer):
    check_same(disc(stepping={"scheme": scheme, "transfer": transfer}), (3,))


ELASTIC = {"model": "linear_elastic", "density": 1000.0, "bulk_modulus": 1e6, "shear_modulus": 4e5}


@pytest.mark.parametrize(
    "changes",
    [
        *({f"bodies__{name}__rotation": how for name in ("left", "right")} for how in ("exact", "lumped")),
        {f"bodies__{name}__volumetric": "averaged" for name in ("left", "right")},
        {"materials": {"soft": ELASTIC}},
        {"materials": {"soft": {**ELASTIC, "model": "j2", "yield_stress": 1e4}}},
    ],
    ids=["exact", "lumped", "averaged", "elastic", "plastic"],
)
def test_every_rotation_mean_and_material(changes):
    check_same(two_blocks("penalty", **changes), (3,))


def test_more_threads_than_points():
    scene = one_body({"type": "rectangle", "lower": [0.0, 0.0], "upper": [0.5, 0.25]}, size=0.25)
    assert Simulation(scene).state.particles.count == 2
    for shape in SHAPES:
        check_same(with_changes(scene, shape__method=shape), (5,))


def test_a_table_that_grows():
    """Rows lengthen all at once, past what the parts and the whole table have room for."""
    check_same(box(shape__method="cpdi", bodies__solid__velocity=[3.0, 2.0, 1.0]), (2, 3))


def test_a_shape_whose_rows_do_not_ascend():
    """Of a stranger's shape function, whose nodes come in any order, one thread projects alone."""

    class Backwards(Linear):
        name = "backwards"
        rows_ascend = False

        @mpmfw.api.hookimpl
        def interpolate(self, particles, grid):
            """The rows of ``linear`` from their last entry to the first."""
            table = super().interpolate(particles, grid)
            n = len(table.row) - 1
            arrays = table.kernel_arrays[1:]
            turned = [array.reshape(n, 4, -1)[:, ::-1].reshape(array.shape).copy() for array in arrays]
            return mpmfw.api.Stencil(table.row, *turned)

    check_same(disc(), (2, 3), shape=Backwards)


# -- results, checkpoints, errors


def test_a_run_goes_on_with_another_number_and_ends_with_the_same_file(tmp_path):
    scene = two_blocks("penalty", time__end=0.02, time__output_interval=0.001, output__ledger=True)
    mpmfw.run(scene, output=tmp_path / "whole.nc")
    stopped(scene, tmp_path / "run.nc", 40, threads=3)
    resume(tmp_path / "run.nc", threads=2)
    same_results(tmp_path / "run.nc", tmp_path / "whole.nc")


def test_errors_name_the_same_point():
    """A point that leaves the grid, and one that inverts, in whichever part they are."""
    for changes in ({"bodies__solid__velocity": [200.0, 30.0]}, {"time__step": 0.02, "allow_unstable": True}):
        scene = disc(time__end=1.0, bodies__solid__angular_velocity=40.0, **changes)
        said = set()
        for threads in (1, 2, 3):
            with pytest.raises(SimulationError) as error:
                mpmfw.run(scene, threads=threads)
            said.add(str(error.value))
        assert len(said) == 1


# -- the request


@pytest.mark.parametrize("wrong", [0, "two", 1.5, True])
def test_what_is_no_number_of_threads(wrong):
    with pytest.raises(SceneError, match=r"threads.*expected an integer"):
        load_scene(two_blocks("penalty", threads=wrong))
    with pytest.raises(SceneError, match=r"threads: found .*; expected an integer of at least 1"):
        mpmfw.run(two_blocks("penalty"), threads=wrong)


@pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")
def test_more_than_there_are_cores_is_a_remark():
    scene = two_blocks("penalty", time__end=1e-3, time__output_interval=1e-3)
    with pytest.warns(ResultsWarning, match=f"threads: {cores() + 1} are more than the {cores()} cores"):
        mpmfw.run(scene, set={"threads": cores() + 1})


@pytest.fixture
def begun(monkeypatch):
    """Threads of every simulation that is built."""
    found = []
    init = Simulation.__init__

    def counted(self, *given, **named):
        init(self, *given, **named)
        found.append(self.threads)

    monkeypatch.setattr(Simulation, "__init__", counted)
    return found


def test_campaigns_have_one_thread_and_comparisons_those_of_the_scene(begun):
    scene = two_blocks("penalty", time__end=2e-3, time__output_interval=1e-3, threads=2)
    mpmfw.campaign(scene, {"kappa": [1.0, 2.0]}, repeats=1)
    assert set(begun) == {1}
    begun.clear()
    dataset = mpmfw.compare(scene, ["penalty"], ["cpdi"], repeats=1)
    assert 2 in begun
    assert dataset.attrs["timing"] != "exclusive"


# -- what it leaves


def workers():
    return {thread for thread in threading.enumerate() if thread.name == "mpmfw"}


def test_threads_end_with_the_simulation():
    before = workers()
    simulation = Simulation(two_blocks("penalty"), threads=3)
    simulation.advance(1)
    own = workers() - before
    assert len(own) == 2
    del simulation
    gc.collect()
    for thread in own:
        thread.join(10.0)
    assert not workers() & own


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no processes are forked here")
def test_a_forked_process_starts_threads_of_its_own():
    code = """
import os
from scenes_for_tests import two_blocks
from mpmfw.runs.simulation import Simulation
simulation = Simulation(two_blocks("penalty"), threads=2)
simulation.advance(2)
child = os.fork()
simulation.advance(2)
if child:
    assert os.waitpid(child, 0)[1] == 0
    print("both")
os._exit(0)
"""
    command = [sys.executable, "-W", "ignore", "-c", code]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[1])}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True, timeout=300)
    assert done.stdout == "both\n"


SCENES = [two_blocks("penalty"), two_blocks("bardenhagen", shape__method="gimp")]


def digests():
    """Hashes of every variable in the results of both scenes."""
    found = []
    for scene in SCENES:
        tree, text = mpmfw.run(scene), hashlib.sha256()
        for node in sorted(tree.subtree, key=lambda node: node.path):
            for variable in sorted(node.data_vars):
                text.update(f"{node.path}/{variable}".encode())
                text.update(np.ascontiguousarray(node[variable].values).tobytes())
        found.append(text.hexdigest())
    return found


def test_a_run_repeats_bit_by_bit_in_one_process_and_in_another():
    here = Path(__file__).resolve().parent
    paths = f"import sys; sys.path[:0] = {[str(here), str(here.parent)]}"
    code = f"{paths}; import test_threads as t; print(*t.digests())"
    first = digests()
    assert digests() == first
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == first


def arrays(simulation):
    """Points, surface, and the plug-ins' own arrays."""
    p, state = simulation.state.particles, simulation.state
    own = [state.arrays[name] for name in sorted(state.arrays)]
    return [p.position, p.velocity, p.stress, p.deformation_gradient, state.surface.position, *own]


def test_simulations_side_by_side_share_nothing():
    alone, beside = ([Simulation(scene) for scene in (*SCENES, SCENES[0])] for _ in range(2))
    for simulation in alone:
        simulation.advance(30)
    for _ in range(30):
        for simulation in beside:
            simulation.advance(1)
    for one, other in zip(alone, beside, strict=True):
        for expected, found in zip(arrays(one), arrays(other), strict=True):
            np.testing.assert_array_equal(found, expected)
