"""Bodies of a scene as material points and outlines, and checks of them at the start."""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.geometry import HalfSpace, Layout, discretise
from mpmfw.plugin.checks import described, raise_named
from mpmfw.runs.limits import check_box_inside
from mpmfw.scene.bodies import RigidBody
from mpmfw.state.fields import AFFINE_FIELD, MOMENT_FIELD, PARTICLE_FIELDS, FloatArray
from mpmfw.state.structs import Body, Particles, State, Stencil
from mpmfw.state.windows import overlapping
from mpmfw.step.transfer import Transfer

if TYPE_CHECKING:
    from mpmfw.plugin.base import Material
    from mpmfw.scene import Scene


def lay_out(scene: Scene) -> tuple[Layout, ...]:
    """Discretise the bodies; bodies that differ by their centres alone share one layout."""
    bodies = scene.bodies.values()
    kinds = Counter(type(body.geometry) for body in bodies)
    segments = [body.segment_length(scene.grid.cell_size) for body in bodies]
    alike = [_about_the_origin(body.geometry) if kinds[type(body.geometry)] > 1 else None for body in bodies]
    asked = [*zip(alike, (body.particles for body in bodies), segments, strict=True)]
    made, times, about_the_origin = [], Counter(asked), functools.cache(discretise)
    for (name, body), each in zip(scene.bodies.items(), asked, strict=True):
        geometry, particles, segment = each
        try:
            if geometry is None or times[each] == 1:
                made.append(discretise(_placed(body, scene), particles, segment))
            else:
                by = np.subtract(body.geometry.centroid, geometry.centroid)
                made.append(about_the_origin(geometry, particles, segment).moved(by))
        except ValueError as error:
            raise SceneError(str(error), key=f"bodies.{name}") from error
    return tuple(made)


def _about_the_origin(geometry: Any) -> Any:
    """Return a geometry that has a centre with that at the origin; None of others."""
    if "centre" not in type(geometry).model_fields:
        return None  # made anew: a copy has what the original has worked out
    keys = {key: getattr(geometry, key) for key in type(geometry).model_fields}
    return type(geometry)(**{**keys, "centre": (0.0,) * len(geometry.centre)})


def _placed(body: Any, scene: Scene) -> Any:
    """Return the geometry; a half-space is cut so that it covers the grid throughout the run."""
    geometry, grid = body.geometry, scene.grid
    if not isinstance(geometry, HalfSpace):
        return geometry
    from mpmfw.effects.rigid_kinematics import tables_of

    velocity, omega, _ = tables_of(body, scene.dim)
    moves = scene.time.end * float(np.linalg.norm(velocity.values, axis=1).max())
    if omega.values.any():  # about a point, round which the grid moves as the body sees it
        about = getattr(body.rigid.motion, "about", None) or geometry.point
        moves += 2.0 * float(np.linalg.norm(np.add(grid.lower, grid.upper) / 2.0 - about))
    return geometry.facing(grid.lower, np.add(grid.upper, grid.cell_size), moves)


def make_bodies(
    scene: Scene, layouts: tuple[Layout, ...], materials: dict[str, Material], *, per_body: bool
) -> tuple[Body, ...]:
    """Return the bodies, with a velocity field for each, or one for all."""
    bodies, start = [], 0
    moduli = {name: _moduli(material) for name, material in materials.items()}
    for index, ((name, model), layout) in enumerate(zip(scene.bodies.items(), layouts, strict=True)):
        count, rigid = len(layout.volume), isinstance(model, RigidBody)
        reach = np.abs(layout.half_edges).sum(axis=2)
        domains = [layout.position - reach, layout.position + reach]  # they bulge beyond an outline
        corners = np.concatenate(layout.outlines or domains)
        bulk_modulus, shear_modulus = (np.inf, 0.0) if rigid else moduli[model.material]
        bodies.append(
            Body(
                name=name,
                index=index,
                particles=slice(start, start + count),
                field=index if per_body else 0,
                density=np.inf if rigid else scene.materials[model.material].density,
                bulk_modulus=bulk_modulus,
                shear_modulus=shear_modulus,
                lower=tuple(corners.min(axis=0).tolist()),
                upper=tuple(corners.max(axis=0).tolist()),
                outlines=layout.outlines,
                facets=layout.facets,
                thickness=1.0 if model.thickness is None else model.thickness,
                rigid=rigid,
                prescribed=rigid and model.prescribed,
                width=model.geometry.width,
            )
        )
        start += count
    return tuple(bodies)


def _moduli(material: Material) -> tuple[float, float]:
    """Return K > 0 and G ≥ 0 of a material [Pa]; raise SceneError for others."""
    try:
        bulk, shear = material.bulk_modulus, material.shear_modulus
    except BaseException as error:
        raise_named(error, material, "its moduli")
    for name, value, low in (("bulk_modulus", bulk, "above"), ("shear_modulus", shear, "from")):
        number = isinstance(value, int | float | np.number)
        if not number or not 0.0 <= value < np.inf or (value == 0.0 and low == "above"):
            raise SceneError(f"{described(material)} has {name} {value!r}; expected a number {low} 0 in Pa")
    return float(bulk), float(shear)


