"""The disk cache of kernels: hits and misses, damage, several processes, and folders that are not used."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mpmfw.kernels import _jit, kernel

DEVICE = """
from mpmfw.kernels import device

@device
def weight(x):
    return {factor} * x
"""
#: What a kernel calls may be of another plug-in, and reach it through a third.
FILES = {
    "other_shape.py": DEVICE.format(factor=2.0),
    "between.py": "from mpmfw.kernels import kernel\nfrom other_shape import weight\n"
    "@kernel\ndef middle(x):\n    return weight(x)\n",
    "own_shape.py": "from mpmfw.kernels import kernel\nfrom between import middle\n"
    "@kernel\ndef fill(x):\n    return middle(x)\n",
}
SCRIPT = """
import json
from mpmfw.kernels.particle_grid import velocity_of_momentum
from own_shape import fill
import numpy as np

velocity_of_momentum(np.ones(3), np.ones((3, 2)), np.ones((3, 2)), (1.0, 1.0))
result = fill(1.0)
stats = [f.stats for f in (fill, velocity_of_momentum)]
print(json.dumps([result, *(sum(sum(getattr(s, "cache_" + n).values()) for s in stats) for n in ("hits", "misses"))]))
"""  # noqa: E501


def test_another_process_and_folder_compile_nothing_and_an_edit_is_noticed(tmp_path):
    """The result, hits and misses of two kernels in each process; the core's own is not compiled again."""
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
        for name, source in FILES.items():
            (folder / name).write_text(source)
    environment = {
        **os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1",
    }  # fmt: skip

    def found(folder):
        environment["PYTHONPATH"] = os.pathsep.join([str(folder), str(Path(_jit.__file__).parents[2])])
        command = [sys.executable, "-c", SCRIPT]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)

    assert [found(first), found(second)] == [[2.0, 0, 2], [2.0, 2, 0]]
    (second / "other_shape.py").write_text(DEVICE.format(factor=3.0))
    assert found(second)[:2] == [3.0, 1]


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


def test_key_holds_options_version_and_all_kernel_sources(folders, monkeypatch, tmp_path):
    seen = [folders()]
    monkeypatch.setitem(_jit.OPTIONS, "nogil", False)
    seen.append(folders())
    monkeypatch.setattr(_jit.numba, "__version__", "0")
    seen.append(folders())
    copy = tmp_path / "kernels"
    copy.mkdir()
    (copy / "_jit.py").touch()
    monkeypatch.setattr(_jit, "__file__", str(copy / "_jit.py"))
    for text in ("a = 1\n", "a = 2\n"):
        (copy / "small_matrix.py").write_text(text)
        seen.append(folders())
    assert folders() == seen[-1]
    assert len(set(seen)) == 5


def double(x):
    return x + x


@pytest.fixture
def compiled(tmp_path, monkeypatch):
    """A kernel that nobody has compiled yet, with a cache of its own."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return kernel(double)


def test_processes_that_compile_different_signatures_at_once_do_not_swap_code(compiled, monkeypatch):
    """numba reads the index, chooses a name, writes the index, writes the code: two processes take turns."""
    cache, codes = compiled._cache._cache_file, {"float": 1, "integer": 2}
    Path(cache._cache_path).mkdir()
    indices = {kind: cache._load_index() for kind in codes}
    for kind, process in codes.items():
        monkeypatch.setattr(os, "getpid", lambda process=process: process)
        indices[kind][kind] = cache._data_name(1)
        cache._save_index(indices[kind])
        cache._save_data(cache._data_name(1), f"code for {kind}")
    for kind, process in reversed(codes.items()):  # the code of the first arrives last
        monkeypatch.setattr(os, "getpid", lambda process=process: process)
        cache._save_data(cache._data_name(1), f"code for {kind}")
    for kind in codes:
        assert cache.load(kind) in (None, f"code for {kind}")


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_damaged_file_is_discarded_and_written_again(tmp_path, compiled, ending):
    compiled(np.arange(3.0))
    for file in tmp_path.rglob(f"*.{ending}"):
        whole = file.read_bytes()
        file.write_bytes(whole[:-200] + bytes([whole[-200] ^ 1]) + whole[-199:])
    for hits in (0, 1):
        again = kernel(double)
        np.testing.assert_array_equal(again(np.arange(3.0)), [0.0, 2.0, 4.0])
        assert sum(again.stats.cache_hits.values()) == hits


def test_a_disk_that_is_full_costs_the_cache_alone(compiled, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    np.testing.assert_array_equal(compiled(np.arange(3.0)), [0.0, 2.0, 4.0])


def test_a_cache_that_cannot_be_written_costs_itself_alone(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "cache"))
    np.testing.assert_array_equal(kernel(double)(np.arange(3.0)), [0.0, 2.0, 4.0])


@pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")
def test_a_folder_of_others_or_that_they_may_write_to_is_not_used(tmp_path, monkeypatch):
    open_to_all = tmp_path / "open"
    open_to_all.mkdir()
    open_to_all.chmod(0o777)
    for folder, said in (
        (open_to_all, "anybody may write"),
        (tmp_path / "theirs", "belongs to another user"),
    ):
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
        if folder is not open_to_all:
            monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
        with pytest.warns(UserWarning, match=said):
            files = kernel(double)._cache._cache_file
        assert not files._cache_path.startswith(str(folder))
    monkeypatch.undo()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "new"))
    kernel(double)
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o700
