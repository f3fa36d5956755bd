"""From a plug-in manager to the calls of a step.

pluggy checks the arguments of every call anew, 3-4 µs a hook, which a small scene would notice. After
``check_pending()`` the set of implementations is fixed, so the calls are bound once, in pluggy's own order
and with its selection of arguments. Each plug-in's time goes to its own stage of the clock.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TYPE_CHECKING, Any

import pluggy

from mpmfw.clock import Clock
from mpmfw.hookspecs import HookSpecs


def make_manager() -> pluggy.PluginManager:
    """A plug-in manager of its own for each simulation, so that runs stand side by side in one process."""
    manager = pluggy.PluginManager("mpmfw")
    manager.add_hookspecs(HookSpecs)
    return manager


def hook_names() -> list[str]:
    """All hooks, in the order of the specifications."""
    return [name for name in vars(HookSpecs) if not name.startswith("_")]


class BoundHooks:
    """The hooks of one simulation as plain callables: ``hook.advect(grid=…, dt=…)``.

    A hook that nobody implements costs one empty call. Wrappers of the old style (``hookwrapper``) go through pluggy
    itself.
    """

    def __init__(self, manager: pluggy.PluginManager, clock: Clock) -> None:
        for name in hook_names():
            setattr(self, name, _bind(getattr(manager.hook, name), clock))

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Callable[..., Any]: ...


def _nothing(**arguments: object) -> None:
    """Stand in for a hook without implementations."""


def _bind(caller: pluggy.HookCaller, clock: Clock) -> Callable[..., Any]:
    implementations = list(reversed(caller.get_hookimpls()))  # pluggy calls the last registered first
    if not implementations:
        return _nothing
    if any(impl.hookwrapper for impl in implementations):
        return caller
    calls = [_with_stage(impl, clock) for impl in implementations if not impl.wrapper]
    bound = _all(calls, bool(caller.spec is not None and caller.spec.opts.get("firstresult")))
    for impl in reversed([impl for impl in implementations if impl.wrapper]):
        bound = _around(impl, bound, clock)
    return bound


def _all(calls: list[Callable[[dict[str, Any]], Any]], first_result: bool) -> Callable[..., Any]:
    if not calls:
        return (lambda **_: None) if first_result else (lambda **_: [])
    if first_result:
        return _first_result(calls)
    return _single(calls[0]) if len(calls) == 1 else _all_results(calls)


def _around(impl: pluggy.HookImpl, inner: Callable[..., Any], clock: Clock) -> Callable[..., Any]:
    """A wrapper round a hook: what it does before its ``yield``, the hook, and what it does with the result."""
    start: Callable[..., Any] = impl.function
    names = impl.argnames
    stage: str | None = getattr(impl.plugin, "stage", None)

    def resume(step: Callable[[], Any]) -> Any:
        previous = clock(stage) if stage is not None else None
        try:
            return step()
        finally:
            if previous is not None:
                clock(previous)

    def hook(**arguments: Any) -> Any:
        generator: Generator[None, Any, Any] = start(*[arguments[name] for name in names])
        resume(lambda: next(generator))
        try:
            result = inner(**arguments)
            resume(lambda: generator.send(result))
        except StopIteration as stop:
            return stop.value
        except BaseException as error:
            try:
                generator.throw(error)
            except StopIteration as stop:
                return stop.value
        raise RuntimeError(f"the wrapper of '{impl.plugin_name}' yields more than once")

    return hook


def _with_stage(impl: pluggy.HookImpl, clock: Clock) -> Callable[[dict[str, Any]], Any]:
    """The implementation as a function of the arguments' dictionary; a plug-in with ``stage`` is timed under
    it."""
    function, names = impl.function, impl.argnames
    stage: str | None = getattr(impl.plugin, "stage", None)

    def call(arguments: dict[str, Any]) -> Any:
        return function(*[arguments[name] for name in names])

    if stage is None:
        return call

    def timed(arguments: dict[str, Any]) -> Any:
        previous = clock(stage)
        try:
            return function(*[arguments[name] for name in names])
        finally:
            clock(previous)

    return timed


def _first_result(calls: list[Callable[[dict[str, Any]], Any]]) -> Callable[..., Any]:
    def hook(**arguments: Any) -> Any:
        for call in calls:
            result = call(arguments)
            if result is not None:
                return result
        return None

    return hook


def _single(call: Callable[[dict[str, Any]], Any]) -> Callable[..., Any]:
    def hook(**arguments: Any) -> list[Any]:
        result = call(arguments)
        return [] if result is None else [result]

    return hook


def _all_results(calls: list[Callable[[dict[str, Any]], Any]]) -> Callable[..., Any]:
    def hook(**arguments: Any) -> list[Any]:
        return [result for call in calls if (result := call(arguments)) is not None]

    return hook
