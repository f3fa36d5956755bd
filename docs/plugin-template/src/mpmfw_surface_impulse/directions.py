"""Who is slave to whom: one direction for each pair in one pass, both in two."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.api import Body, FloatArray, IntArray, Pair, SceneError, Setup
from mpmfw_surface_impulse.options import SurfaceImpulseOptions


@dataclass(frozen=True)
class Directions:
    """Nodes of body ``slave[d]`` are held off the segments of body ``master[d]``."""

    slave: IntArray  #: (n_directions,)
    master: IntArray  #: (n_directions,)
    pair: IntArray  #: (n_directions,)
    sign: FloatArray  #: (n_directions,) 1 where the slave is the pair's first body, else −1
    friction: FloatArray  #: (n_directions,) μ

    @classmethod
    def of(cls, setup: Setup, options: SurfaceImpulseOptions) -> Directions:
        """Read the scene's pairs.

        Raises
        ------
        SceneError
            ``slave`` names no body.
        """
        names = [body.name for body in setup.bodies]
        if options.slave is not None and options.slave not in names:
            raise SceneError(
                f"contact.surface_impulse.slave: no body '{options.slave}'; expected one of {', '.join(names)}"
            )
        found: list[tuple[int, int, Pair]] = []
        for pair in setup.pairs:
            a, b = setup.bodies[pair.first], setup.bodies[pair.second]
            first_is_slave = (
                _softer(a, b) if options.slave not in (a.name, b.name) else options.slave == a.name
            )
            if options.passes == "two" or first_is_slave:
                found.append((a.index, b.index, pair))
            if options.passes == "two" or not first_is_slave:
                found.append((b.index, a.index, pair))
        return cls(
            slave=np.array([a for a, _, _ in found], dtype=np.int64),
            master=np.array([b for _, b, _ in found], dtype=np.int64),
            pair=np.array([pair.index for *_, pair in found], dtype=np.int64),
            sign=np.array([1.0 if a == pair.first else -1.0 for a, _, pair in found]),
            friction=np.array([pair.friction for *_, pair in found]),
        )


def _softer(a: Body, b: Body) -> bool:
    """Whether body a has the smaller K + 4 G / 3."""
    return a.p_wave_modulus < b.p_wave_modulus
