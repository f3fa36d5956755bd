"""From registered plug-ins to the calls of a step.

pluggy looks at every attribute of every object (a third of a small scene's build), and checks the arguments
of every call anew (3-4 µs a hook). Here it checks each class once, and calls are bound once, in pluggy's
order. Each plug-in's time goes to its own stage of the clock.
"""

from __future__ import annotations

import functools
import inspect
import linecache
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from textwrap import indent
from types import CodeType
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

import pluggy

from mpmfw.errors import OutsideGrid, SceneError
from mpmfw.plugin.checks import PASSED_ON, described, failure
from mpmfw.plugin.hookspecs import HookSpecs
from mpmfw.state.structs import Grid, State

Clock: TypeAlias = Callable[[str], str]  #: begins a stage, and returns the one that ends

#: Hooks that are called before a run begins.
BEFORE_THE_RUN = ("declare_fields", "setup")


#: All hooks, in the order of the specifications.
HOOKS = tuple(name for name in vars(HookSpecs) if not name.startswith("_"))


@dataclass
class Implementation:
    """A plug-in's implementation of a hook, ordered first (−1), as registered (0) or last (1)."""

    plugin: Any
    function: Callable[..., Any]
    argnames: tuple[str, ...]
    order: int


#: Arguments of :class:`Implementation` by attribute and hook, of every class that was registered.
_implemented: dict[type, dict[tuple[str, str], tuple[tuple[str, ...], int]]] = {}


def pluggy_manager() -> pluggy.PluginManager:
    """Return a manager that knows the hooks and no plug-in."""
    manager = pluggy.PluginManager("mpmfw")
    manager.add_hookspecs(HookSpecs)
    return manager


SPECS: dict[str, Any] = {name: getattr(pluggy_manager().hook, name).spec for name in HOOKS}


def implemented(plugin: Any) -> dict[tuple[str, str], tuple[tuple[str, ...], int]]:
    """Return arguments and order by attribute and hook; pluggy takes 1 ms to find and check them.

    Raise SceneError if a hook or an argument is unknown, a hook is not marked, or it is a wrapper."""
    kind = type(plugin)
    own = not getattr(plugin, "__dict__", {}).keys().isdisjoint(HOOKS)
    if kind in _implemented and not own:
        return _implemented[kind]
    manager = pluggy_manager()
    try:
        manager.register(plugin, "")
        manager.check_pending()
    except pluggy.PluginValidationError as error:
        raise SceneError(f"{described(plugin)}: {error}") from error
    marks: Any = {name: manager.parse_hookimpl_opts(plugin, name) for name in dir(plugin)}
    found = {}
    for name, mark in marks.items():
        unmarked = not mark and name in HOOKS and inspect.isroutine(getattr(plugin, name))
        if unmarked:
            raise SceneError(
                f"{described(plugin)}: {name} has the name of a hook; expected @hookimpl above it, or "
                "another name"
            )
        if mark and (mark["wrapper"] or mark["hookwrapper"]):
            raise SceneError(f"{described(plugin)}: {name} is a wrapper; expected a plain @hookimpl")
        if mark and (mark["specname"] or name) in HOOKS:  # else optional, and of another version
            impl = pluggy.HookImpl(plugin, "", getattr(plugin, name), mark)
            order = impl.trylast - impl.tryfirst
            found[name, mark["specname"] or name] = (impl.argnames, order)
    return found if own else _implemented.setdefault(kind, found)


class Registry:
    """The plug-ins of a simulation by name, and the implementations of every hook in the order of calls."""

    def __init__(self) -> None:
        self.plugins: dict[str, Any] = {}
        self.implementations: dict[str, list[Implementation]] = {hook: [] for hook in HOOKS}

    def register(self, plugin: Any, name: str) -> None:
        """Register a plug-in, whose hooks are called before those of others in the same order.

        Raise SceneError if its name is taken, or as :func:`implemented`."""
        if name in self.plugins:
            both = f"{described(self.plugins[name])} and {described(plugin)}"
            raise SceneError(f"{both} have one name; expected another for one of them")
        for (attribute, hook), facts in implemented(plugin).items():
            function = getattr(plugin, attribute)
            calls, new = self.implementations[hook], Implementation(plugin, function, *facts)
            calls.insert(len(calls) if new.order > 0 else 0, new)
            calls.sort(key=attrgetter("order"))
        self.plugins[name] = plugin

    def unregister(self, name: str) -> None:
        """Take a plug-in out again."""
        plugin = self.plugins.pop(name)
        for hook, found in self.implementations.items():
            self.implementations[hook] = [each for each in found if each.plugin is not plugin]


#: When a hook is observed: before all implementations, before and after each, and after all.
MOMENTS = ("begin", "before", "after", "end")


