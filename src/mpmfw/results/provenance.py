"""Provenance of results: versions and commit, and the largest memory of a run."""

from __future__ import annotations

import contextlib
import functools
import platform
import re
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from mpmfw._version import __version__

_PACKAGES = ("numpy", "numba", "scipy", "xarray", "netCDF4", "pluggy")


@functools.cache
def provenance() -> dict[str, object]:
    """Return ``versions`` of packages, and in a git checkout the ``commit``, as at the first call."""
    versions = {"mpmfw": __version__, "python": platform.python_version()}
    for package in _PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            continue
    # An environment may lie in the checkout of another project, where this file is not tracked
    tracked = _git("ls-files", "--error-unmatch", Path(__file__).name)
    commit = tracked and _git("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")
    return {"versions": versions, **({"commit": commit} if commit else {})}


def _git(*arguments: str) -> str | None:
    command = ("git", "-C", str(Path(__file__).parent), *arguments)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=5, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None


_CLEAR, _STATUS = Path("/proc/self/clear_refs"), Path("/proc/self/status")


def restart_peak_memory() -> None:
    """Reset the peak of resident memory, on Linux."""
    with contextlib.suppress(OSError):
        _CLEAR.write_text("5")


def peak_memory() -> int:
    """Return the largest resident memory since the reset [bytes]."""
    with contextlib.suppress(OSError):
        found = re.search(r"^VmHWM:\s*(\d+) kB$", _STATUS.read_text(), re.MULTILINE)
        if found:
            return 1024 * int(found[1])
    import resource  # not on every system

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(peak if sys.platform == "darwin" else peak * 1024)
