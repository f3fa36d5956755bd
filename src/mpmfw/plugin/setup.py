"""The scene as it is built: bodies, methods, and the effects that act."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.scene.bodies import AXIS, UPPER
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Body, Pair, State

if TYPE_CHECKING:
    from mpmfw.contact.rows import FrictionLaw
    from mpmfw.contact.strategy import ContactStrategy
    from mpmfw.geometry import Layout
    from mpmfw.plugin.base import Material, NamedPlugIn, ShapeFunction
    from mpmfw.scene import Scene
    from mpmfw.scene.bodies import Side
    from mpmfw.step.transfer import Transfer


#: Distance within which an outline lies on a side [cells].
FLAT = 1e-6

#: K / G above which a body locks: that of ν = 0.4.
INCOMPRESSIBLE = 14.0 / 3.0


@dataclass(frozen=True, slots=True)
class Effect:
    """One effect: on or off, with its reason."""

    name: str
    on: bool
    reason: str


@dataclass(frozen=True, slots=True)
class Acts:
    """An effect that acts: why, and its plug-ins in the order of calls."""

    reason: str
    plugins: Sequence[Any] = ()
    lines: Sequence[Effect] = ()  #: further lines of ``mpmfw explain``


@dataclass
class Setup:
    """The scene after discretisation: facts, arrays and effects."""

    state: State  #: of time zero
    layouts: tuple[Layout, ...] = ()  #: of each body
    shape: str = "none"  #: name of the shape function
    massless_boundary: bool = False  #: the shape function leaves boundary nodes without mass (linear, GIMP)
    scheme: str = "usl"  #: usl, musl or usf
    transfer: str = "flip"  #: flip, pic, apic, tpic or aflip
    flip: float = 1.0  #: share of FLIP in the transfer
    bulk_frequency: float = 1.0  #: largest of 2 c / h over the bodies, of thin ones 2 c / √(h w) [1/s]
    safety: float = 0.5  #: fraction of the stability limit that a step may take
    allow_unstable: bool = False  #: the scene lets a step exceed the stability limit
    friction_law: FrictionLaw | None = None  #: that the scene names; None is Coulomb's
    whole: Setup | None = None  #: that of all bodies, where these are some

    # The core's own, which a plug-in alone on a bench has not:
    scene: Scene = None  # type: ignore[assignment]
    shape_function: ShapeFunction = None  # type: ignore[assignment]
    contact: ContactStrategy | None = None
    materials: dict[str, Material] = field(default_factory=dict)
    exchange: Transfer = None  # type: ignore[assignment]
    named: dict[str, dict[str, NamedPlugIn]] = field(default_factory=dict)  #: by table of the scene and name
    limits: Callable[[], list[tuple[float, str]]] = list  #: every stable time step [s] with its owner
    effects: list[Effect] = field(default_factory=list)  #: all of them, on and off
    plugins: list[Any] = field(default_factory=list)  #: that act, in the order of their calls
    rotations: dict[str, str] = field(default_factory=dict)  #: how every body's inertia is treated

    @functools.cached_property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies, in the scene's order."""
        return self.state.bodies

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """All pairs of bodies; of many bodies those that are near or named."""
        return self.state.pairs

    @functools.cached_property
    def has_friction(self) -> bool:
        """True if any two bodies have friction, their pair listed or not."""
        if self.whole is not None:
            return self.whole.has_friction
        if self.friction_law is not None and self.friction_law.cohesive:
            return True
        near = self.state.near
        listed = [pair.mu for pair in self.state.pairs]
        return any(mu > 0.0 for mu in (listed if near is None else [near.friction, *near.given.values()]))

    @functools.cached_property
    def dim(self) -> int:
        """Number of space dimensions."""
        return self.state.grid.dim

    @functools.cached_property
    def cell_size(self) -> float:
        """Edge of a cell, h [m]."""
        return self.state.grid.cell_size

    @functools.cached_property
    def field_per_body(self) -> bool:
        """True if every body has a velocity field."""
        return self.state.grid.n_fields == len(self.bodies)

    @functools.cached_property
    def held_sides(self) -> list[tuple[Body, Side]]:
        """Bodies and their sides whose motion is prescribed."""
        return [each for each in self._sides if not each[1].is_loaded]

    @functools.cached_property
    def loaded_sides(self) -> list[tuple[Body, Side]]:
        """Bodies and their sides under a load."""
        return [each for each in self._sides if each[1].is_loaded]

    @functools.cached_property
    def averaged_bodies(self) -> list[Body]:
        """Bodies whose change of volume is averaged over cells: as the scene says, or where bodies lock."""
        how = {body.index: self.scene.bodies[body.name].volumetric for body in self.bodies}
        return [
            body
            for body in self.bodies
            if how[body.index] == "averaged" or (how[body.index] == "auto" and self._locks(body))
        ]

    def material_of(self, body: Body) -> Material:
        """Return the material of a body that has points."""
        return self.materials[self.scene.bodies[body.name].material]

    def _locks(self, body: Body) -> bool:
        """Return True if points of the body keep their volume. With B-splines bodies do not lock, and a mean
        would make them too soft."""
        if self.scene.bodies[body.name].self_contact:
            return False  # averages of cells would join its parts
        keeps_volume = (
            self.material_of(body).isochoric or body.bulk_modulus > INCOMPRESSIBLE * body.shear_modulus
        )
        return keeps_volume and self.shape_function.boundary_degree == 1

    @property
    def _sides(self) -> list[tuple[Body, Side]]:
        return [(body, side) for body in self.bodies for side in self.scene.bodies[body.name].sides]

    def face_of(self, body: Body, side: Side) -> tuple[FloatArray, float]:
        """Return the outward unit normal n of a side, and n·x on it [m]."""
        axis = self.scene.bodies[body.name].geometry.axes[AXIS[side.side]]
        normal = axis if side.side in UPPER else -1.0 * axis
        if body.outlines:
            return normal, max(float((loop @ normal).max()) for loop in body.outlines)
        return normal, float(np.maximum(normal * body.lower, normal * body.upper).sum())

    @property
    def named_plugins(self) -> list[NamedPlugIn]:
        """Loads, boundary conditions and outputs."""
        return [plugin for group in self.named.values() for plugin in group.values()]

    @functools.cached_property
    def contact_fields(self) -> list[str]:
        """Names of the fields that the contact declares."""
        declare = getattr(self.contact, "declare_fields", list)
        return [field.name for field in declare()]

    @functools.cached_property
    def surface_users(self) -> list[str]:
        """Parts of the run that need tracked surfaces."""
        contact, whole = self.contact, self.whole
        return [
            *([f"contact '{contact.name}'"] if contact is not None and contact.needs_surface else []),
            *(["loads on sides"] if self.loaded_sides else []),
            *(f"'{plugin.title}'" for plugin in self.named_plugins if plugin.needs_surface),
            *(["rigid bodies"] if any(body.rigid for body in self.bodies) else []),
            *(["min_gap"] if self.scene.output.gap and (len(self.bodies) > 1 or self.pairs) else []),
            *(["all bodies"] if whole is not None and whole.state.surface is not None else []),
        ]

    @functools.cached_property
    def remedies(self) -> dict[str, str]:
        """Advice for a run that fails, by the part that it changes."""
        found = {"step": f"a smaller {'time.safety' if self.scene.time.step is None else 'time.step'}"}
        if self.scheme != "usl" and self.shape != "linear":  # which needs MUSL
            found["scheme"] = "scheme 'usl'"
        if self.contact is not None:
            key = self.contact.softer_by
            found["contact"] = "another contact" if key is None else f"a softer contact ({key})"
        return {**found, "shape": f"another shape than '{self.shape}'"}

    def plugin(self, name: str) -> Any:
        """Return the plug-in of a name, or None."""
        return next((plugin for plugin in self.plugins if plugin.name == name), None)

    @functools.cached_property
    def half_edges(self) -> FloatArray:
        """Half-edge vectors r_a of domains at the start, (n, dim, dim) [m], as columns."""
        array = np.ascontiguousarray(np.concatenate([layout.half_edges for layout in self.layouts]))
        self.state.arrays["layout/half_edges"] = array
        return array

    @functools.cached_property
    def corners(self) -> FloatArray | None:
        """Corners of four-sided domains at the start, (n, 4, 2) [m], or None."""
        if any(layout.corners is None for layout in self.layouts):
            return None
        return np.concatenate([layout.corners for layout in self.layouts if layout.corners is not None])

    def allocate(self, owner: str, declaration: Field, **sizes: int) -> AnyArray:
        """Return a new array of a declared field, all zero, and list it under ``owner/name``.

        ``sizes`` are the lengths of dimensions beside particle, axis, axis2, body, pair and surface_node."""
        state = self.state
        lengths = {
            "particle": len(state.particles.mass),
            "axis": self.dim,
            "axis2": self.dim,
            "body": len(state.bodies),
            "pair": len(state.pairs),
            "surface_node": 0 if state.surface is None else len(state.surface.tributary),
        }
        lengths |= sizes
        array = np.zeros([lengths[dim] for dim in declaration.dims], dtype=declaration.dtype)
        state.arrays[f"{owner}/{declaration.name}"] = array
        state.dims[f"{owner}/{declaration.name}"] = declaration.dims
        return array
