"""A plug-in outside this repository is checked by mypy against the installed package."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PLUGIN = """
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.api import (
    CONTACT_SERIES, AnyArray, ContactStrategy, Field, FloatArray, Grid, Length, Setup, State, hookimpl
)
from mpmfw.kernels import Float, Floats, Ints, device, kernel, scratch, segment_coordinate


class LawOptions(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
    reach: Length = 1.0
    law: Literal["soft", "hard"] = "soft"


@device
def foot(x: Float, y: Float, m: int, position: Floats, facets: Ints) -> Float:
    a, b = facets[m, 0], facets[m, 1]
    xi, _, _, _, _ = segment_coordinate(x, y, position[a, 0], position[a, 1], position[b, 0], position[b, 1])
    return xi


@kernel
def feet(position: Floats, facets: Ints, out: Floats) -> None:
    for s in range(len(out)):
        out[s] = foot(position[s, 0], position[s, 1], s, position, facets)


class Law(ContactStrategy):
    name = "law"
    Options = LawOptions
    options: LawOptions
    needs_surface = True

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return list(CONTACT_SERIES)

    @hookimpl
    def setup(self, setup: Setup) -> None:
        self.friction: FloatArray = np.array([pair.friction for pair in setup.pairs])

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State, dt: float) -> None:
        if state.surface is not None:
            out = np.zeros(state.surface.count)
            feet(state.surface.position, state.surface.facets, out)
        grid.force += self.options.reach * dt

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        return {"contact_force": np.zeros((len(state.pairs), state.grid.dim))}
"""


def type_check(source: str, folder: Path) -> tuple[int, str]:
    """Exit status and report of mypy on a plug-in outside this repository."""
    pytest.importorskip("mypy", reason="mypy comes with mpmfw[dev]")
    (folder / "law.py").write_text(source, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "law.py"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_a_typed_plugin_passes_mypy_and_a_wrong_one_does_not(tmp_path):
    assert type_check(PLUGIN, tmp_path) == (0, "Success: no issues found in 1 source file\n")
    wrong = PLUGIN.replace("state.surface.count", "state.surface.cuont")
    status, report = type_check(wrong, tmp_path)
    assert status == 1
    assert '"Surface" has no attribute "cuont"' in report
