"""What no hook of a step may change, watched now and then where a plug-in comes from elsewhere.

The material points' masses, initial volumes, positions and velocities, and the clock belong to the step itself. Hooks of plug-ins
that are not mpmfw's own are watched in the first step after each output and in every :data:`WATCH_EVERY`-th: in all others
they are called as they are, at no cost. What they do to the clock in those is undone by the step.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pluggy

from mpmfw.blame import bundled, described
from mpmfw.errors import PluginError
from mpmfw.state import State

#: Steps between two that are watched: a watched step takes up to twice as long, so that it is about one in a hundred.
WATCH_EVERY = 100

_OWNED = ("mass", "initial_volume", "position", "velocity")
_CLOCK = ("time", "steps", "dt")
_SAID = {
    "mass": "masses",
    "initial_volume": "initial volumes",
    "position": "positions",
    "velocity": "velocities",
}


class Guard:
    """Watches the hooks of strangers.

    Parameters
    ----------
    state
        Of the run.
    plugins
        All that are registered.
    """

    def __init__(self, state: State, plugins: Iterable[Any]) -> None:
        self.state = state
        self.strangers = [plugin for plugin in plugins if not bundled(type(plugin))]
        self._first = {name: self._array(name).copy() for name in _OWNED[:2]} if self.strangers else {}

    def watched(self, impl: pluggy.HookImpl) -> Callable[..., Any]:
        """The implementation, with a look at what it changed if it is a stranger's."""
        function: Callable[..., Any] = impl.function
        if not any(impl.plugin is stranger for stranger in self.strangers):
            return function

        @functools.wraps(function)
        def call(*arguments: Any) -> Any:
            arrays = {name: self._array(name).copy() for name in _OWNED}
            clock = {name: getattr(self.state, name) for name in _CLOCK}
            result = function(*arguments)
            changed = [
                f"the material points' {_SAID[name]}" for name in _OWNED if self._differs(name, arrays[name])
            ]
            changed += [
                f"the clock (state.{name})" for name in _CLOCK if getattr(self.state, name) != clock[name]
            ]
            if changed:
                self._refuse(
                    f"{described(impl.plugin)} changed {' and '.join(changed)} in its hook {function.__name__}"
                )
            return result

        return call

    def check(self) -> None:
        """At outputs: refuse masses or initial volumes that are not those of the start.

        Raises
        ------
        PluginError
            A stranger changed them in a step that was not watched.
        """
        for name, first in self._first.items():
            if self._differs(name, first):
                who = " or ".join(described(plugin) for plugin in self.strangers)
                self._refuse(f"{who} changed the material points' {_SAID[name]} since the last output")

    def _refuse(self, said: str) -> None:
        """Raise the error, with where the run was."""
        raise PluginError(
            f"{said}, which belong to the step; docs/hooks.md says what each hook may change",
            step=self.state.steps,
            time=self.state.time,
        )

    def _array(self, name: str) -> Any:
        return getattr(self.state.particles, name)

    def _differs(self, name: str, before: Any) -> bool:
        return not np.array_equal(self._array(name), before, equal_nan=True)
