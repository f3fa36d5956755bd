"""A detection and a law as one contact strategy, made when it is asked for."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from mpmfw.contact.detection import Detection
from mpmfw.contact.law import ContactLaw, ForceLaw
from mpmfw.contact.row_contact import ForceContact, ImpulseContact, RowContact
from mpmfw.errors import SceneError
from mpmfw.plugin.checks import bundled


def _options_of(detection: type[Detection], law: type[ContactLaw], given: dict[str, Any]) -> BaseModel:
    """Options of a joined strategy, in another process."""
    return joined(detection, law).Options(**given)


def _strategy_of(detection: type[Detection], law: type[ContactLaw], given: dict[str, Any]) -> RowContact:
    """A joined strategy that was not set up yet, in another process."""
    return joined(detection, law)(**given)


#: Classes that were joined, each once.
_JOINED: dict[tuple[type[Any], type[Any]], type[RowContact]] = {}


def joined(detection: type[Detection], law: type[ContactLaw]) -> type[RowContact]:
    """The strategy of a detection and a law, called ``DETECTION+LAW``.

    Raises
    ------
    SceneError
        The law cannot act on what the detection lists, or both have an option of one name.
    """
    if (detection, law) in _JOINED:
        return _JOINED[detection, law]
    name = f"{detection.name}+{law.name}"
    if law.needs_facets and not detection.facets:
        raise SceneError(
            f"law '{law.name}' acts on facets of surfaces, and detection '{detection.name}' lists none"
        )
    twice = sorted(set(detection.Options.model_fields) & set(law.Options.model_fields))
    if twice:
        raise SceneError(
            f"detection '{detection.name}' and law '{law.name}' both have an option '{twice[0]}'"
        )
    base = ForceContact if issubclass(law, ForceLaw) else ImpulseContact

    def options_parts(self: BaseModel) -> tuple[Any, ...]:
        return _options_of, (detection, law, self.model_dump(exclude_unset=True))

    def strategy_parts(self: RowContact) -> tuple[Any, ...]:
        return _strategy_of, (detection, law, self.options.model_dump(exclude_unset=True))

    # The classes are in no module, where pickle would look for them. Theirs is that of the part which is not mpmfw's own: what
    # it does wrong is its distribution's.
    module = (detection if bundled(law) else law).__module__
    own = {"__module__": module, "__reduce__": options_parts}
    options = type("Options", (law.Options, detection.Options), own)
    body = {
        "name": name,
        "Detection": detection,
        "Law": law,
        "Options": options,
        "__reduce__": strategy_parts,
        "__module__": module,
    }
    _JOINED[detection, law] = type(
        name, (base,), {**body, "__doc__": f"Detection '{detection.name}' with law '{law.name}'."}
    )
    return _JOINED[detection, law]
