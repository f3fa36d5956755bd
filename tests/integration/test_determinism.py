"""The same scene gives the same bits, whatever else runs in the process."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mpmfw
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import two_blocks

SCENES = {
    "penalty": two_blocks("penalty"),
    "bardenhagen": two_blocks("bardenhagen", shape__method="gimp"),
}


def digest(name: str) -> str:
    """Hash of every variable in the results of a scene."""
    tree, text = mpmfw.run(SCENES[name]), hashlib.sha256()
    for node in sorted(tree.subtree, key=lambda node: node.path):
        for variable in sorted(node.data_vars):
            text.update(f"{node.path}/{variable}".encode())
            text.update(np.ascontiguousarray(node[variable].values).tobytes())
    return text.hexdigest()


def test_a_run_repeats_bit_by_bit_in_one_process_and_in_another() -> None:
    here = Path(__file__).resolve().parent
    code = f"import sys; sys.path[:0] = {[str(here), str(here.parent)]}; import test_determinism as t; print(*map(t.digest, t.SCENES))"  # noqa: E501
    first = [digest(name) for name in SCENES]
    assert [digest(name) for name in SCENES] == first
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300
    )
    assert done.stdout.split() == first


def arrays(sim: Simulation) -> list[Any]:
    """Points, surface, and the plug-ins' own arrays."""
    p, surface = sim.state.particles, sim.state.surface
    own = [sim.state.arrays[name] for name in sorted(sim.state.arrays)]
    return [p.position, p.velocity, p.stress, p.deformation_gradient, surface.position, *own]


@pytest.mark.parametrize("first", SCENES)
@pytest.mark.parametrize("second", SCENES)
def test_simulations_side_by_side_share_nothing(first: str, second: str) -> None:
    alone = Simulation(SCENES[first])
    alone.advance(30)
    one, other = Simulation(SCENES[first]), Simulation(SCENES[second])
    for _ in range(30):
        one.advance(1)
        other.advance(1)
    for expected, found in zip(arrays(alone), arrays(one), strict=True):
        np.testing.assert_array_equal(found, expected)
