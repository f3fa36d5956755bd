"""From ``run(scene)`` to the first step each module hands on to the next: next to nothing climbs back."""

from __future__ import annotations

import sys
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import mpmfw
from mpmfw.runs.run import run
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.step import SCHEMES

ROOT = Path(mpmfw.__file__).parent
#: What builds, plans and runs. The rest holds data and errors, or is entered whole (scene, geometry, results), or is what a
#: plug-in offers to all of these (its base classes).
ROOMS = {
    str(ROOT / name): name
    for name in (
        *(
            f"runs/{name}.py"
            for name in (
                *("run", "restart", "simulation", "build", "bodies", "plan", "recording", "frames"),
                "initial_motion",
            )
        ),
        *("plugin/setup.py", "plugin/hooks.py", "state/windows.py", "runs/timestep.py"),
        "contact/planning.py",
        *(path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "effects").glob("*.py"))),
    )
}


class Walk:
    """The rooms in the order in which a run enters them, and the calls from a later one to an earlier one."""

    def __init__(self) -> None:
        self.entered: list[str] = []
        self.returns: list[str] = []

    @staticmethod
    def room(frame: FrameType) -> str:
        return ROOMS.get(frame.f_code.co_filename, "")

    def __call__(self, frame: FrameType, event: str, _: Any) -> None:
        room, name = self.room(frame), frame.f_code.co_name
        if not room or event != "call" or name.startswith("<") or name[0].isupper():
            return
        if room not in self.entered:
            self.entered.append(room)
            return
        caller: FrameType | None = frame.f_back
        while caller is not None and not self.room(caller):
            caller = caller.f_back
        if caller is None or self.room(caller) not in self.entered:
            return
        if self.entered.index(self.room(caller)) > self.entered.index(room):
            self.returns.append(f"{self.room(caller)} {caller.f_code.co_name} -> {room} {name}")


class FirstStep(BaseException):
    """The walk is over."""


def test_the_walk_to_the_first_step_is_straight(monkeypatch: pytest.MonkeyPatch) -> None:
    """31 calls climbed back, where effects were planned away from their modules. What is left: settling steps its simulation."""

    def begin(*_: Any) -> float:
        raise FirstStep

    for scheme in SCHEMES:
        monkeypatch.setitem(SCHEMES, scheme, begin)
    scene = load_scene(
        "rolling-cylinder-slip",
        set={"grid.cell_size": 0.8, "output.ledger": True, "output.stability": True},
    )
    Simulation(scene)  # compiles what is needed so far
    walk = Walk()
    sys.setprofile(walk)
    try:
        with pytest.raises(FirstStep):
            run(scene)
    finally:
        sys.setprofile(None)
    assert len(walk.entered) > 15
    assert len(walk.returns) <= 5, walk.returns
