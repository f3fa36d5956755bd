"""Docstrings as they are written in mpmfw, where Sphinx and napoleon would read them otherwise."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

#: Objects whose docstrings are one sentence, with no sections: napoleon takes what stands before a colon for a type.
PLAIN = ("attribute", "data", "property")

#: A name after a star, as in ``(contact, *vary)``: the start of no emphasis.
STARRED = re.compile(r"(?<![\w*`\\])\*(?=\w+\b(?!\*))")

_kept: dict[tuple[str, str], list[str]] = {}


def before_napoleon(_app: Sphinx, what: str, name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Escape lone stars; keep plain docstrings from napoleon."""
    lines[:] = [STARRED.sub(r"\\*", line) if line.count("*") == 1 else line for line in lines]
    if what in PLAIN:
        _kept[what, name] = list(lines)
        lines.clear()


def after_napoleon(_app: Sphinx, what: str, name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Put plain docstrings back."""
    lines[:] = _kept.pop((what, name), lines)


def name_aliases(
    _app: Sphinx,
    _what: str,
    _name: str,
    _obj: Any,
    _options: Any,
    signature: str | None,
    returned: str | None,
) -> tuple[str | None, str | None]:
    """Types by the names that the code gives them."""
    alias = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")
    found = [None if text is None else alias.sub(r"\1", text) for text in (signature, returned)]
    return found[0], found[1]


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen before and after napoleon, whose priority is 500."""
    app.connect("autodoc-process-docstring", before_napoleon, priority=400)
    app.connect("autodoc-process-docstring", after_napoleon, priority=600)
    app.connect("autodoc-process-signature", name_aliases)
    return {"parallel_read_safe": True}
