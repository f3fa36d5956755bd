"""Base classes of plug-ins: a name, and options validated by a model; materials, shape functions, and
plug-ins that a scene may name several times."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.errors import OutsideGrid, PluginError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Body, Particles, State, Stencil
from mpmfw.units import problems_in_time

if TYPE_CHECKING:
    from mpmfw.plugin.setup import Setup


class OptionsModel(BaseModel):
    """Base of models of options: unknown options are errors, values do not change."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class NoOptions(OptionsModel):
    """Empty options of a plug-in."""


class PlugIn:
    """Base of plug-ins: a name, and options validated by a model.

    Raise pydantic.ValidationError if an option is unknown or refused. A class may set ``interface = 1``, the
    version of the interface (``mpmfw.api.INTERFACE``) that it is written for.
    """

    #: What scenes and the entry point call the plug-in.
    name: ClassVar[str]
    #: Model of the options; its instance is ``self.options``.
    Options: ClassVar[type[BaseModel]] = NoOptions
    #: Dimensions that it works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Reason for these dimensions, for the message that refuses others.
    dimensions_note: ClassVar[str] = ""
    #: Stage of the clock that its hooks are charged to; None is that of the caller.
    stage: ClassVar[str | None] = None
    #: Attributes that it keeps from step to step (``mpmfw.state.history``), beside those of its bases.
    history: ClassVar[tuple[str, ...]] = ()

    def __init__(self, **options: Any) -> None:
        self.options = self.Options(**options)

    @classmethod
    def from_options(cls, options: BaseModel) -> Self:
        """Make the plug-in from its model, keeping which options were set."""
        return cls(**{key: getattr(options, key) for key in options.model_fields_set})

    @property
    def label(self) -> str:
        """Name and the options that were set, ``NAME(option=value, …)``."""
        from mpmfw.scene.specification import specification_of

        options = self.options
        return specification_of(self.name, {key: getattr(options, key) for key in options.model_fields_set})


class Material(PlugIn):
    """Base of materials: one instance for each material of the scene.

    Subclasses implement the hook ``update_stress``, the moduli, :meth:`energy_density` and
    :meth:`cauchy_stress`. One whose points have a history implements :meth:`energy_of_points` and
    :meth:`stress_of_points` instead, and allocates the history in ``setup`` (``Setup.allocate``). F is
    (n, dim, dim); plane strain in 2D, F_zz = 1. Of bodies of revolution F and σ are (n, 3, 3).
    """

    #: Whether its points lose energy, which :meth:`dissipated_by_points` says.
    dissipates: ClassVar[bool] = False
    #: Whether its flow prescribes the change of volume, which locks as near incompressibility does.
    isochoric: ClassVar[bool] = False

    #: Slices of the material points made of this material.
    slices: tuple[slice, ...] = ()
    #: Largest of 2 c / h over its bodies, by its moduli at small strain [1/s].
    bulk_frequency: float = 0.0

    def over_points(self, kernel: Callable[..., None], particles: Particles, *arguments: Any) -> None:
        """Call ``kernel(first, last, *arguments)`` for the material's points; threads have a part each.

        The kernel writes to the points ``first:last`` alone, and reads no others.
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

    @property
    def dilates(self) -> bool:
        """Return True if flow increases the volume; pressures in a cell are then brought to their mean."""
        return False

    def stiffest(self) -> float:
        """Return the largest modulus of plane waves at present [Pa]."""
        return self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        """Stored energy per reference volume W(F), (n,) [J/m^3]."""
        raise NotImplementedError

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Full Cauchy stress σ(F), (n, 3, 3) [Pa]; for outputs."""
        raise NotImplementedError

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Stored energy of points per reference volume, (n,) [J/m^3]."""
        return self.energy_density(particles.deformation_gradient[own])

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Full Cauchy stress of the points ``own``, (n, 3, 3) [Pa]; by F alone σ(F)."""
        return self.cauchy_stress(particles.deformation_gradient[own])

    def set_stress(self, own: slice, stress: FloatArray) -> bool:  # noqa: ARG002
        """Let the points ``own`` begin with principal stresses along x, y and z, or θ, (n, 3) [Pa] at F = 1.

        Return False if their stress follows from F alone."""
        return False

    def dissipated_by_points(self, particles: Particles, own: slice) -> FloatArray:
        """Energy lost by points since the start, (n,) [J/m^3]."""
        return np.zeros(len(particles.mass[own]))


