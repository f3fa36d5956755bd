"""Hooks that their author wrote and nobody would call, since a mark is missing or a name is wrong."""

from __future__ import annotations

import inspect
from typing import Any

import pluggy

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import did_you_mean, full_name
from mpmfw.plugin.hookspecs import HookSpecs


def refuse_dead_hooks(plugin: type[Any]) -> None:
    """Refuse a plug-in class with hooks that would never be called.

    Raises
    ------
    SceneError
        A method with a hook's name is not marked with ``hookimpl``, or one that is marked has no hook's name, asks
        for what the hook does not give, or is a wrapper of pluggy's old style.
    """
    hooks = [name for name in vars(HookSpecs) if not name.startswith("_")]
    marks = pluggy.PluginManager("mpmfw")
    for method in dir(plugin):
        mark = marks.parse_hookimpl_opts(plugin, method)
        if mark is not None:
            called = mark["specname"] or method
            if called not in hooks and not mark["optionalhook"]:
                raise SceneError(
                    f"{_written(plugin, method)} is marked with @hookimpl, but there is no hook '{called}'; "
                    f"{did_you_mean(called, hooks)}"
                )
            if mark["hookwrapper"]:
                raise SceneError(
                    f"{_written(plugin, method)} is a wrapper of the old style; expected @hookimpl(wrapper=True), with "
                    "'result = yield' and 'return result'"
                )
            _refuse_arguments(plugin, method, called)
        elif method in hooks and inspect.isroutine(getattr(plugin, method)):
            raise SceneError(
                f"{_written(plugin, method)} has the name of a hook and is not marked as one, so that it would never be "
                "called; put @hookimpl above it, or give it another name"
            )


def _refuse_arguments(plugin: type[Any], method: str, hook: str) -> None:
    specification = getattr(HookSpecs, hook, None)
    if specification is None:  # an optional hook of somebody else's
        return
    given = [name for name in inspect.signature(specification).parameters if name != "self"]
    for name, parameter in inspect.signature(getattr(plugin, method)).parameters.items():
        if name not in ("self", *given) and parameter.default is parameter.empty:
            raise SceneError(
                f"{_written(plugin, method)} asks for '{name}', which the hook does not give; "
                f"{did_you_mean(name, given)}"
            )


def _written(plugin: type[Any], method: str) -> str:
    """A method with the class that it is written in."""
    owner = next(each for each in plugin.__mro__ if method in vars(each))
    return f"{full_name(owner)}.{method}"
