"""Contact strategies made of a detection and a law, and the options of both."""

from __future__ import annotations

import copy
import functools
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, create_model

from mpmfw.errors import SceneError
from mpmfw.plugin.checks import bundled

if TYPE_CHECKING:
    from mpmfw.contact.law import ContactLaw
    from mpmfw.contact.rows import Detection


#: What a law may need of a detection, as messages name it.
NEEDS = {
    "facets": "facets of surfaces",
    "nodes": "surface nodes against facets",
    "steady gap": "gaps that do not jump",
}


def options_of_both(contact: type[ContactLaw], law: type[BaseModel]) -> type[BaseModel]:
    """Make the model of a contact's options: those of the ``law`` and of the detection."""
    models = tuple(dict.fromkeys((law, contact.Detection.Options)))
    fields: dict[str, Any] = {}
    for model in models:
        for name in model.model_fields.keys() & contact.defaults.keys():
            info = copy.copy(model.model_fields[name])
            info.default = contact.defaults[name]
            fields[name] = (info.annotation, info)
    text = f"Options of {contact.__qualname__}: those of the law and of detection '{contact.Detection.name}'."
    made: type[BaseModel] = create_model(
        "Options", __base__=models, __module__=contact.__module__, __doc__=text, **fields
    )
    made.__qualname__ = f"{contact.__qualname__}.Options"
    return made


@functools.cache
def joined(detection: type[Detection], law: type[ContactLaw]) -> type[Any]:
    """Make the contact of a detection and a law; it can be pickled, and so can its options.

    Raise SceneError if they do not go together, or have an option of one name."""
    for need in sorted((law.needs & NEEDS.keys()) - detection.provides):
        raise SceneError(
            f"law '{law.name}' acts on {NEEDS[need]}, and detection '{detection.name}' lists none"
        )
    twice = sorted(set(detection.Options.model_fields) & set(law.Options.model_fields))
    if twice:
        raise SceneError(
            f"detection '{detection.name}' and law '{law.name}' both have an option '{twice[0]}'"
        )

    def parts_of(options: BaseModel, *, contact: bool = False) -> tuple[Any, ...]:
        return _made_again, (detection, law, options.model_dump(exclude_unset=True), contact)

    name = f"{detection.name}+{law.name}"
    body = {
        "name": name,
        "Detection": detection,
        "__reduce__": lambda self: parts_of(self.options, contact=True),
        # of the part that is not mpmfw's own, since its distribution answers for errors
        "__module__": (detection if bundled(law) else law).__module__,
        "__doc__": f"Detection '{detection.name}' with law '{law.name}'.",
    }
    made: type[Any] = type(name, (law,), body)
    made.Options.__reduce__ = parts_of
    return made


def _made_again(
    detection: type[Detection], law: type[ContactLaw], options: dict[str, Any], contact: bool
) -> Any:
    """Make a joined ``contact``, or its options alone, in another process."""
    kind = law.joined_with(detection)
    return kind(**options) if contact else kind.Options(**options)