class ShapeFunction(PlugIn):
    """Base of shape functions: hooks ``particle_reach``, ``interpolate`` and ``interpolate_surface``."""

    #: Whether boundary nodes may carry no mass of the body (point-like particles).
    massless_boundary: ClassVar[bool] = False
    #: Degree of the B-splines that are the boundary basis: 1 bilinear.
    boundary_degree: ClassVar[int] = 1
    #: Whether nodes with mass are those of two grids, of even and of odd indices; the boundary basis is then
    #: the compact kernel of each.
    staggered: ClassVar[bool] = False
    #: Whether Σ φ q qᵀ may be singular, so that the affine field must be taken from Σ v ∇φᵀ.
    singular_spread: ClassVar[bool] = False
    #: Σ φ q qᵀ over h², where it is this number times 1 at every point of the plane and of space.
    spread: ClassVar[float | None] = None
    #: Whether bodies take all from the grid by its tables, so that nodes may be divided (``self_contact``).
    divisible: ClassVar[bool] = True
    #: Whether the nodes of every row of its tables ascend, so that threads can share the nodes out.
    rows_ascend: ClassVar[bool] = False
    #: Whether uniform states of bodies of revolution are exact with it: ``Setup.state.grid.axisymmetric``.
    axisymmetric: ClassVar[bool] = False
    #: Largest Courant number c Δt / h that is not refused.
    courant: ClassVar[float] = 0.8
    auto_scheme: ClassVar[str] = "usl"  #: what ``auto`` means for the scheme
    auto_transfer: ClassVar[str] = "aflip"  #: what ``auto`` means for the transfer
    auto_rotation: ClassVar[str] = "spin"  #: inertia of free bodies: ``spin``, ``exact`` or ``lumped``


class NamedPlugIn(PlugIn):
    """Base of plug-ins with a table of options in the scene, such as ``[loads.NAME]``."""

    #: Whether surfaces must be tracked for it.
    needs_surface: ClassVar[bool] = False
    #: Options that are vectors, constant or in time (``mpmfw.api.units.vector_in_time``).
    vectors: ClassVar[tuple[str, ...]] = ()
    #: What the scene calls it.
    title: str = ""
    #: Bodies that it concerns.
    bodies: tuple[Body, ...] = ()

    @classmethod
    def problems(cls, options: Any, dim: int) -> Iterable[tuple[tuple[str | int, ...], str]]:
        """Yield vectors of another dimension than ``dim`` and times that do not increase: key, with an index
        where there is one, and text."""
        for key in cls.vectors:
            for index, text in problems_in_time(getattr(options, key), dim):
                yield (key, *index), text

    def from_setup(self, setup: Setup) -> Self | str:  # noqa: ARG002
        """Return the plug-in, ready for the bodies, or why it does not act."""
        return self

    def checked(
        self, answer: Any, shape: tuple[int, ...], state: State, *, missing: bool = False
    ) -> FloatArray:
        """Return the result of a method as an array of this ``shape``; NaN may stand for ``missing`` values.

        Raise PluginError if the shape differs or a value is not finite.
        """
        array: AnyArray = np.asarray(answer, dtype=float)
        if array.shape != shape:
            raise self.refusal(f"an array of shape {array.shape}; expected {shape}", state)
        if np.isinf(array).any() or (not missing and np.isnan(array).any()):
            raise self.refusal("what is not finite", state)
        return np.ascontiguousarray(array)

    def refusal(self, answer: str, state: State) -> PluginError:
        """Return the error for a wrong ``answer`` of a method."""
        text = f"'{self.title}' ({self.name}) answered with {answer}"
        return PluginError(text, step=state.steps, time=state.time)


class OutputSeries(NamedPlugIn):
    """Base of diagnostics: one instance for each table ``[outputs.NAME]`` of the scene.

    Subclasses declare their series, :meth:`series`, and give their values, :meth:`values`. In the results
    each is called ``NAME_series``.
    """

    stage = "output"

    def series(self) -> list[Field]:
        """Return declarations: name, dims, unit and meaning; called more than once."""
        raise NotImplementedError

    def values(self, state: State, interval: float) -> Mapping[str, Any]:
        """Return the numbers of every declared series by name; ``state`` may not be changed.

        ``interval`` [s] is the time since the last output, 0 at the first: there a sum begins."""
        raise NotImplementedError

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [
            dataclasses.replace(field, name=f"{self.title}_{field.name}", group="series", output=True)
            for field in self.series()
        ]

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        values = dict(self.values(state, interval))
        declared = {field.name for field in self.series()}
        if values.keys() != declared:
            found, expected = (", ".join(sorted(names)) for names in (values, declared))
            raise self.refusal(f"values of {found or 'nothing'}; expected {expected}", state)
        return {f"{self.title}_{name}": value for name, value in values.items()}


def empty_stencil(
    points: int, entries: int, dim: int, *, gradient: bool = True, uniform: bool = False
) -> Stencil:
    """Return an interpolation table of zeros for a number of ``points`` that touch ``entries`` nodes each.

    Surface nodes need no ``gradient``, (n entries, dim) [1/m], and get an array of length 0. Rows that are
    ``uniform`` must stay of that length, and are read faster."""
    return Stencil(
        row=np.arange(points + 1, dtype=np.int64) * entries,
        nodes=np.zeros(points * entries, dtype=np.int32),
        weight=np.zeros(points * entries),
        gradient=np.zeros((points * entries if gradient else 0, dim)),
        width=entries if uniform else 0,
    )


def check_inside(index: int) -> None:
    """Raise OutsideGrid for the ``index`` of a fill kernel unless it is −1; the core then lays the window
    anew."""
    if index >= 0:
        raise OutsideGrid(index)
