"""Whose error it is: an exception that comes out of a plug-in is named with plug-in, distribution, place and step.

Nothing is done for it while a run goes well: the plug-in is found in the frames of the exception's traceback, outside of the
step.
"""

from __future__ import annotations

import functools
import inspect
import linecache
import re
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.metadata import packages_distributions
from operator import itemgetter
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

from mpmfw.errors import MpmfwError, PluginError, SceneError
from mpmfw.plugin.discovery import KINDS, available, distribution_of

if TYPE_CHECKING:
    from mpmfw.state.structs import State

_CALL = re.compile(r"\bcall_[0-9]+\b")


@contextmanager
def blaming(plugins: Iterable[Any], state: State | None = None) -> Iterator[None]:
    """Context in which an exception of a plug-in becomes an error that names it.

    Parameters
    ----------
    plugins
        Those that may act.
    state
        Of the run; None before there is one.

    Raises
    ------
    SceneError
        A plug-in failed before the run began.
    PluginError
        It failed in the run.
    """
    try:
        yield
    except (MpmfwError, KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException as error:  # SystemExit among them: a plug-in may not end the program
        found = culprit(error, list(plugins))
        if found is None:
            raise
        plugin, place = found
        text = f"{described(plugin)} failed in {place}: {cause(error)}"
        if state is None:
            raise SceneError(text) from error
        raise PluginError(text, step=state.steps, time=state.time) from error


@contextmanager
def refusing(said: str) -> Iterator[None]:
    """Context in which any exception but mpmfw's own becomes a SceneError that begins with ``said``.

    Raises
    ------
    SceneError
        Something was raised.
    """
    try:
        yield
    except (MpmfwError, KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException as error:
        raise SceneError(f"{said}: {cause(error)}") from error


def culprit(error: BaseException, plugins: list[Any]) -> tuple[Any, str] | None:
    """The plug-in that an exception came out of, and the name of its method; None if it came from none.

    The outermost frame counts that is a method of a plug-in, or a call of one that never got as far. A method of a bundled one,
    which may call a stranger's, counts only where there is no other, and so does a hook's wrapper, which errors pass through.
    """
    found = []
    for frame, line in traceback.walk_tb(error.__traceback__):
        called = _called(frame, line)
        if called is None:
            names = frame.f_code.co_varnames[: frame.f_code.co_argcount]
            called = (frame.f_locals.get(names[0]) if names else None, frame.f_code.co_name)
        for plugin in plugins:
            if called[0] is plugin:
                rank = 2 if frame.f_code.co_flags & inspect.CO_GENERATOR else int(bundled(type(plugin)))
                found.append((rank, plugin, called[1]))
    return min(found, key=itemgetter(0))[1:] if found else None


def _called(frame: FrameType, line: int) -> tuple[Any, str] | None:
    """The plug-in that a hook's caller calls in that line, and the hook."""
    if "hook_impl" in frame.f_locals:  # pluggy's own loop
        impl = frame.f_locals["hook_impl"]
        return impl.plugin, impl.function.__name__
    file = frame.f_code.co_filename
    if not file.startswith("<calls of "):
        return None
    found = _CALL.search(linecache.getline(file, line))
    function = frame.f_globals.get(found.group()) if found else None
    return getattr(function, "__self__", None), frame.f_code.co_name


def described(plugin: Any) -> str:
    """``plug-in 'penalty' of distribution mpmfw``."""
    kind = type(plugin)
    name = getattr(plugin, "name", kind.__qualname__)
    return f"plug-in '{name}' of {distribution_text(kind)}"


def distribution_text(kind: type[Any]) -> str:
    """``distribution spring_law``, or where the class stands that belongs to none."""
    package = kind.__module__.partition(".")[0]
    for entry in (entry for each in KINDS for entry in available(each).values()):
        if entry.module.partition(".")[0] == package:
            return f"distribution {distribution_of(entry)}"
    distributions = packages_distributions().get(package, [])
    return (
        f"distribution {distributions[0]}" if distributions else f"no distribution (module {kind.__module__})"
    )


def bundled(kind: type[Any]) -> bool:
    """Whether the class is one of mpmfw's own distribution."""
    return _is_bundled(kind.__module__.partition(".")[0])


@functools.lru_cache(maxsize=256)
def _is_bundled(package: str) -> bool:
    if package == "mpmfw":
        return True
    own = {
        entry.module.partition(".")[0]
        for each in KINDS
        for entry in available(each).values()
        if distribution_of(entry) == "mpmfw"
    }
    return package in own


def cause(error: BaseException) -> str:
    """``KeyError: 'x' (spring_law.py, line 12)``."""
    text = str(error)
    where = traceback.extract_tb(error.__traceback__)
    at = f" ({Path(where[-1].filename).name}, line {where[-1].lineno})" if where else ""
    return f"{type(error).__name__}{f': {text}' if text else ''}{at}"
