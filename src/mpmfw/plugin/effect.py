"""The effect plan: what a scene calls for, and why."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Effect:
    """One effect: on or off, with its reason."""

    name: str
    on: bool
    reason: str


@dataclass
class Plan:
    """All effects, and the plug-ins that act."""

    effects: list[Effect] = field(default_factory=list)
    plugins: list[Any] = field(default_factory=list)  #: in the order of registration
    rotations: dict[str, str] = field(default_factory=dict)  #: how every body's rotational inertia is treated

    def note(self, name: str, on: bool, reason: str) -> bool:
        """Record an effect; return whether it is on."""
        self.effects.append(Effect(name, on, reason))
        return on

    def plugin(self, name: str) -> Any:
        """The plug-in of a name, or None."""
        return next((plugin for plugin in self.plugins if plugin.name == name), None)
