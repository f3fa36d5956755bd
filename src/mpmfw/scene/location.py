"""Where the key stands that an error is about which was found after the scene was read."""

from __future__ import annotations

import re
from dataclasses import replace

from mpmfw.errors import SceneError
from mpmfw.scene.loading import error_of
from mpmfw.scene.override import parse_path
from mpmfw.scene.problem import Problem
from mpmfw.scene.scene import Scene

#: A dotted key at the beginning of a message: ``time.step:``, ``bodies.a and bodies.b overlap``.
_KEY = re.compile(r"[A-Za-z_][\w.\-\[\]]*(?=[:\s])")


def located(error: SceneError, scene: Scene) -> SceneError:
    """The error with the file and line of its key, or the option that set the key, in front of its message.

    Parameters
    ----------
    error
        Raised as the simulation was built; its message begins with the key that it is about. One that begins
        otherwise comes back as it is.
    scene
        The scene that was built.
    """
    text = str(error)
    found = _KEY.match(text)
    if found is None:
        return error
    try:
        path = parse_path(found.group())
    except ValueError:
        return error
    if path[0] not in Scene.model_fields or (scene.source.name and text.startswith(f"{scene.source.name}:")):
        return error
    (problem,) = error_of([Problem(path, text)], scene.source, scene.source.overrides).problems
    key, rest = found.group(), text[found.end() :]
    if key == problem.override:  # the option says it
        key, text = "", rest.removeprefix(":").lstrip()
    elif rest.startswith(":"):
        text = rest[1:].lstrip()
    else:
        key = ""
    return SceneError(problems=[replace(problem, key=key, message=text)])
