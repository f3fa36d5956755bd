"""From a plug-in manager to the calls of a step.

pluggy checks the arguments of every call anew, 3-4 µs a hook, which a small scene would notice. After
``check_pending()`` the set of implementations is fixed, so the calls are bound once, in pluggy's own order
and with its selection of arguments. Each plug-in's time goes to its own stage of the clock.
"""

from __future__ import annotations

import functools
import linecache
import zlib
from collections.abc import Callable, Generator
from operator import attrgetter
from types import CodeType
from typing import TYPE_CHECKING, Any, TypeAlias

import pluggy

from mpmfw.plugin.hookspecs import HookSpecs
from mpmfw.state.clock import Clock

#: What is called for an implementation of a hook.
FunctionOf: TypeAlias = Callable[[pluggy.HookImpl], Callable[..., Any]]


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

    A hook that nobody implements costs one empty call.

    Parameters
    ----------
    function_of
        What is called for an implementation; its own function, unless that is to be held.
    """

    __slots__ = tuple(hook_names())

    def __init__(
        self, manager: pluggy.PluginManager, clock: Clock, function_of: FunctionOf = attrgetter("function")
    ) -> None:
        for name in hook_names():
            setattr(self, name, _bind(getattr(manager.hook, name), clock, function_of))

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Callable[..., Any]: ...


def _nothing(**arguments: object) -> None:
    """Stand in for a hook without implementations."""


def _bind(caller: pluggy.HookCaller, clock: Clock, function_of: FunctionOf) -> Callable[..., Any]:
    implementations = list(reversed(caller.get_hookimpls()))  # pluggy calls the last registered first
    if not implementations:
        return _nothing
    bound = _written_out(caller, [impl for impl in implementations if not impl.wrapper], clock, function_of)
    for impl in reversed([impl for impl in implementations if impl.wrapper]):
        bound = _around(impl, bound, clock, function_of)
    return bound


def _written_out(
    caller: pluggy.HookCaller, calls: list[pluggy.HookImpl], clock: Clock, function_of: FunctionOf
) -> Callable[..., Any]:
    """A function made for these implementations; with one that is timed, and takes not all that is offered::

        def advect(*, grid, dt):
            results = []
            previous = clock(stage_0)
            try:
                result = call_0(grid)
            finally:
                clock(previous)
            if result is not None:
                results.append(result)
            return results

    A plug-in that has something to do only while another runs names it, ``only_while``; else its calls cost a question.

    Between two kernels over many points the interpreter's own data has left the caches: a general function, which asks
    what there is to call with what, takes twice as long as this.
    """
    assert caller.spec is not None
    first_result = bool(caller.spec.opts.get("firstresult"))
    names: dict[str, Any] = {"clock": clock}
    lines = [f"def {caller.name}({', '.join(['*'] * bool(caller.spec.argnames) + [*caller.spec.argnames])}):"]
    lines += [] if first_result else ["    results = []"]
    for index, impl in enumerate(calls):
        names[f"call_{index}"] = function_of(impl)
        call = f"result = call_{index}({', '.join(impl.argnames)})"
        stage = getattr(impl.plugin, "stage", None)
        own = [call]
        if stage is not None:
            names[f"stage_{index}"] = stage
            own = [
                f"previous = clock(stage_{index})",
                "try:",
                f"    {call}",
                "finally:",
                "    clock(previous)",
            ]
        own += [
            "if result is not None:",
            f"    {'return result' if first_result else 'results.append(result)'}",
        ]
        if (other := getattr(impl.plugin, "only_while", None)) is not None:
            names[f"other_{index}"] = other
            own = [f"if other_{index}.running:", *(f"    {line}" for line in own)]
        lines += [f"    {line}" for line in own]
    if first_result and calls:
        names["unanswered"] = functools.partial(_refuse_none, calls[-1], caller.spec.function)
        lines.append("    unanswered()")
    lines += [] if first_result else ["    return results"]
    return _defined("\n".join(lines), caller.name, names)


def _defined(text: str, name: str, names: dict[str, Any]) -> Callable[..., Any]:
    """The function ``name`` that ``text`` defines, with what its calls refer to."""
    exec(_compiled(text, name), names)
    made: Callable[..., Any] = names[name]
    return made


@functools.cache
def _compiled(text: str, name: str) -> CodeType:
    """Plug-ins that are called alike share the code; tracebacks find its lines."""
    file = f"<calls of {name}, {zlib.crc32(text.encode()):08x}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    return compile(text, file, "exec")


def _around(
    impl: pluggy.HookImpl, inner: Callable[..., Any], clock: Clock, function_of: FunctionOf
) -> Callable[..., Any]:
    """A wrapper round a hook: what it does before its ``yield``, the hook, and what it does with the result."""
    start = function_of(impl)
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
        yields = 0
        generator: Generator[None, Any, Any] = start(*[arguments[name] for name in names])
        try:
            resume(lambda: next(generator))
            yields = 1
            result = inner(**arguments)
            resume(lambda: generator.send(result))
        except StopIteration as stop:
            if yields:
                return stop.value
        except BaseException as error:
            if not yields:
                raise
            try:
                generator.throw(error)
            except StopIteration as stop:
                return stop.value
        return _refuse_yields(impl, yields)

    return hook


def _refuse_yields(hook_impl: pluggy.HookImpl, yields: int) -> None:  # noqa: ARG001
    """Refuse a wrapper; the name of the first argument tells :mod:`mpmfw.plugin.blame` whose it is."""
    raise TypeError(f"a wrapper that yields {'more than once' if yields else 'never'}; expected one yield")


def _refuse_none(hook_impl: pluggy.HookImpl, specification: Callable[..., Any]) -> None:  # noqa: ARG001
    """Refuse None from a hook whose result the step needs; :mod:`mpmfw.plugin.blame` finds the plug-in by the first argument."""
    raise TypeError(f"returned None; expected a {specification.__annotations__['return']}")