class Observer:
    """Base of plug-ins that measure the effect of hooks on the grid while they are ``running``.

    ``plugin`` is None before all implementations of a hook and after all. ``dt`` [s] is the length of the
    step, 0 where the hook has none.
    """

    #: Hooks that are observed; they have an argument ``grid``.
    observes: ClassVar[tuple[str, ...]] = ()
    #: When, by hook, if not at all of :data:`MOMENTS`.
    moments: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    running = False

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:
        """Observe the grid before a plug-in's implementation of a hook."""

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:
        """Observe the grid after a plug-in's implementation."""


class BoundHooks:
    """The hooks of one simulation as plain callables: ``hook.advect(grid=…, dt=…)``.

    An error that leaves a hook names plug-in, hook and the step of ``state``."""

    __slots__ = HOOKS

    def __init__(self, registry: Registry, clock: Clock, state: State | None = None) -> None:
        clock = getattr(clock, "__call__", clock)  # noqa: B004 - Python finds the method sooner
        observers = [each for each in registry.plugins.values() if isinstance(each, Observer)]
        for name, implementations in registry.implementations.items():
            of_run = None if name in BEFORE_THE_RUN else state
            own = [each for each in observers if name in each.observes]
            setattr(self, name, _bind(name, implementations, clock, of_run, own))

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Callable[..., Any]: ...


def _bind(
    name: str,
    implementations: Sequence[Implementation],
    clock: Clock,
    state: State | None,
    observers: Sequence[Observer],
) -> Callable[..., Any]:
    """Return a function, written as text, that calls a hook's implementations with the arguments they take.

    Observers look before and after each. Between two kernels over many points the interpreter's own data has
    left the caches: a loop over the implementations takes twice as long as this."""
    given = SPECS[name].argnames
    first_result = bool(implementations and SPECS[name].opts.get("firstresult"))
    names: dict[str, Any] = {"clock": clock, "passed_on": (*PASSED_ON, OutsideGrid)}
    names["failed"] = lambda error, plugin: failure(error, plugin, name, state)
    names |= {f"observer_{k}": observer for k, observer in enumerate(observers)}
    calls_of = dict.fromkeys(MOMENTS, "")
    if observers:
        calls_of = {moment: _observing(name, moment, observers, "dt" in given) for moment in MOMENTS}
    lines = calls_of["begin"]
    for k, impl in enumerate(implementations):
        names[f"call_{k}"], names[f"plugin_{k}"] = impl.function, impl.plugin
        call = f"result = call_{k}({', '.join(impl.argnames)})\n"
        stage = getattr(impl.plugin, "stage", None)
        if stage is not None and name not in BEFORE_THE_RUN:
            names[f"stage_{k}"] = stage
            call = f"previous = clock(stage_{k})\ntry:\n    {call}finally:\n    clock(previous)\n"
        if name == "end_step" and hasattr(impl.plugin, "running"):
            call = f"result = None\nif plugin_{k}.running:\n{indent(call, '    ')}"
        keep = "return result" if first_result else "results.append(result)"
        whole = f"{calls_of['before']}{call}{calls_of['after']}"
        lines += f"plugin = plugin_{k}\n{whole}if result is not None:\n    {keep}\n"
    lines += calls_of["end"]
    if first_result:
        expected = SPECS[name].function.__annotations__["return"]
        lines += f"raise TypeError('returned None; expected {expected}')\n"
    text = (
        f"def {name}({', '.join(given)}):\n    results = []\n    plugin = None\n"
        f"    try:\n{indent(lines or 'pass', 8 * ' ')}\n    except passed_on:\n        raise\n"
        "    except BaseException as error:\n        raise failed(error, plugin) from error\n"
        "    return results\n"
    )
    exec(_compiled(text, name), names)
    return names[name]  # type: ignore[no-any-return]


def _observing(hook: str, moment: str, observers: Sequence[Observer], has_dt: bool) -> str:
    """Return lines that call the observers of a hook at one of :data:`MOMENTS`."""
    method = "before" if moment in ("begin", "before") else "after"
    who = "plugin" if moment in ("before", "after") else "None"
    return "".join(
        f"if observer_{k}.running: previous = clock('output'); "
        f"observer_{k}.{method}({hook!r}, {who}, grid, {'dt' if has_dt else '0.0'}); clock(previous)\n"
        for k, observer in enumerate(observers)
        if moment in observer.moments.get(hook, MOMENTS)
    )


@functools.cache
def _compiled(text: str, name: str) -> CodeType:
    """Compile a text, whose lines tracebacks find."""
    file = f"<calls of {name}, {zlib.crc32(text.encode()):08x}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    return compile(text, file, "exec")
