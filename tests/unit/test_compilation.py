"""What a run loads along with its kernels."""

from __future__ import annotations

import json
import subprocess
import sys

SCRIPT = """
import json, sys
import numba
import numpy as np
from mpmfw.runs.simulation import Simulation

simulation = Simulation("colliding-rings", contact="penalty")
simulation.advance(1)
loaded = "scipy.linalg" in sys.modules

@numba.njit
def product(a, b):
    return a @ b

a = np.arange(4.0).reshape(2, 2)
print(json.dumps([loaded, product(a, a).tolist(), "scipy.linalg" in sys.modules]))
"""


def test_a_step_loads_no_linear_algebra_which_kernels_can_still_call() -> None:
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True)
    before, product, after = json.loads(done.stdout)
    assert not before
    assert product == [[2.0, 3.0], [6.0, 11.0]]
    assert after
