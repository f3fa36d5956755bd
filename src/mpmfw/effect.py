"""The effect plan: what a scene calls for, and why."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Effect:
    """One effect: on or off, with its reason."""

    name: str
    on: bool
    reason: str
