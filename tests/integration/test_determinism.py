"""The same scene gives the same bits, whatever else runs in the process."""

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np

import mpmfw
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import two_blocks

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
    code = f"{paths}; import test_determinism as t; print(*t.digests())"
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
