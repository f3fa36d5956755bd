"""Docstrings as they are written in mpmfw, where Sphinx and napoleon would read them otherwise."""

from __future__ import annotations

import re
from typing import Any

from pydantic import BaseModel
from sphinx.application import Sphinx

#: Objects whose docstrings are one sentence, with no sections: napoleon takes what stands before a colon for
#: a type.
PLAIN = ("attribute", "data", "property")

#: A name after a star, as in ``(contact, *vary)``: the start of no emphasis.
STARRED = re.compile(r"(?<![\w*`\\])\*(?=\w+\b(?!\*))")

_kept: dict[tuple[str, str], list[str]] = {}


def is_options(obj: Any) -> bool:
    """Return True if it is a model of options: its types are for pydantic, its descriptions for readers."""
    return isinstance(obj, type) and issubclass(obj, BaseModel)


def before_napoleon(app: Sphinx, what: str, name: str, obj: Any, _options: Any, lines: list[str]) -> None:
    """Escape lone stars and the bars of absolute values; keep plain docstrings from napoleon; describe
    options.
    """
    app.config.napoleon_attr_annotations = not is_options(obj)
    if is_options(obj) and "Attributes" not in lines:
        lines += [
            "",
            *(f":param {key}: {field.description or ''}" for key, field in obj.model_fields.items()),
        ]
    lines[:] = [STARRED.sub(r"\\*", line) if line.count("*") == 1 else line for line in lines]
    lines[:] = [line if "``" in line else line.replace("|", r"\|") for line in lines]
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
    obj: Any,
    _options: Any,
    signature: str | None,
    returned: str | None,
) -> tuple[str | None, str | None]:
    """Types by the names that the code gives them; of options the defaults, whose types their descriptions
    tell.
    """
    if is_options(obj):
        fields = obj.model_fields.items()
        given = (name if field.is_required() else f"{name}={field.default!r}" for name, field in fields)
        return f"({', '.join(given)})", None
    alias = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")
    found = [None if text is None else alias.sub(r"\1", text) for text in (signature, returned)]
    return found[0], found[1]


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen before and after napoleon, whose priority is 500."""
    app.connect("autodoc-process-docstring", before_napoleon, priority=400)
    app.connect("autodoc-process-docstring", after_napoleon, priority=600)
    app.connect("autodoc-process-signature", name_aliases)
    return {"parallel_read_safe": True}
