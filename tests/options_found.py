"""The options that a scene and the bundled plug-ins have, and the digest of a run."""

import hashlib
import warnings
from typing import get_args

import numpy as np
from pydantic import BaseModel

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import KINDS, available, distribution_of, load
from mpmfw.scene.tables import Tables

#: Fields that choose a model of a union, or hold what was validated elsewhere, and tables of options.
NO_OPTIONS = {
    *("type", "options", "friction_options", "tables", "threads"),
    *("grid", "time", "stepping", "shape", "contact", "materials", "sleep", "output", "reference", "loads"),
    "boundaries",
}


#: Keys that a rigid body refuses by name.
REFUSED_BY_RIGID = {
    f"RigidBody.{key}"
    for key in ("material", "particles", "rotation", "volumetric", "sides", "initial_stress", "self_contact")
}


def models_of(annotation):
    """All models that an annotation names, however deep."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    return set().union(*(models_of(part) for part in get_args(annotation)))


def option_models():
    """Models of all tables that can be reached from a scene, by name, and of the bundled plug-ins, by
    ``kind.plug-in``.

    Detections and laws have theirs in those of the contacts that are made of them; other codes have no
    part in a run.
    """
    found = {}
    todo = [Tables]
    while todo:
        model = todo.pop()
        if model is not BaseModel and model.__name__ not in found:
            found[model.__name__] = model
            for field in model.model_fields.values():
                todo += sorted(models_of(field.rebuild_annotation()), key=lambda one: one.__name__)
    for kind in [kind for kind in KINDS if kind not in ("detection", "law", "code")]:
        for name, entry in available(kind).items():
            options = getattr(load(kind, name), "Options", None)
            if distribution_of(entry) == "mpmfw" and options is not None:
                found[f"{kind}.{name}"] = options
    return found


#: Outcomes of scenes by their text: a fifth of the table's stand in it more than once.
OUTCOMES: dict[str, str] = {}


def outcome(scene):
    """Digest of all that a run records of the motion, or the words of its refusal."""
    text = repr(scene)
    if text not in OUTCOMES:
        OUTCOMES[text] = _outcome(scene)
    return OUTCOMES[text]


def _outcome(scene):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # settling that is cut short says so
            tree = mpmfw.run(scene)
    except SceneError as error:
        return f"refused: {error}"
    digest = hashlib.sha256(str(tree.attrs["title"]).encode())
    for group in tree.subtree:
        for name, variable in sorted(group.variables.items(), key=lambda item: str(item[0])):
            values = np.asarray(variable.values)
            content = values.tobytes() if values.dtype.kind in "fiub" else str(values.tolist()).encode()
            digest.update(f"{group.path}/{name}{values.shape}".encode() + content)
    return digest.hexdigest()
