"""A thousand mutated scenes: none ends in a traceback, hangs, is "ok" with NaN, runs code or touches other
files.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import pytest
from mutants import mutant
from seeds import seeds
from trial import attempt

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.scene import load_scene

MUTANTS = 1000
KERNELS = os.environ.get("NUMBA_CACHE_DIR", f"{os.sep}kernels{os.sep}")
AT_A_TIME = 100

#: Files that were opened to be written, and processes and connections that were begun, while a test watches.
_SEEN: list[str] | None = None


def _audit(event: str, arguments: tuple[Any, ...]) -> None:
    """Remember what a scene must never cause. Python cannot take an audit hook off again."""
    if _SEEN is None:
        return
    if event == "exec":
        place = str(getattr(arguments[0], "co_filename", ""))
        if place.startswith(os.getcwd()) or Path(place).stem in ("pwned", "antigravity"):
            _SEEN.append(f"import {Path(place).stem}")
    elif event == "open" and isinstance(arguments[0], str):
        writes = isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        if writes or arguments[0].endswith("passwd") or "pwned" in arguments[0]:
            _SEEN.append(f"open {arguments[0]}")
    elif event in (
        "subprocess.Popen",
        "os.system",
        "os.exec",
        "os.fork",
        "socket.connect",
        "os.remove",
        "os.chdir",
    ):
        _SEEN.append(event)


sys.addaudithook(_audit)


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize("name", [name for name, _ in seeds()])
def test_the_seeds_run(name, tmp_path):
    path = tmp_path / "seed.toml"
    path.write_text(dict(seeds())[name])
    assert mpmfw.run(load_scene(path)).attrs["status"] == "ok"


@pytest.mark.parametrize("first", range(0, MUTANTS, AT_A_TIME))
def test_no_mutant_does_harm(first, tmp_path, monkeypatch):
    global _SEEN
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pwned.py").write_text("X = 1\n")
    wrong, ends = [], set()
    for number in range(first, first + AT_A_TIME):
        folder = tmp_path / str(number)
        folder.mkdir()
        _SEEN = []
        try:
            trial = attempt(mutant(number), folder, memory=number % 20 == 0)
            # The cache of kernels is the one thing that is written beside the scene's own folder
            seen = [entry for entry in _SEEN if KERNELS not in entry and "mutant.toml" not in entry]
        finally:
            _SEEN = None
        ends.add(trial.outcome)
        if trial.outcome == "wrong" or seen:
            wrong.append(f"mutant {number}: {trial.said} {seen}")
    assert not wrong, "\n".join(wrong)
    assert {"ok", "refused"} <= ends


def test_the_watch_sees_an_import(tmp_path, monkeypatch):
    global _SEEN
    (tmp_path / "pwned.py").write_text("X = 1\n")
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "seed.toml"
    path.write_text(dict(seeds())["one"].replace('"neo_hookean"', '"pwned:X"'))
    for trust, seen in ((False, []), (True, ["import pwned"])):
        _SEEN = []
        with pytest.raises(SceneError):
            load_scene(path, trust=trust)
        _SEEN, found = None, _SEEN
        assert [entry for entry in found if entry.startswith("import")] == seen
    sys.modules.pop("pwned", None)


@pytest.mark.parametrize("path", ["../secret.msh", "/etc/passwd", "a/../../secret.msh", "link.msh"])
def test_a_scene_s_file_names_no_file_outside_its_folder(path, tmp_path, monkeypatch):
    folder = tmp_path / "given"
    folder.mkdir()
    (tmp_path / "secret.msh").write_text("a secret")
    (folder / "link.msh").symlink_to(tmp_path / "secret.msh")
    monkeypatch.chdir(folder)
    text = dict(seeds())["plate"]
    geometry = next(line for line in text.splitlines() if line.startswith("geometry"))
    scene = folder / "s.toml"
    scene.write_text(text.replace(geometry, f'geometry = {{ type = "mesh", path = "{path}" }}'))
    with pytest.raises(
        SceneError, match=r"the file is neither in the scene's folder, .*, nor in the working folder"
    ):
        load_scene(scene)
    with pytest.raises(SceneError, match=r"not found|is not a gmsh mesh"):
        load_scene(scene, set={"bodies.plate.geometry.path": str(Path(path).absolute())})
