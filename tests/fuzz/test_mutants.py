"""Mutated scenes: none ends in a traceback, hangs, is "ok" with NaN, runs code or touches other files."""

import os
import sys
import time
import tracemalloc
import warnings
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from mutants import mutant
from seeds import SEEDS, seeds

import mpmfw
from mpmfw.errors import MpmfwError, ResultsWarning, SceneError
from mpmfw.results import Frame
from mpmfw.runs import limits
from mpmfw.runs.limits import check_length
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import with_changes

#: How many, and the first: ``MPMFW_MUTANTS=100000`` is the long form.
MUTANTS, FIRST = int(os.environ.get("MPMFW_MUTANTS", "700")), int(os.environ.get("MPMFW_FIRST", "0"))
AT_A_TIME = 100
KERNELS = os.environ.get("NUMBA_CACHE_DIR", f"{os.sep}kernels{os.sep}")
#: Memory that a mutant may have, and what a run takes whatever its scene [bytes].
MEMORY, BESIDE = 3e7, 2e7
HANGS = 60.0  #: seconds
STEPS = 3
#: Arrays that may hold NaN: no step before the first frame, no contact that ended.
MAY_BE_NAN = {"time_step", "steps_per_contact", "penetration"}

#: Files that were opened to be written, and processes and connections that were begun, while a test watches.
_SEEN = None
_BEGINS = ("subprocess.Popen", "os.system", "os.exec", "os.fork", "socket.connect", "os.remove", "os.chdir")


def _audit(event, arguments):
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
    elif event in _BEGINS:
        _SEEN.append(event)


sys.addaudithook(_audit)


def steps(scene):
    """Take three steps; names of arrays that are not finite."""
    simulation, frames = Simulation(scene), list[Frame]()
    check_length(simulation)
    simulation.advance(STEPS, frames.append)
    arrays = [item for f in frames for group in (f.particles, f.surface, f.series) for item in group.items()]
    return sorted({name for name, a in arrays if not np.isfinite(a).all() and name not in MAY_BE_NAN})


def attempt(path, *, memory):
    """Load, build and step a scene: ``ok``, ``refused`` or ``failed``; anything else is an error.

    ``memory`` measures what it allocates, at twice the time."""
    begin, said = time.perf_counter(), ""
    try:
        with warnings.catch_warnings(), mock.patch.object(limits, "_memory_limits", return_value=[MEMORY]):
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", category=UserWarning, module="mpmfw")
            warnings.filterwarnings("ignore", category=ResultsWarning)
            scene = load_scene(path)
            if memory:
                tracemalloc.start()
            bad = steps(scene)
            peak = tracemalloc.get_traced_memory()[1] if memory else 0.0
        assert not bad, f"ok, with values that are not finite in {bad}"
        assert peak <= limits.most_memory(scene) + BESIDE, f"took {peak:.3g} bytes"
        outcome = "ok"
    except SceneError as error:
        outcome, said = "refused", str(error)
    except MpmfwError as error:
        outcome, said = "failed", str(error)
    finally:
        tracemalloc.stop()
    assert "\0" not in said
    assert len(said) < 5000
    assert time.perf_counter() - begin < HANGS
    return outcome


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize("name", [name for name, _ in seeds()])
def test_the_seeds_run(name, tmp_path):
    path = tmp_path / "seed.toml"
    path.write_text(dict(seeds())[name])
    assert mpmfw.run(load_scene(path)).attrs["status"] == "ok"


@pytest.mark.parametrize("first", range(FIRST, FIRST + MUTANTS, AT_A_TIME))
def test_no_mutant_does_harm(first, tmp_path, monkeypatch):
    global _SEEN
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pwned.py").write_text("X = 1\n")
    wrong, ends = [], set()
    for number in range(first, first + AT_A_TIME):
        path = tmp_path / str(number) / "mutant.toml"
        path.parent.mkdir()
        path.write_text(mutant(number), encoding="utf-8", newline="")
        _SEEN = []
        try:
            ends.add(attempt(path, memory=number % 20 == 0))
        except BaseException as error:
            wrong.append(f"mutant {number}: {error!r}\n{mutant(number)}")
        finally:
            _SEEN, seen = None, _SEEN
        # The cache of kernels is the one thing that is written beside the scene's own folder
        seen = [entry for entry in seen if KERNELS not in entry and "mutant.toml" not in entry]
        seen += [f"wrote {entry.name}" for entry in path.parent.iterdir() if entry != path]
        wrong += [f"mutant {number}: {seen}"] * bool(seen)
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
    scene = folder / "s.toml"
    mesh = {"type": "mesh", "path": path}
    scene.write_text(toml_text(with_changes(SEEDS["plate"], bodies__solid__geometry=mesh)))
    with pytest.raises(SceneError, match=r"neither in the scene's folder, .*, nor in the working folder"):
        load_scene(scene)
    with pytest.raises(SceneError, match=r"not found|is not a gmsh mesh"):
        load_scene(scene, set={"bodies.solid.geometry.path": str(Path(path).absolute())})
