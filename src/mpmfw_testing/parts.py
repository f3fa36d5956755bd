"""A detection or a law as what can be checked: a contact strategy, with another part that the kit knows."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from pydantic import ValidationError

from mpmfw.contact.parts import ContactLaw, Detection
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import Kind, full_name, load

#: Base classes of the parts of a contact.
PARTS: dict[Kind, type[Any]] = {"detection": Detection, "law": ContactLaw}

#: Parts that others are joined with, in the order of the trials.
PARTNERS: dict[Kind, tuple[str, ...]] = {"detection": ("surfaces", "nodes"), "law": ("penalty", "impulse")}


def part_of(plugin: Any) -> Kind | None:
    """Whether a class or an object is a detection or a law; None if it is neither."""
    kind = plugin if isinstance(plugin, type) else type(plugin)
    return next((part for part, base in PARTS.items() if issubclass(kind, base)), None)


def whole(part: type[Any], kind: Kind, options: Mapping[str, Any]) -> type[Any]:
    """The contact strategy of a detection or a law that has these options.

    Raises
    ------
    SceneError
        It is none, or goes with nothing that it could be checked with.
    """
    if part_of(part) != kind:
        raise SceneError(
            f"{full_name(part)} is no {kind} plug-in; expected a subclass of mpmfw.api.{PARTS[kind].__name__}"
        )
    refusals = []
    for other in _partners("detection" if kind == "law" else "law"):
        law, detection = (part, other) if kind == "law" else (other, part)
        try:
            made: type[Any] = law.joined_with(detection)
            with suppress(ValidationError):  # whoever makes one says what is wrong with the options
                made(**options)
            return made
        except SceneError as error:
            refusals.append(str(error))
    raise SceneError(f"{kind} '{part.name}' cannot be checked alone: {'; '.join(refusals)}")


def _partners(kind: Kind) -> list[type[Any]]:
    """Return the parts that others are joined with; facets and laws of forces come first."""
    return [load(kind, name) for name in PARTNERS[kind]]
