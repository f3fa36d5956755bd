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

KERNEL = """
from mpmfw.kernels import kernel
from own_shape.weights import weight

@kernel
def fill(x):
    return weight(x)
"""

SCRIPT = """
import json
from mpmfw.kernels.nodal import velocity_of_momentum
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
def package(tmp_path):
    """A plug-in package whose kernel calls a device function of another file."""
    folder = tmp_path / "own_shape"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "weights.py").write_text(DEVICE.format(factor=2.0))
    (folder / "fill.py").write_text(KERNEL)
    return folder


def run(package, cache):
    """Call both kernels in a new process; return the result and the cache's hits and misses."""
    source = Path(_jit.__file__).parents[2]
    environment = {
        **os.environ,
        "NUMBA_CACHE_DIR": str(cache),
        "PYTHONPATH": os.pathsep.join([str(package.parent), str(source)]),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    out = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
    )
    return json.loads(out.stdout)


def test_second_process_compiles_nothing(package, tmp_path):
    first, second = (run(package, tmp_path / "cache") for _ in range(2))
    assert (first["hits"], first["misses"]) == (0, 2)
    assert (second["hits"], second["misses"]) == (2, 0)


def test_edit_of_an_imported_file_is_noticed(package, tmp_path):
    assert run(package, tmp_path / "cache")["result"] == 2.0
    (package / "weights.py").write_text(DEVICE.format(factor=3.0))
    after = run(package, tmp_path / "cache")
    assert after["result"] == 3.0
    assert after["hits"] == 1  # the core's own kernel is not compiled again


def test_edit_of_another_package_is_noticed(package, tmp_path):
    """What a kernel calls may be of another plug-in, and reach it through a third."""
    package.rename(tmp_path / "other_shape")
    for file in ("weights.py", "fill.py"):
        text = (tmp_path / "other_shape" / file).read_text()
        (tmp_path / "other_shape" / file).write_text(text.replace("own_shape", "other_shape"))
    (tmp_path / "between.py").write_text(
        "from mpmfw.kernels import kernel\nfrom other_shape import fill as theirs\n"
        "@kernel\ndef middle(x):\n    return theirs.fill(x)\n"
    )
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "fill.py").write_text(
        "from mpmfw.kernels import kernel\nfrom between import middle\n"
        "@kernel\ndef fill(x):\n    return middle(x)\n"
    )
    assert run(package, tmp_path / "cache")["result"] == 2.0
    (tmp_path / "other_shape" / "weights.py").write_text(DEVICE.format(factor=3.0))
    assert run(package, tmp_path / "cache")["result"] == 3.0


def test_cache_that_cannot_be_written(package, tmp_path):
    (tmp_path / "file").touch()
    blocked = run(package, tmp_path / "file" / "cache")
    assert blocked["result"] == 2.0
    assert not Path(blocked["path"]).exists()  # the temporary folder went with the process


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Make the cache folder's name anew, without what was remembered of the sources."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    forget = (_jit._hash_of, _jit._usable)

    def folder(module="mpmfw.kernels.nodal"):
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
