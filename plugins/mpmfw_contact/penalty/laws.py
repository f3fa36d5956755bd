"""Laws of the pairs as arrays that kernels can read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.api import FloatArray, IntArray, SceneError, Setup
from mpmfw_contact.penalty.options import SurfaceOptions


@dataclass
class PairLaws:
    """Friction, stiffness and roles of all pairs of bodies."""

    first: IntArray  #: (n_pairs,) index of the pair's first body
    second: IntArray  #: (n_pairs,)
    friction: FloatArray  #: (n_pairs,) μ
    pair_of: IntArray  #: (n_bodies, n_bodies) index of the pair, −1 for none
    is_slave: IntArray  #: (n_bodies, n_bodies) whether nodes of one are slaves to segments of the other
    modulus: FloatArray  #: (n_bodies, n_bodies) M, the lesser K + 4 G / 3 [Pa]

    @classmethod
    def of(cls, setup: Setup, method: str, options: SurfaceOptions, *, one_pass: bool) -> PairLaws:
        """Read the scene's pairs; with ``one_pass`` one body of each is master alone.

        Raises
        ------
        SceneError
            An option that cannot have an effect here, or names no body.
        """
        _check(setup, method, options)
        bodies, pairs, n = setup.bodies, setup.pairs, len(setup.bodies)
        laws = cls(
            first=np.array([pair.first for pair in pairs], dtype=np.int64),
            second=np.array([pair.second for pair in pairs], dtype=np.int64),
            friction=np.array([pair.friction for pair in pairs]),
            pair_of=np.full((n, n), -1, dtype=np.int64),
            is_slave=np.zeros((n, n), dtype=np.int64),
            modulus=np.zeros((n, n)),
        )
        for pair in pairs:
            a, b = bodies[pair.first], bodies[pair.second]
            for i, j in ((a.index, b.index), (b.index, a.index)):
                laws.pair_of[i, j] = pair.index
                laws.modulus[i, j] = min(a.p_wave_modulus, b.p_wave_modulus)
                laws.is_slave[i, j] = 1
            if one_pass:
                master = a if a.p_wave_modulus >= b.p_wave_modulus else b
                if options.master in (a.name, b.name):
                    master = a if options.master == a.name else b
                slave = b if master is a else a
                laws.is_slave[master.index, slave.index] = 0
        return laws


def _check(setup: Setup, method: str, options: SurfaceOptions) -> None:
    """Refuse options that cannot have an effect in this scene."""
    if all(pair.friction == 0.0 for pair in setup.pairs):
        for name in ("tangential_ratio", "friction_law"):
            if name in options.model_fields_set:
                raise SceneError(f"contact.{method}.{name} has no effect: every pair has friction = 0")
    if options.master is not None and options.master not in [body.name for body in setup.bodies]:
        names = ", ".join(body.name for body in setup.bodies)
        raise SceneError(f"contact.{method}.master: no body '{options.master}'; expected one of {names}")
