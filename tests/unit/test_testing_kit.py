"""The kit as a whole: imported lazily, every check with its property and bound, and the guide that names
them.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from mpmfw_testing import checks_of
from mpmfw_testing.parametrised import CHECKED


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


@pytest.mark.parametrize("kind", ["contact", "shape"])
def test_every_check_says_what_holds_and_states_its_bound(kind):
    names = [check.name for check in checks_of(kind)]
    assert len(set(names)) == len(names)
    for check in checks_of(kind):
        assert check.property.endswith(".")
        assert check.name == check.name.lower().replace(" ", "-")
        assert len(check.run.__doc__ or "") > 40


@pytest.mark.parametrize("kind", CHECKED)
def test_the_guide_names_every_check(kind):
    page = (Path(__file__).parents[2] / "docs" / "guide" / "conformance.md").read_text(encoding="utf-8")
    row_of = "contact" if kind in ("detection", "law") else kind
    (names,) = re.findall(rf"^\| `{row_of}` \| .* \| (.*) \|$", page, re.MULTILINE)
    assert re.findall(r"`([\w-]+)`", names) == [check.name for check in checks_of(kind)]
