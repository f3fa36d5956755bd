"""Laws whose friction is wrong."""

from __future__ import annotations

import numpy as np

from faulty_plugins.contact.plain import PlainContact


class KineticOnly(PlainContact):
    """Kinetic friction without stick: mu times the normal impulse, even where sticking needs less."""

    name = "kinetic-only"

    def friction(self, mu, normal, _sticking):
        return mu * normal


class NoCone(PlainContact):
    """Sticks whatever the normal impulse is."""

    name = "no-cone"

    def friction(self, mu, _normal, sticking):
        return sticking if mu > 0.0 else 0.0 * sticking


class NoFriction(PlainContact):
    """Says that it uses friction, and draws none."""

    name = "no-friction"

    def friction(self, _mu, _normal, sticking):
        return 0.0 * sticking


class AlwaysFriction(PlainContact):
    """Draws friction where the scene has none."""

    name = "always-friction"

    def friction(self, mu, normal, sticking):
        return np.minimum(max(mu, 0.2) * normal, sticking)
