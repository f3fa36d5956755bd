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

_MODULES = {
    **dict.fromkeys(
        ("Interrupted", "MpmfwError", "PluginError", "ResultsWarning", "SceneError", "SimulationError"),
        "mpmfw.errors",
    ),
    "Simulation": "mpmfw.runs.simulation",
    "animate": "mpmfw.plots",
    "check_plugin": "mpmfw_testing.parametrised",
    "campaign": "mpmfw.campaigns.campaign",
    "choose": "mpmfw.studies.choosing",
    "compare": "mpmfw.campaigns.campaign",
    "difference": "mpmfw.results.selection",
    "export": "mpmfw.paraview",
    "field": "mpmfw.results.fields",
    "gap": "mpmfw.results.notebook",
    "history": "mpmfw.results.notebook",
    "load_scene": "mpmfw.scene",
    "open": "mpmfw.results",
    "pareto": "mpmfw.results.notebook",
    "rank": "mpmfw.studies.ranking",
    "resume": "mpmfw.runs.run",
    "run": "mpmfw.runs.run",
    "select": "mpmfw.results.selection",
    "study": "mpmfw.studies.study",
    "table": "mpmfw.results.notebook",
}

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
