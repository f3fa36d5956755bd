"""Laws of the pairs as arrays that kernels can read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.api import Body, FloatArray, IntArray, Pair, SceneError, Setup
from mpmfw_contact.penalty.options import SurfaceOptions
from mpmfw_contact.penalty.pair_table import pair_table


@dataclass
class PairLaws:
    """Friction of all pairs of bodies; stiffness and role of all bodies."""

    first: IntArray  #: (n_pairs,) index of the pair's first body
    second: IntArray  #: (n_pairs,)
    friction: FloatArray  #: (n_pairs,) μ
    pair_of: IntArray  #: (n_pairs, 2) table of :func:`mpmfw_contact.penalty.pair_table.pair_index`
    rank: (
        IntArray  #: (n_bodies,) nodes of a body are slaves to segments of those of the same or a higher rank
    )
    modulus: FloatArray  #: (n_bodies,) M = K + 4 G / 3 [Pa]; a pair takes the lesser

    @classmethod
    def of(cls, setup: Setup, method: str, options: SurfaceOptions, *, one_pass: bool) -> PairLaws:
        """Read the scene's bodies and the pairs listed so far; with ``one_pass`` one body of each is master alone.

        Raises
        ------
        SceneError
            An option that cannot have an effect here, or names no body.
        """
        _check(setup, method, options)
        none, empty = np.zeros(0, dtype=np.int64), np.zeros(0)
        modulus = np.array([body.p_wave_modulus for body in setup.bodies])
        ranks = _ranks(setup.bodies, options.master, one_pass=one_pass)
        laws = cls(none, none, empty, none, ranks, modulus)
        laws.list_pairs(setup.pairs)
        return laws

    def list_pairs(self, pairs: tuple[Pair, ...]) -> None:
        """Read the pairs anew, after some were added."""
        self.first = np.array([pair.first for pair in pairs], dtype=np.int64)
        self.second = np.array([pair.second for pair in pairs], dtype=np.int64)
        self.friction = np.array([pair.friction for pair in pairs], dtype=float)
        self.pair_of = pair_table(self.first, self.second)


def _ranks(bodies: tuple[Body, ...], master: str | None, *, one_pass: bool) -> IntArray:
    """All alike where each body is slave once; else the stiffer is master, of equals the first, unless one is named."""
    ranks = np.zeros(len(bodies), dtype=np.int64)
    if one_pass:
        order = sorted(bodies, key=lambda b: (b.name == master, b.p_wave_modulus, -b.index))
        ranks[[body.index for body in order]] = np.arange(len(bodies))
    return ranks


def _check(setup: Setup, method: str, options: SurfaceOptions) -> None:
    """Refuse options that cannot have an effect in this scene."""
    if not setup.has_friction:
        for name in ("tangential_ratio", "friction_law"):
            if name in options.model_fields_set:
                raise SceneError(f"contact.{method}.{name} has no effect: every pair has friction = 0")
    if options.master is not None and options.master not in [body.name for body in setup.bodies]:
        names = ", ".join(body.name for body in setup.bodies)
        raise SceneError(f"contact.{method}.master: no body '{options.master}'; expected one of {names}")
