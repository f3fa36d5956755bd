"""What no hook of a step may change, held where a plug-in comes from elsewhere.

The material points' masses, initial volumes, positions and velocities, and the clock belong to the step itself. While a hook of
a plug-in that is not mpmfw's own runs, these arrays are read-only, and the clock is compared afterwards.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Generator, Iterable
from typing import Any

import numpy as np
import pluggy

from mpmfw.errors import PluginError
from mpmfw.plugin.blame import bundled, described
from mpmfw.state.structs import State

_CLOCK = ("time", "steps", "dt")
_SAID = {
    "mass": "masses",
    "initial_volume": "initial volumes",
    "position": "positions",
    "velocity": "velocities",
}


class Guard:
    """Holds the hooks of strangers.

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
        self._first = (
            {name: self._array(name).copy() for name in ("mass", "initial_volume")} if self.strangers else {}
        )

    def held(self, impl: pluggy.HookImpl) -> Callable[..., Any]:
        """The implementation; a stranger's cannot change what belongs to the step."""
        function: Callable[..., Any] = impl.function
        if not any(impl.plugin is stranger for stranger in self.strangers):
            return function

        @functools.wraps(function)
        def call(*arguments: Any) -> Any:
            return self._hold(impl, lambda: function(*arguments))

        @functools.wraps(function)
        def wrap(*arguments: Any) -> Generator[Any, Any, Any]:
            """The wrapper's parts before and after its ``yield``, each held by itself."""
            generator = function(*arguments)
            part = functools.partial(next, generator)
            while True:
                ended, value = self._hold(impl, functools.partial(_advanced, part))
                if ended:
                    return value
                try:
                    sent = yield value
                except BaseException as error:
                    part = functools.partial(generator.throw, error)
                else:
                    part = functools.partial(generator.send, sent)

        return wrap if impl.wrapper else call

    def _hold(self, impl: pluggy.HookImpl, call: Callable[[], Any]) -> Any:
        """The result of a call that may change nothing of what belongs to the step.

        Raises
        ------
        PluginError
            It did, or tried to.
        """
        arrays = [self._array(name) for name in _SAID]
        clock = [getattr(self.state, name) for name in _CLOCK]
        for array in arrays:
            array.flags.writeable = False
        try:
            result = call()
        except Exception as error:
            if _of_read_only(error):
                text = "the material points' masses, initial volumes, positions or velocities"
                self._refuse(impl, text, error)
            raise
        finally:
            for array in arrays:
                array.flags.writeable = True
        changed = [
            f"the material points' {text}"
            for (name, text), array in zip(_SAID.items(), arrays, strict=True)
            if self._array(name) is not array
        ]
        changed += [
            f"the clock (state.{name})"
            for name, before in zip(_CLOCK, clock, strict=True)
            if getattr(self.state, name) != before
        ]
        if changed:
            self._refuse(impl, " and ".join(changed))
        return result

    def check(self) -> None:
        """At outputs: refuse masses or initial volumes that are not those of the start.

        Raises
        ------
        PluginError
            A stranger changed them by an array that it had kept from before.
        """
        for name, first in self._first.items():
            if not np.array_equal(self._array(name), first, equal_nan=True):
                who = " or ".join(described(plugin) for plugin in self.strangers)
                raise self._error(f"{who} changed the material points' {_SAID[name]} since the last output")

    def _refuse(self, impl: pluggy.HookImpl, changed: str, cause: Exception | None = None) -> None:
        """Raise the error, with where the run was."""
        name = impl.function.__name__
        raise self._error(f"{described(impl.plugin)} changed {changed} in its hook {name}") from cause

    def _error(self, said: str) -> PluginError:
        return PluginError(
            f"{said}, which belong to the step; docs/hooks.md says what each hook may change",
            step=self.state.steps,
            time=self.state.time,
        )

    def _array(self, name: str) -> Any:
        return getattr(self.state.particles, name)


def _advanced(part: Callable[[], Any]) -> tuple[bool, Any]:
    """Whether a generator has ended with this part, and what it returned or yielded."""
    try:
        return False, part()
    except StopIteration as stop:
        return True, stop.value


def _of_read_only(error: Exception) -> bool:
    """Whether NumPy or Numba refused to write to an array."""
    text = str(error).lower()
    return "read-only" in text or "readonly array" in text
