"""Friction: how much a row of contact holds along its plane."""

from __future__ import annotations

from typing import ClassVar

from mpmfw.contact.rows import ContactRows
from mpmfw.plugin.base import PlugIn
from mpmfw.state.fields import FloatArray


class FrictionLaw(PlugIn):
    """Base of friction laws, announced as entry points of the group ``mpmfw.friction``; itself it is
    Coulomb's.

    The tangential force on a row is at most T = μ N + a, with N the normal one. A friction law says μ and a,
    once a step, after the rows are detected and before the step's length is chosen: what depends on the slip
    follows that of the step before. A contact law obeys it with ``mpmfw.kernels.contact.slip_limit``.
    """

    #: Whether rows hold something without a normal force, a > 0, so that pairs with μ = 0 have friction as
    #: well.
    cohesive: ClassVar[bool] = False
    #: Whether T is μ N with the μ of the pairs, of which closed forms are known.
    is_coulomb: ClassVar[bool] = False

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:  # noqa: ARG002
        """Write ``rows.friction`` (n,) [1], and ``rows.cohesion`` (n,) [N m^(dim−3)] where the law is
        :attr:`cohesive`.

        Parameters
        ----------
        rows
            Of this step: pair, area and normal; ``motion`` is that over the last step.
        friction
            μ of every pair in the scene (n_pairs,) [1].
        dt
            Length of the last step [s]; 0 before the first.
        """
        n = rows.count
        rows.friction[:n] = friction[rows.pair[:n]]
