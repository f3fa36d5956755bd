"""Compilation of kernels: one set of options, and a disk cache that notices every edit.

numba's cache misses an edit in a file that the kernel's file imports, and options such as ``nogil``. The
cache folder is therefore named by a hash of the options and of all sources that a kernel can be made of:
those of ``mpmfw.kernels``, of the kernel's own package, and of other packages whose kernels its module has
imported. Environments with the same sources share it. (A number that is imported by value from another
package is not seen.)"""

from __future__ import annotations

import atexit
import contextlib
import functools
import gc
import hashlib
import importlib
import os
import pickle
import shutil
import sys
import tempfile
import uuid
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

import numba
import platformdirs
from numba.core import caching, config, types
from numba.extending import intrinsic as numba_intrinsic

Params = ParamSpec("Params")
Result = TypeVar("Result")

#: ``fastmath`` stays off (results are bitwise repeatable); division by zero gives inf, as in NumPy.
OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False, "boundscheck": False}

# numba's annotations differ between versions.
_njit: Any = numba.njit
_config: Any = config
_intrinsic: Any = numba_intrinsic
_types: Any = types
_CacheFile: Any = caching.IndexDataCacheFile


#: Of every module with kernels, the sources beside ``mpmfw.kernels`` that they are made of: folders, and lone
#: files.
_sources: dict[str, set[Path]] = {}


