"""The kit as a whole: imported lazily, every check with its property and bound, and the guide that lists them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from mpmfw_testing import checks_of


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


@pytest.mark.parametrize(("heading", "kind"), [("Contact laws", "contact"), ("Shape functions", "shape")])
def test_the_guide_lists_every_check_with_its_property(heading, kind):
    page = (Path(__file__).parents[2] / "docs" / "guide" / "conformance.md").read_text(encoding="utf-8")
    section = page.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([\w-]+)` \| (.*?[^\\]) \|", section, re.MULTILINE)
    assert rows == [(check.name, check.property.replace("|", "\\|")) for check in checks_of(kind)]
