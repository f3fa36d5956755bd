"""The disk cache of kernels: hit by a second process, and missed after every edit that matters."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mpmfw.kernels import _jit

DEVICE = """
from mpmfw.kernels import device

@device
def weight(x):
    return {factor} * x
"""

#: What a kernel calls may be of another plug-in, and reach it through a third.
FILES = {
    "other_shape/__init__.py": "",
    "other_shape/weights.py": DEVICE.format(factor=2.0),
    "between.py": "from mpmfw.kernels import kernel\nfrom other_shape.weights import weight\n"
    "@kernel\ndef middle(x):\n    return weight(x)\n",
    "own_shape/__init__.py": "",
    "own_shape/fill.py": "from mpmfw.kernels import kernel\nfrom between import middle\n"
    "@kernel\ndef fill(x):\n    return middle(x)\n",
}

SCRIPT = """
import json
from mpmfw.kernels.particle_grid import velocity_of_momentum
from own_shape.fill import fill
import numpy as np

velocity_of_momentum(np.ones(3), np.ones((3, 2)), np.ones((3, 2)), (1.0, 1.0))
result = fill(1.0)
stats = [f.stats for f in (fill, velocity_of_momentum)]
print(json.dumps(dict(
    result=result, path=fill.stats.cache_path, hits=sum(sum(s.cache_hits.values()) for s in stats),
    misses=sum(sum(s.cache_misses.values()) for s in stats))))
"""


@pytest.fixture
def site(tmp_path):
    """A folder with these files."""
    for name, source in FILES.items():
        (tmp_path / "site" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "site" / name).write_text(source)
    return tmp_path / "site"


def run(site, cache):
    """Call both kernels in a new process; return the result and the cache's hits and misses."""
    source = Path(_jit.__file__).parents[2]
    environment = {
        **os.environ,
        "NUMBA_CACHE_DIR": str(cache),
        "PYTHONPATH": os.pathsep.join([str(site), str(source)]),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    out = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
    )
    return json.loads(out.stdout)


def test_a_second_process_compiles_nothing_and_an_edit_is_noticed(site, tmp_path):
    first, second = (run(site, tmp_path / "cache") for _ in range(2))
    assert (first["result"], first["hits"], first["misses"]) == (2.0, 0, 2)
    assert (second["hits"], second["misses"]) == (2, 0)
    (site / "other_shape" / "weights.py").write_text(DEVICE.format(factor=3.0))
    after = run(site, tmp_path / "cache")
    assert after["result"] == 3.0
    assert after["hits"] == 1  # the core's own kernel is not compiled again


def test_cache_that_cannot_be_written(site, tmp_path):
    (tmp_path / "file").touch()
    blocked = run(site, tmp_path / "file" / "cache")
    assert blocked["result"] == 2.0
    assert not Path(blocked["path"]).exists()  # the temporary folder went with the process


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Make the cache folder's name anew, without what was remembered of the sources."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    forget = (_jit._hash_of, _jit._usable)

    def folder(module="mpmfw.kernels.particle_grid"):
        for function in forget:
            function.cache_clear()
        return _jit.cache_folder(module)

    yield folder
    for function in forget:
        function.cache_clear()


def test_key_holds_options_and_version(folders, monkeypatch):
    before = folders()
    monkeypatch.setitem(_jit.OPTIONS, "nogil", False)
    without_option = folders()
    monkeypatch.setattr(_jit.numba, "__version__", "0")
    assert len({before, without_option, folders()}) == 3


def test_key_holds_all_kernel_sources(folders, monkeypatch, tmp_path):
    copy = tmp_path / "kernels"
    copy.mkdir()
    (copy / "_jit.py").touch()
    (copy / "small_matrix.py").write_text("a = 1\n")
    monkeypatch.setattr(_jit, "__file__", str(copy / "_jit.py"))
    before = folders()
    assert folders() == before
    (copy / "small_matrix.py").write_text("a = 2\n")
    edited = folders()
    (copy / "added.py").touch()
    assert len({before, edited, folders()}) == 3
