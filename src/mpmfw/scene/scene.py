"""A validated scene, which does not change."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import PrivateAttr

from mpmfw.scene.sources import Source
from mpmfw.scene.tables import Output, Tables
from mpmfw.scene.toml_text import toml_text


class Scene(Tables):
    """A valid scene. Make one with :func:`mpmfw.scene.load_scene`."""

    _source: Source = PrivateAttr()
    #: Made this scene, and makes others like it.
    _read: Callable[[Source, Mapping[str, Any]], Scene] = PrivateAttr()
    _mapping: dict[str, Any] = PrivateAttr()

    @property
    def source(self) -> Source:
        """Source of the scene."""
        return self._source

    @property
    def name(self) -> str:
        """The file's name without its ending, or the title, or ``scene``."""
        return Path(self._source.name).stem if self._source.name else self.title or "scene"

    @property
    def pairs(self) -> tuple[tuple[str, str, float], ...]:
        """All pairs of bodies in the scene's order, then bodies with themselves, each with its friction."""
        contact = self.contact
        default, named = (0.0, ()) if contact is None else (float(contact.friction), contact.pairs)
        given = {frozenset(pair.bodies): pair.friction for pair in named}
        itself = [(name, name) for name, body in self.bodies.items() if body.self_contact]
        ends = itertools.chain(itertools.combinations(self.bodies, 2), itself)
        found = [(a, b, given.get(frozenset((a, b)))) for a, b in ends]
        return tuple((a, b, default if mu is None else float(mu)) for a, b, mu in found)

    @property
    def has_coulomb_friction(self) -> bool:
        """Return True if friction is Coulomb's, with the μ of :attr:`pairs`."""
        if self.contact is None or self.contact.friction_law is None:
            return True
        from mpmfw.plugin.discovery import load

        return bool(load("friction", self.contact.friction_law).is_coulomb)

    @property
    def text(self) -> str:
        """A TOML document of this scene: the file's own text or, with overrides, the merged tables."""
        if self._source.text is not None and not self._source.overrides:
            return self._source.text
        set_keys = [f"# {key} was set to {value!r}\n" for key, value in self._source.overrides.items()]
        return "".join(set_keys) + toml_text(self._mapping)

    def to_mapping(self) -> dict[str, Any]:
        """Return the tables as nested mappings, as a scene writes them, with overrides."""
        return copy.deepcopy(self._mapping)

    def of_bodies(self, names: Collection[str]) -> Scene:
        """Return a scene of some bodies, moving from the start, without outputs and sleep."""
        contact = self.contact
        if contact is not None:
            pairs = tuple(pair for pair in contact.pairs if set(pair.bodies) <= set(names))
            contact = contact.model_copy(update={"pairs": pairs})
        loads = {}
        for title, load in self.loads.items():
            own = None if load.bodies is None else tuple(name for name in load.bodies if name in names)
            if own != ():
                loads[title] = load.model_copy(update={"bodies": own})
        return self.model_copy(
            update={
                "bodies": {name: body for name, body in self.bodies.items() if name in names},
                "contact": contact,
                "loads": loads,
                "settle": None,
                "sleep": None,
                "output": Output(gap=False, particles=False, surface=False, energy=False),
                "outputs": {},
            }
        )

    def with_overrides(self, overrides: Mapping[str, Any], said: Mapping[str, str] | None = None) -> Scene:
        """Return this scene with overrides by dotted key; messages call them ``said``."""
        source = replace(self._source, said={**self._source.said, **(said or {})})
        return self._read(source, overrides)