def check_bodies(scene: Scene, layouts: tuple[Layout, ...], bodies: tuple[Body, ...]) -> None:
    """Refuse bodies that leave the grid, or overlap without permission."""
    for body, layout in zip(bodies, layouts, strict=True):
        if body.rigid:
            continue
        low = np.minimum(layout.position.min(axis=0), body.lower)
        high = np.maximum(layout.position.max(axis=0), body.upper)
        check_box_inside(scene, body.name, low, high)
    if not scene.allow_overlap:
        _check_overlap(bodies)


def _check_overlap(bodies: tuple[Body, ...]) -> None:
    """Refuse bodies that overlap by more than 1e-6 of the smaller one; two prescribed bodies may overlap.

    In space the overlap is the depth of nodes inside the other body."""
    if len(bodies) < 2 or any(not body.outlines for body in bodies):
        return
    lower, upper = (np.array([getattr(body, end) for body in bodies]) for end in ("lower", "upper"))
    first, second = overlapping(lower, upper)
    prescribed = np.array([body.prescribed for body in bodies])
    acting = ~(prescribed[first] & prescribed[second])
    first, second = first[acting], second[acting]
    if lower.shape[1] == 3:
        from mpmfw.state.surface import least_gaps, make_surface

        size, at, unit = (upper - lower).min(axis=1), " at one node", "m"
        common = -least_gaps(make_surface(bodies, 1, "gap"), first, second, (1.0, 1.0, 1.0))
    else:
        import shapely

        near, at, unit = np.union1d(first, second), "", "m²"
        regions = np.full(len(bodies), None, dtype=object)
        for index in near.tolist():  # a loop within another is a hole
            loops = map(shapely.Polygon, bodies[index].outlines)
            regions[index] = functools.reduce(shapely.symmetric_difference, loops)
        size, common = (
            shapely.area(regions),
            shapely.area(shapely.intersection(regions[first], regions[second])),
        )
    for pair in np.flatnonzero(common > 1e-6 * np.minimum(size[first], size[second]))[:1]:
        raise SceneError(
            f"overlaps body '{bodies[second[pair]].name}' by {common[pair]:.3g} {unit}{at} at the start; "
            "move them apart, or set allow_overlap = true",
            key=f"bodies.{bodies[first[pair]].name}",
        )


def make_particles(
    scene: Scene, layouts: tuple[Layout, ...], bodies: tuple[Body, ...], transfer: Transfer, n_fields: int
) -> Particles:
    """Return the material points of all bodies at rest."""
    volume, dim = np.concatenate([layout.volume for layout in layouts]), scene.dim
    sizes = {"particle": len(volume), "axis": dim, "axis2": dim}
    arrays: dict[str, Any] = {declared.name: declared.allocate(sizes) for declared in PARTICLE_FIELDS}
    arrays["position"][:] = np.concatenate([layout.position for layout in layouts])
    arrays["initial_volume"][:] = arrays["volume"][:] = volume
    arrays["deformation_gradient"][:] = np.eye(dim)
    for body in bodies:
        if not body.rigid:
            arrays["mass"][body.particles] = body.areal_density * volume[body.particles]
    thickness = None
    if any(body.thickness is not None for body in scene.bodies.values()):
        thickness = np.repeat([body.thickness for body in bodies], [len(layout.volume) for layout in layouts])
    if scene.grid.axisymmetric:
        thickness = 2.0 * np.pi * arrays["position"][:, 0]
        arrays["mass"] *= thickness
    starts = [body.particles.start for body in bodies] if n_fields == len(bodies) else [0]
    particles = Particles(
        **arrays,
        affine=AFFINE_FIELD.allocate(sizes) if transfer.affine is not None else None,
        moment=MOMENT_FIELD.allocate(sizes) if transfer.affine == "moment" else None,
        first=np.array([*starts, len(volume)], dtype=np.int64),
        thickness=thickness,
    )
    if scene.grid.axisymmetric:
        from mpmfw.effects.axisymmetry import SpacePoints

        particles.in_space = SpacePoints.of(particles)
    return particles


def initial_velocity(scene: Scene, state: State, interpolate: Callable[[], Stencil]) -> None:
    """Set v = v_0 + ω × (x − c) and the affine field of this motion on every body.

    A stored moment is B = W D, with D = Σ φ q qᵀ from the table φ of ``interpolate``."""
    p = state.particles
    spread = _spread(state, interpolate()) if p.moment is not None else None
    for body in state.soft_bodies:
        model, own = scene.bodies[body.name], body.particles
        if model.velocity is not None:
            p.velocity[own] += np.array(model.velocity)
        if model.angular_velocity is not None:
            from mpmfw.effects.rigid_kinematics import matrix_of

            spin = matrix_of(np.atleast_1d(np.array(model.angular_velocity, dtype=float)), scene.dim)
            centre = p.mass[own] @ p.position[own] / p.mass[own].sum()
            p.velocity[own] += (p.position[own] - centre) @ spin.T
            if p.affine is not None:
                p.affine[own] = spin
            if p.moment is not None and spread is not None:
                p.moment[own] = spin @ spread[own]


def _spread(state: State, phi: Stencil) -> FloatArray:
    """D_p = Σ_i φ_ip q qᵀ with q = x_i − x_p, (n, dim, dim) [m²]."""
    p = state.particles
    point = np.repeat(np.arange(p.count), np.diff(phi.row))
    q = state.grid.position[phi.nodes] - p.position[point]
    spread = np.zeros((p.count, p.dim, p.dim))
    np.add.at(spread, point, phi.weight[:, None, None] * q[:, :, None] * q[:, None, :])
    return spread
