"""Contact algorithms of the Material Point Method, side by side.

The names below are imported at their first use, so that ``import mpmfw`` costs nothing. ``__version__`` is
the version of mpmfw, a string."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from mpmfw._version import __version__

if TYPE_CHECKING:
    from mpmfw import plots
    from mpmfw.campaigns.campaign import campaign, compare
    from mpmfw.errors import Interrupted, MpmfwError, PluginError, ResultsWarning, SceneError, SimulationError
    from mpmfw.paraview import export
    from mpmfw.plots import animate
    from mpmfw.results import open
    from mpmfw.results.fields import field
    from mpmfw.results.notebook import gap, history, pareto, table
    from mpmfw.results.selection import difference, select
    from mpmfw.runs.run import resume, run
    from mpmfw.runs.simulation import Simulation
    from mpmfw.scene import load_scene
    from mpmfw.studies.choosing import choose
    from mpmfw.studies.ranking import rank
    from mpmfw.studies.study import study
    from mpmfw_testing.parametrised import check_plugin

_NAMES = {
    "mpmfw.campaigns.campaign": ("campaign", "compare"),
    "mpmfw.errors": (
        "Interrupted", "MpmfwError", "PluginError", "ResultsWarning", "SceneError", "SimulationError",
    ),
    "mpmfw.paraview": ("export",),
    "mpmfw.plots": ("animate",),
    "mpmfw.results": ("open",),
    "mpmfw.results.fields": ("field",),
    "mpmfw.results.notebook": ("gap", "history", "pareto", "table"),
    "mpmfw.results.selection": ("difference", "select"),
    "mpmfw.runs.run": ("resume", "run"),
    "mpmfw.runs.simulation": ("Simulation",),
    "mpmfw.scene": ("load_scene",),
    "mpmfw.studies.choosing": ("choose",),
    "mpmfw.studies.ranking": ("rank",),
    "mpmfw.studies.study": ("study",),
    "mpmfw_testing.parametrised": ("check_plugin",),
}  # fmt: skip
_MODULES = {name: module for module, names in _NAMES.items() for name in names}

#: Functions whose results have the accessor ``.mpmfw``.
_GIVE_RESULTS = {"campaign", "choose", "compare", "open", "resume", "run", "select", "study"}

__all__ = [
    "Interrupted",
    "MpmfwError",
    "PluginError",
    "ResultsWarning",
    "SceneError",
    "Simulation",
    "SimulationError",
    "__version__",
    "animate",
    "campaign",
    "check_plugin",
    "choose",
    "compare",
    "difference",
    "export",
    "field",
    "gap",
    "history",
    "load_scene",
    "open",
    "pareto",
    "plots",
    "rank",
    "resume",
    "run",
    "select",
    "study",
    "table",
]


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name == "plots":
        return importlib.import_module("mpmfw.plots")
    if name not in _MODULES:
        raise AttributeError(f"module 'mpmfw' has no attribute {name!r}")
    if name in _GIVE_RESULTS:
        importlib.import_module("mpmfw.results.notebook")
    value = getattr(importlib.import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
