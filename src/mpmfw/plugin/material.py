"""The base class of materials."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from mpmfw.plugin.base import PlugIn
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Particles


class Material(PlugIn):
    """Base of materials: one instance for each material of the scene, told its bodies' slices in ``setup``.

    Subclasses implement the hook ``update_stress``, the moduli, and :meth:`energy_density` and
    :meth:`cauchy_stress` where F says all. One whose points have a history implements
    :meth:`energy_of_points` and :meth:`stress_of_points` instead, and allocates the history in ``setup``
    (``Setup.allocate``), so that it is saved with the run.
    """

    #: Whether its points lose energy, which :meth:`dissipated_by_points` says.
    dissipates: ClassVar[bool] = False

    #: Slices of the material points made of this material.
    slices: tuple[slice, ...] = ()

    def over_points(self, kernel: Callable[..., None], particles: Particles, *arguments: Any) -> None:
        """``kernel(first, last, *arguments)`` for the material's points, of which several threads have a part
        each.

        A kernel that is called so writes to the points ``first:last`` alone, and asks no other.
        """
        if particles.threads is not None:
            particles.threads.over_slices(kernel, self.slices, *arguments)
            return
        for own in self.slices:
            kernel(own.start, own.stop, *arguments)

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus K [Pa] at small strain."""
        raise NotImplementedError

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G [Pa] at small strain."""
        raise NotImplementedError

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        """Stored energy per reference volume W(F), (n,) [J/m^3].

        ``deformation_gradient`` is F, (n, dim, dim); plane strain in 2D, F_zz = 1.
        """
        raise NotImplementedError

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Full Cauchy stress σ(F), (n, 3, 3) [Pa], out-of-plane components included; for outputs.

        ``deformation_gradient`` is F, (n, dim, dim); plane strain in 2D, F_zz = 1.
        """
        raise NotImplementedError

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Stored energy per reference volume of the points ``own`` of ``particles``, (n,) [J/m^3]; by F alone
        W(F)."""
        return self.energy_density(particles.deformation_gradient[own])

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Full Cauchy stress of the points ``own`` of ``particles``, (n, 3, 3) [Pa]; by F alone σ(F)."""
        return self.cauchy_stress(particles.deformation_gradient[own])

    def dissipated_by_points(self, particles: Particles, own: slice) -> FloatArray:
        """Energy that the points ``own`` of ``particles`` have lost since the start, per reference volume
        (n,) [J/m^3]."""
        return np.zeros(len(particles.mass[own]))
