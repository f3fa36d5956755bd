"""Write docs/hooks.md from the hook specifications: ``python docs/make_hooks.py``.

The specifications are the only place where a hook is described; a test says when the page is out of date.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path

from mpmfw.plugin.hooks import HOOKS, SPECS
from mpmfw.plugin.hookspecs import HookSpecs

PAGE = Path(__file__).with_name("hooks.md")

HEAD = """\
# Hooks

<!-- Made by docs/make_hooks.py from the specifications in src/mpmfw/plugin/hookspecs.py: edit those. -->

These are the places in the algorithm where a plug-in may act, in the order of a run. A hook is named by its
place, not by a method. No hook receives the simulation. A plug-in takes all other data once, from
`mpmfw.api.Setup`, and stores them. An implementation is a method marked with `mpmfw.api.hookimpl`; it may
omit arguments that it does not use. The parts of a step are named as in [methods](guide/methods.md#the-step),
symbols and units as in the [glossary](glossary.md).

Arguments of the same name mean the same at every hook. `particles`, `grid` and `state` are of the types
`mpmfw.api.Particles`, `mpmfw.api.Grid` and `mpmfw.api.State`. `phi` is the material points' table of
interpolation in this step (`mpmfw.api.Stencil`), and `dt` [s] is the length of the present step. These and
all other types below are imported from [`mpmfw.api`](api/plugins.md), which describes their fields.

Where several plug-ins implement a hook, all are called, in the order that `mpmfw explain SCENE --all` prints.
If a hook says *first answer counts*, the first answer that is not `None` is taken and no further plug-in is
called.
"""


def page() -> str:
    """The whole page."""
    return "\n".join([HEAD, _summary(), *(_section(name) for name in HOOKS)]).rstrip() + "\n"


def _summary() -> str:
    rows = [f"| [`{name}`](#{name}) | {_when(name)} |" for name in HOOKS]
    return "\n".join(["| hook | when |", "| --- | --- |", *rows, ""])


def _when(name: str) -> str:
    """Return the part before the colon of the first line, which is ``when: what``."""
    when, _, what = _markdown(_lines(name)[0]).partition(": ")
    if not what:
        raise SystemExit(f"the first line of the hook '{name}' is not 'when: what'")
    return when


def _section(name: str) -> str:
    arguments = [
        p for p in inspect.signature(getattr(HookSpecs, name)).parameters.values() if p.name != "self"
    ]
    signature = ", ".join(f"{p.name}: {p.annotation}" for p in arguments)
    returned = inspect.signature(getattr(HookSpecs, name)).return_annotation
    first = " *First answer counts.*" if _first_result(name) else ""
    head, *rest = _lines(name)
    code = f"```python\n{name}({signature}) -> {returned}\n```"
    return "\n".join([f"## {name}", "", code, "", _markdown(head) + first, *map(_markdown, rest), ""])


def _first_result(name: str) -> bool:
    return bool(SPECS[name].opts.get("firstresult"))


def _lines(name: str) -> list[str]:
    text = inspect.getdoc(getattr(HookSpecs, name))
    if not text:
        raise SystemExit(f"the hook '{name}' has no docstring")
    return text.splitlines()


def _markdown(text: str) -> str:
    """Roles and double backticks as code; a ``:meth:`` is a hook of this page."""
    text = re.sub(r":meth:`(\w+)`", r"[`\1`](#\1)", text)
    text = re.sub(r":\w+:`~?([\w.]+)`", r"`\1`", text)
    return text.replace("``", "`")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
