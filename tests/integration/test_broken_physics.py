"""Physics broken in one line turns gates of the suite red: which, for each line, is written down here.

A copy of the plug-in package with that line changed takes the package's place in a process of its own, which
runs the reduced version of a case."""

import csv
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Fault:
    """One line of physics, broken; and gates that must turn red, as (method, quantity)."""

    file: str  #: from its package on
    line: str
    broken: str
    case: str
    red: tuple[tuple[str, str], ...]
    long: bool = False  #: whether the case takes more than a minute


CPDI = "penalty, cpdi"
CPDI2 = "penalty, cpdi2"
PENALTY, STAGE = "mpmfw_contact/penalty.py", "mpmfw/contact/springs.py"
SLIDING = "fitted acceleration, error"

FAULTS = {
    "reversed normal": Fault(
        PENALTY,
        "normal_force(k, depth, linear_to), ",
        "normal_force(k, gap, linear_to), ",
        "sliding-block",
        ((CPDI, "run"), (CPDI2, "run")),  # the block is pulled into the plane, and the run ends
        long=True,
    ),
    "friction halved": Fault(
        STAGE,
        "min(size, slip_limit(rows, c, own.normal[c] + own.pull[c]))",
        "min(size, 0.5 * slip_limit(rows, c, own.normal[c] + own.pull[c]))",
        "sliding-block",
        ((CPDI, SLIDING), (CPDI2, SLIDING)),
        long=True,
    ),
    "P dropped": Fault(
        "mpmfw/contact/surfaces/assembly.py",
        "write_gradients(corners, normal, g, gradient, spacing)",
        "write_gradients(corners, normal, 0.0, gradient, spacing)",
        "pair-force",
        (("", "l δξ − C_t, largest"), ("", "net moment of C_t"), ("", "net moment of the kernel's pairs")),
    ),
    "wrong surface map": Fault(
        "mpmfw/contact/surfaces/detection.py",
        "self.surface_map = self.options.map",
        'self.surface_map = "mass_weighted"',
        "contact-stress",
        ((CPDI, "mean σ_yy, error, at 0.37 h"), (CPDI, "largest departure, at 0.37 h")),
        long=True,
    ),
    # With an affine transfer MUSL keeps the rotation, and no gate sees it: the fault is MUSL with the
    # transfer that it came with.
    "MUSL for rotation": Fault(
        "mpmfw_shape/cpdi.py",
        '    name = "cpdi"\n',
        '    name = "cpdi"\n    auto_scheme = "musl"\n    auto_transfer = "flip"\n',
        "spinning-disc",
        (("cpdi", "angular momentum, change per turn"),),
    ),
}


IGNORED = shutil.ignore_patterns("__pycache__")


def source(fault):
    """Path of the file that is broken."""
    return ROOT / ("src" if fault.file.startswith("mpmfw/") else "plugins") / fault.file


def gates(fault, folder):
    """Verdicts of the gates that the broken package reaches, by (method, quantity)."""
    package = fault.file.partition("/")[0]
    shutil.copytree(source(fault).parents[fault.file.count("/") - 1], folder / package, ignore=IGNORED)
    path = folder / fault.file
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(fault.line, fault.broken), encoding="utf-8")
    command = "from mpmfw.cli import main; main()"
    options = ["--quick", "--suite", str(ROOT / "validation"), "-o", str(folder / "out"), "-j", "1"]
    done = subprocess.run(
        [sys.executable, "-c", command, "validate", fault.case, *options],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 1, done.stdout[-3000:] + done.stderr[-3000:]
    with (folder / "out" / "validation.csv").open(encoding="utf-8") as file:
        return {(row["method"], row["quantity"]): row["verdict"] for row in csv.DictReader(file)}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.long) if fault.long else name for name, fault in FAULTS.items()],
)
def test_broken_physics_turns_gates_red(name, tmp_path):
    fault = FAULTS[name]
    found = gates(fault, tmp_path)
    red = {gate for gate, verdict in found.items() if verdict == "RED"}
    assert set(fault.red) <= red, f"red: {sorted(red)}"


@pytest.mark.parametrize("name", FAULTS)
def test_every_line_that_is_broken_is_there_once(name):
    fault = FAULTS[name]
    assert source(fault).read_text(encoding="utf-8").count(fault.line) == 1
