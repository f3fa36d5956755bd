"""Contact algorithms of the Material Point Method, side by side.

The names below are imported at their first use, so that ``import mpmfw`` costs nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from mpmfw._version import __version__

if TYPE_CHECKING:
    from mpmfw.comparison import compare
    from mpmfw.results import open
    from mpmfw.runs import run
    from mpmfw.scene import load_scene
    from mpmfw.studies.study import study

_MODULES = {
    "compare": "mpmfw.comparison",
    "load_scene": "mpmfw.scene",
    "open": "mpmfw.results",
    "run": "mpmfw.runs",
    "study": "mpmfw.studies.study",
}

__all__ = ["__version__", "compare", "load_scene", "open", "run", "study"]


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name not in _MODULES:
        raise AttributeError(f"module 'mpmfw' has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
