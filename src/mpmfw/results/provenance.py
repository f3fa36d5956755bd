"""Provenance of results: versions and commit."""

from __future__ import annotations

import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from mpmfw._version import __version__

_PACKAGES = ("numpy", "numba", "scipy", "xarray", "netCDF4", "pluggy")


def provenance() -> dict[str, object]:
    """Return ``versions`` of packages, and in a git checkout the ``commit``."""
    versions = {"mpmfw": __version__, "python": platform.python_version()}
    for package in _PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            continue
    commit = _commit(Path(__file__).parent)
    return {"versions": versions, **({"commit": commit} if commit else {})}


def _commit(folder: Path) -> str | None:
    # An environment may lie in the checkout of another project, where this file is not tracked
    tracked = _git(folder, "ls-files", "--error-unmatch", Path(__file__).name)
    return _git(folder, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*") if tracked else None


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ("git", "-C", str(folder), *arguments), capture_output=True, text=True, timeout=5, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None
