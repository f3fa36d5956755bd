"""Short names of a campaign's keys, the scene's keys that they stand for, and their effect."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available
from mpmfw.scene.override import parse_path
from mpmfw.scene.problem import dotted
from mpmfw.scene.specification import parse_specification
from mpmfw.units import to_si

#: The stiffness factor of whatever contact runs.
OWN_OPTION = "contact.*.kappa"

#: Short names and the keys of the scene that they stand for; ``*`` stands for every body.
SHORT = {
    "contact": "contact.method",
    "shape": "shape.method",
    "transfer": "stepping.transfer",
    "scheme": "stepping.scheme",
    "cell_size": "grid.cell_size",
    "particle_size": "bodies.*.particles.size",
    "particles_per_cell": "bodies.*.particles.size",
    "segment": "bodies.*.segment",
    "kappa": OWN_OPTION,
    "safety": "time.safety",
}

#: Keys of a scene that choose how it is computed; all others change what is computed.
_NUMERICAL = re.compile(
    r"contact\.(?!friction|pairs)|shape\.|stepping\.|grid\.|time\.(safety|step|output_interval)|output\.|settle\.(?!gravity)"
    r"|bodies\.[^.]+\.(particles|segment|rotation|volumetric)"
)

#: Keys of mpmfw's own methods, which other codes do not read.
_OWN_METHODS = re.compile(
    r"contact\.(?!friction|pairs|method)|shape\.|stepping\.|time\.(safety|step)$|bodies\.[^.]+\.(segment|rotation|volumetric)"
)

#: Names that a dataset reserves.
_TAKEN = ("scene", "stage", "time", "body", "pair", "axis", "rotation", "frame", "repeat", "load")


def full_key(key: str) -> str:
    """Return the key that a short name stands for."""
    return SHORT.get(key, key)


def written_alike(key: str, values: list[Any]) -> list[Any]:
    """Return values of a key as labels write them."""
    if full_key(key) not in ("contact.method", "shape.method"):
        return values
    return [_written(value) if isinstance(value, str) else value for value in values]


def _written(text: str) -> str:
    try:
        return str(parse_specification(text))
    except SceneError:
        return text  # the scene refuses it


def is_numerical(key: str) -> bool:
    """Return True if the key changes the method alone."""
    full = full_key(key)
    of_friction_law = full.startswith("contact.") and full.split(".")[1] in available("friction")
    return _NUMERICAL.match(full) is not None and not of_friction_law


def is_own_method(key: str) -> bool:
    """Return True if a key concerns mpmfw's methods alone, not those of other codes."""
    return _OWN_METHODS.match(full_key(key)) is not None


def finer(key: str) -> int:
    """Return -1 where smaller values are finer, 1 where larger ones are."""
    last = full_key(key).rpartition(".")[2]
    if key == "particles_per_cell":
        return 1
    return -1 if last in ("cell_size", "size", "segment", "safety", "step") else 0


def as_number(value: Any) -> float | None:
    """Return a value that can be put in order, else None."""
    if isinstance(value, bool):
        return None
    if isinstance(value, int | float):
        return float(value)
    cells = re.fullmatch(r"\s*([0-9.eE+-]+)\s*cells?\s*", value) if isinstance(value, str) else None
    try:
        number = float(cells.group(1)) if cells else to_si(value, "m") if isinstance(value, str) else None
    except ValueError:
        return None
    return float(number) if isinstance(number, int | float) else None


def overrides_of(bodies: Iterable[str], dim: int, key: str, value: Any) -> dict[str, Any]:
    """Return the keys that a campaign's key sets, and their values."""
    if key == "particles_per_cell":
        if isinstance(value, bool) or not isinstance(value, int | float) or value <= 0:
            raise SceneError(f"{value!r} is not a number of particles; expected a positive number, such as 4")
        value = f"{value ** (-1.0 / dim):.12g} cells"
    full = full_key(key)
    if "*" not in full or full == OWN_OPTION:
        return {full: value}
    head, tail = parse_path(full.partition(".*.")[0]), parse_path(full.partition(".*.")[2])
    if isinstance(bodies, Mapping) and tail[0] == "particles":
        bodies = [name for name, body in bodies.items() if body.particles is not None]  # not the rigid ones
    return {dotted((*head, body, *tail)): value for body in bodies}


def dimension_names(keys: Iterable[str]) -> dict[str, str]:
    """Return dimensions by key: its last part where that is unique."""
    keys = list(keys)
    last = [re.sub(r"\W+", "_", key.rpartition(".")[2]).strip("_") for key in keys]
    whole = [re.sub(r"\W+", "_", key).strip("_") for key in keys]
    return {
        key: name if last.count(name) == 1 and name not in _TAKEN else full
        for key, name, full in zip(keys, last, whole, strict=True)
    }