@functools.cache
def _hash_of(source: Path) -> str:
    """Hash of a file, or of every Python file below a folder, names and contents."""
    digest = hashlib.sha256()
    for file in sorted(source.rglob("*.py")) if source.is_dir() else [source]:
        digest.update(file.relative_to(source.parent).as_posix().encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()


def _own_sources(module: str) -> Path | None:
    """Folder of the sources that ``module`` may build its kernels of, or its lone file; None without one.

    It is the plug-in's whole package, and within ``mpmfw`` the module's own folder."""
    top = module.partition(".")[0]
    file = getattr(sys.modules.get(module if top == "mpmfw" else top), "__file__", None)
    if file is None or not Path(file).is_file():
        return None
    return Path(file).parent if top == "mpmfw" or Path(file).name == "__init__.py" else Path(file)


def _note_sources(function: Callable[..., Any]) -> None:
    """Add to the sources of the module of ``function`` those of all kernels that it has imported by now."""
    own = _own_sources(function.__module__)
    known = _sources.setdefault(function.__module__, set() if own is None else {own})
    for value in function.__globals__.values():
        kernel_or_module = getattr(value, "py_func", value)
        name = "__name__" if isinstance(value, ModuleType) else "__module__"
        known |= _sources.get(getattr(kernel_or_module, name, ""), set())


@functools.cache
def _temporary_root() -> Path:
    """A folder of this process alone, where none that lasts can be written."""
    root = Path(tempfile.mkdtemp(prefix="mpmfw-kernels-"))
    atexit.register(shutil.rmtree, root, ignore_errors=True)
    return root


@functools.cache
def _usable(root: Path) -> bool:
    """Return whether files can be made in ``root``, and by this user alone; it is made if need be.

    Compiled code is unpickled from there: whoever may write to the folder may run code as its user.
    """
    try:
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder = root.stat()
        with tempfile.TemporaryFile(dir=root):
            pass
    except OSError:
        return False
    if os.name == "nt" or (folder.st_uid == os.getuid() and not folder.st_mode & 0o002):
        return True
    warnings.warn(
        f"kernels are compiled again in each process: {root} belongs to another user, or anybody may write "
        "to it; make it yours alone, or set NUMBA_CACHE_DIR to a folder that is",
        stacklevel=2,
    )
    return False


def cache_folder(module: str) -> Path:
    """Folder of the compiled kernels of ``module``; ``NUMBA_CACHE_DIR``, if set, is its parent.

    It is a temporary one where that cannot be written, or not by this user alone."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    root = Path(given) if given else platformdirs.user_cache_path("mpmfw") / "kernels"
    if not _usable(root):
        root = _temporary_root()
    hashes = [_hash_of(source) for source in (Path(__file__).parent, *sorted(_sources.get(module, ())))]
    key = hashlib.sha256(repr((hashes, OPTIONS, numba.__version__)).encode()).hexdigest()
    return root / key[:16]


@functools.cache
def _token(process: int) -> str:  # noqa: ARG001
    """A name that no other process has, nor one forked from this."""
    return uuid.uuid4().hex[:12]


class _KernelFiles(_CacheFile):  # type: ignore[misc]
    """The files of one kernel in the cache; a damaged one counts as absent, and is written anew.

    numba numbers files of code by its index: two processes that compile different signatures at the same time
    take one number, and later ones load the wrong code. Here names have a part that no other process has."""

    def _data_name(self, number: int) -> str:
        return f"{self._index_name.removesuffix('.nbi')}.{number}-{_token(os.getpid())}.nbc"

    def _dump(self, content: Any) -> bytes:
        pickled: bytes = super()._dump(content)
        return pickled + hashlib.sha256(pickled).digest()  # what reads a pickle stops at its end

    def _load_index(self) -> Any:
        whole = self._is_whole(self._index_path, pickle.dumps(self._version, -1))
        return super()._load_index() if whole else {}

    def _load_data(self, name: str) -> Any:
        if not self._is_whole(self._data_path(name)):
            raise OSError(f"{name} is damaged")  # numba compiles the kernel then
        return super()._load_data(name)

    def save(self, key: Any, content: Any) -> None:
        """Save an entry; a full disk does not fail the run, since the kernel is compiled."""
        with contextlib.suppress(OSError):
            Path(self._cache_path).mkdir(exist_ok=True)
            super().save(key, content)

    @staticmethod
    def _is_whole(path: str, head: bytes = b"") -> bool:
        """Return whether a file begins with ``head`` and ends with the digest of what is between."""
        try:
            content = Path(path).read_bytes()
        except OSError:
            return False
        return content.startswith(head) and hashlib.sha256(content[len(head) : -32]).digest() == content[-32:]


def kernel(function: Callable[Params, Result]) -> Callable[Params, Result]:
    """Compile ``function`` with numba at its first call, kept on disk between processes."""
    _note_sources(function)
    folder, previous = cache_folder(function.__module__), _config.CACHE_DIR
    _config.CACHE_DIR = str(folder)
    try:
        compiled: Callable[Params, Result] = _njit(cache=True, no_cfunc_wrapper=True, **OPTIONS)(function)
    finally:
        _config.CACHE_DIR = previous
    cache: Any = getattr(compiled, "_cache", None)  # none where compilation is disabled
    if cache is not None:
        files = cache._cache_file
        stem = files._index_name.removesuffix(".nbi")
        place: tuple[str, Any] = files._cache_path, files._source_stamp
        if _own_sources(function.__module__) is not None:  # the folder's name holds them: no path counts
            place = str(folder / function.__module__), None
        cache._cache_file = _KernelFiles(place[0], stem, place[1])
        _leave_garbage(compiled)
    return compiled


def _leave_garbage(compiled: Any) -> None:
    """Let no garbage be collected during compilation, a fifth of whose time that takes."""
    compile_for_args = compiled._compile_for_args

    def without_collection(*arguments: Any, **keywords: Any) -> Any:
        if not gc.isenabled():  # in another thread, or by the user
            return compile_for_args(*arguments, **keywords)
        gc.disable()
        try:
            return compile_for_args(*arguments, **keywords)
        finally:
            gc.enable()

    compiled._compile_for_args = without_collection


def device(function: Callable[Params, Result]) -> Callable[Params, Result]:
    """Compile ``function`` to be called from kernels: compiled into its callers, without a cache entry."""
    _note_sources(function)
    compiled: Callable[Params, Result] = _njit(
        forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, **OPTIONS
    )(function)
    if hasattr(compiled, "py_func"):  # not where compilation is disabled
        _leave_python_out(compiled)
        _take_integers_alike(compiled)
    return compiled


def _leave_python_out(compiled: Any) -> None:
    """Let a call from Python compile the device once more, for Python.

    To unpack every array of every struct for Python takes a quarter of the time of compilation."""

    @functools.cache
    def twin() -> Any:
        return _njit(forceinline=True, **OPTIONS)(compiled.py_func)

    compiled._insert = lambda *_, **__: None  # what Python finds
    compiled._compile_for_args = lambda *_, **__: twin()  # and what numba calls where it finds nothing


def _take_integers_alike(compiled: Any) -> None:
    """Compile once for all integers, not again for each literal number and for short ones."""
    template_for = compiled.get_call_template

    def widened(kind: Any) -> Any:
        alike = isinstance(kind, _types.IntegerLiteral) or kind == _types.int32
        return _types.int64 if alike else kind

    def get_call_template(args: Any, kws: Any) -> Any:
        return template_for(tuple(map(widened, args)), {name: widened(kind) for name, kind in kws.items()})

    compiled.get_call_template = get_call_template


def intrinsic(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of kernels that emits its own code; callers leave out the first argument, the typing
    context."""
    compiled: Callable[..., Any] = _intrinsic(function)
    return compiled


def import_numba_without_scipy() -> None:
    """Import numba's functions of arrays before numba does, and without ``scipy.linalg``.

    numba looks for a BLAS as it imports them, which loads scipy and a dozen of its and NumPy's
    packages. No kernel of ours calls BLAS, and numba looks again as it compiles one that does."""
    linalg: Any = importlib.import_module("numba.np.linalg")
    ensure_blas = getattr(linalg, "ensure_blas", None)
    if "numba.np.arraymath" in sys.modules or ensure_blas is None:  # another version of numba
        return
    linalg.ensure_blas = lambda: None
    try:
        arraymath: Any = importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = ensure_blas
    arraymath.ensure_blas = ensure_blas
