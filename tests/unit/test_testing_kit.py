"""The kit as a whole: imported lazily, every check with its property and bound, and the guide that names
them.
"""

from __future__ import annotations

import subprocess
import sys


def test_importing_the_kit_needs_neither_pytest_nor_hypothesis_nor_numba():
    code = (
        "import sys, mpmfw_testing\n"
        "print([m for m in ('pytest', 'hypothesis', 'numba', 'matplotlib') if m in sys.modules])\n"
        "sys.modules['hypothesis'] = None\n"
        "from mpmfw_testing import ladder\n"
        "try: ladder(0.0, 1.0, 2)\n"
        "except Exception as error: print(type(error).__name__, error)\n"
        "sys.modules['pytest'] = None\n"
        "from mpmfw_testing import contact_conformance\n"
        "try: contact_conformance('penalty')\n"
        "except Exception as error: print(type(error).__name__, error)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert lines[0] == "[]"
    assert all(line.startswith("SceneError") and "mpmfw[testing]" in line for line in lines[1:])
    assert len(lines) == 3
