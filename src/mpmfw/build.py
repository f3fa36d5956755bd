"""From a scene to the state and the plug-ins that act on it."""

from __future__ import annotations

import dataclasses
import functools
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.api import ContactStrategy, FrictionLaw, Material, ShapeFunction
from mpmfw.blame import distribution_text, refusing
from mpmfw.boundary import Boundary
from mpmfw.dead_hooks import refuse_dead_hooks
from mpmfw.discovery import Kind, full_name, load, object_of, refuse_nameless
from mpmfw.errors import SceneError
from mpmfw.fields import AFFINE_FIELD, MOMENT_FIELD, PARTICLE_FIELDS, IntArray
from mpmfw.geometry import BodyGeometry, Layout, discretise
from mpmfw.hookspecs import HookSpecs
from mpmfw.load import Load
from mpmfw.measure import Measure, Reference
from mpmfw.named import NamedPlugIn
from mpmfw.output_series import OutputSeries
from mpmfw.pairs import FEW, NearPairs, overlapping
from mpmfw.scene.options import NAMED
from mpmfw.sizing import check_box_inside, check_memory
from mpmfw.state import Body, Particles, State, joined
from mpmfw.transfer import Transfer, make_transfer
from mpmfw.windows import make_grid

if TYPE_CHECKING:
    from mpmfw.scene import Scene


@dataclass
class Build:
    """What a simulation is made of, before its plug-ins are set up."""

    scene: Scene
    layouts: tuple[Layout, ...]
    state: State
    shape: ShapeFunction
    contact: ContactStrategy | None
    materials: dict[str, Material]
    scheme: str
    transfer: Transfer
    bulk_frequency: float  #: largest 2 c / h over the bodies [1/s]
    friction_law: FrictionLaw | None = None  #: that the scene names
    #: Loads, boundary conditions and outputs by the scene's tables of them and its names.
    named: dict[str, dict[str, NamedPlugIn]] = field(default_factory=dict)
    whole: Build | None = None  #: of all bodies, where these are some of them (:func:`build_some`)

    @property
    def named_plugins(self) -> list[NamedPlugIn]:
        """All of them."""
        return [plugin for group in self.named.values() for plugin in group.values()]


def build(
    scene: Scene,
    contact: ContactStrategy | None = None,
    shape: ShapeFunction | None = None,
    loads: Mapping[str, Load] | None = None,
) -> Build:
    """Discretise the bodies and make the plug-ins that the scene names; objects take their place, ``loads`` stand beside.

    Raises
    ------
    SceneError
        A body is outside the grid, bodies overlap, or a method cannot run this scene, or anything.
    """
    chosen_shape = shape or _plugin("shape", scene.shape.method, scene.shape.options)
    chosen_contact = contact
    if chosen_contact is None and scene.contact is not None:
        chosen_contact = _plugin("contact", scene.contact.method, scene.contact.options)
    if len(scene.bodies) == 1:
        _check_unused_contact(scene, contact)
        chosen_contact = None
    _check_methods(scene, chosen_shape, chosen_contact)
    check_memory(scene)
    layouts = _layouts(scene)
    materials = {
        name: _plugin("material", scene.materials[name].model, scene.materials[name].options)
        for name in dict.fromkeys(body.material for body in scene.bodies.values())
    }
    per_body = chosen_contact is not None and chosen_contact.velocity_fields == "per_body"
    bodies = _bodies(scene, layouts, materials, per_body=per_body)
    _check_inside(scene, layouts, bodies)
    if not scene.allow_overlap:
        _check_overlap(bodies)
    return _put_together(scene, layouts, bodies, chosen_shape, chosen_contact, materials, loads or {})


def build_some(made: Build, which: Sequence[int]) -> Build:
    """Some of the bodies as they were at the start, by themselves; methods are made anew of the same options.

    One body alone has no contact.
    What all bodies together decide stays: the largest wave speed, whether there is friction, and whether surfaces are tracked.
    """

    def again(plugin: Any) -> Any:
        return None if plugin is None else type(plugin).from_options(plugin.options)

    names = [made.state.bodies[index].name for index in which]
    scene = made.scene.of_bodies(names)
    used = dict.fromkeys(scene.bodies[name].material for name in names)
    shape, contact = again(made.shape), again(made.contact) if len(names) > 1 else None
    materials = {name: again(made.materials[name]) for name in used}
    layouts = tuple(made.layouts[index] for index in which)
    bodies = _bodies(scene, layouts, materials, per_body=True)
    some = _put_together(scene, layouts, bodies, shape, contact, materials, {})
    return dataclasses.replace(some, bulk_frequency=made.bulk_frequency, whole=made)


def _put_together(
    scene: Scene,
    layouts: tuple[Layout, ...],
    bodies: tuple[Body, ...],
    chosen_shape: ShapeFunction,
    chosen_contact: ContactStrategy | None,
    materials: dict[str, Material],
    loads: Mapping[str, Load],
) -> Build:
    """The state of the bodies, and what moves them, of methods that are made."""
    per_body = chosen_contact is not None and chosen_contact.velocity_fields == "per_body"
    scheme, name = scene.stepping.chosen(chosen_shape)
    transfer = make_transfer(
        name,
        singular_spread=chosen_shape.singular_spread,
        transported=scene.stepping.transported,
        pic_fraction=scene.stepping.pic_fraction,
    )
    n_fields = len(bodies) if per_body else 1
    grid = make_grid(scene.grid.cell_size, np.array(scene.grid.lower), np.array(scene.grid.upper), n_fields)
    particles = _particles(scene, layouts, bodies, transfer, n_fields)
    for body in bodies:
        material = materials[scene.bodies[body.name].material]
        material.slices = joined(material.slices, body.particles)
    state = State(particles, grid, bodies, ())
    friction, named = _friction_law(scene, chosen_contact), _named(scene, bodies, loads)
    _list_pairs(scene, state, chosen_contact, friction)
    fastest = max(2.0 * body.wave_speed / grid.cell_size for body in bodies)
    return Build(
        scene,
        layouts,
        state,
        chosen_shape,
        chosen_contact,
        materials,
        scheme,
        transfer,
        fastest,
        friction,
        named,
    )


def _named(
    scene: Scene, bodies: tuple[Body, ...], loads: Mapping[str, Load]
) -> dict[str, dict[str, NamedPlugIn]]:
    """The plug-ins with tables that the scene names, told what they are called and which bodies they concern."""
    made: dict[str, dict[str, NamedPlugIn]] = {}
    for group in ("loads", "boundaries", "outputs"):
        made[group] = {}
        for name, table in getattr(scene, group).items():
            plugin: NamedPlugIn = _plugin(NAMED[group], table.model, table.options)
            if scene.dim not in plugin.dimensions:
                works = " and ".join(f"{d}D" for d in plugin.dimensions)
                raise SceneError(
                    f"{group}.{name}: {plugin.name} works in {works}; the scene's grid is {scene.dim}D"
                )
            plugin.title = name
            plugin.bodies = tuple(b for b in bodies if table.bodies is None or b.name in table.bodies)
            made[group][name] = plugin
    for name, given in loads.items():
        given.title, given.bodies = name, bodies
        made["loads"][name] = given
    return made


def _friction_law(scene: Scene, contact: ContactStrategy | None) -> FrictionLaw | None:
    """The scene's, if contact takes any."""
    given = scene.contact
    if given is None or given.friction_law is None or contact is None or not contact.takes_friction_law:
        return None
    law: FrictionLaw = _plugin("friction", given.friction_law, given.friction_options)
    return law


def _plugin(kind: Any, name: str, options: Any) -> Any:
    """Import and make one plug-in."""
    plugin = load(kind, name)
    _check_base(kind, plugin)
    with refusing(
        f"{kind} plug-in '{name}' of {distribution_text(plugin)} cannot be made from the scene's options"
    ):
        given = options is not None and hasattr(plugin, "from_options")
        return plugin.from_options(options) if given else plugin()


#: Base classes of what a scene names.
BASES: dict[Kind, type[Any]] = {
    "contact": ContactStrategy, "friction": FrictionLaw, "shape": ShapeFunction, "material": Material, "load": Load,
    "boundary": Boundary, "output": OutputSeries, "geometry": BodyGeometry, "measure": Measure, "reference": Reference,
}  # fmt: skip


def strategy(kind: Kind, given: Any) -> Any:
    """What was given for a method: None, a name or a strategy object as it is, of a class an object without options.

    Raises
    ------
    SceneError
        It is of another kind, or the class cannot be made without options.
    """
    if given is None or isinstance(given, (str, BASES[kind])):
        return given
    if not isinstance(given, type):
        raise SceneError(
            f"{kind}: found {given!r}; expected a name, module:Class, or a class derived from "
            f"mpmfw.api.{BASES[kind].__name__} or an object of one"
        )
    _check_base(kind, given)
    return object_of(given)


def _check_base(kind: Kind, plugin: type[Any]) -> None:
    """Refuse a class of another kind."""
    base = BASES[kind]
    if not issubclass(plugin, base):
        raise SceneError(
            f"{kind} plug-in {full_name(plugin)} of {distribution_text(plugin)}: expected a class derived from "
            f"mpmfw.api.{base.__name__}"
        )


def _list_pairs(scene: Scene, state: State, contact: ContactStrategy | None, law: FrictionLaw | None) -> None:
    """All pairs of bodies; of more than a few those that the scene names, if the strategy takes the others as they come."""
    index = {body.name: body.index for body in state.bodies}
    friction = 0.0 if scene.contact is None else scene.contact.friction
    named = () if scene.contact is None else scene.contact.pairs
    ends = [sorted(index[name] for name in pair.bodies) for pair in named]
    given = {(a, b): float(pair.friction) for (a, b), pair in zip(ends, named, strict=True)}
    by_law = None if law is None or law.is_coulomb else law.label
    near = NearPairs(tuple(index), float(friction), given, by_law)
    hooks = [name for name in vars(HookSpecs) if not name.startswith("_")]
    follows = hasattr(contact, "add_pairs") or not any(hasattr(contact, name) for name in hooks)
    if len(index) <= FEW or not follows:
        near.add(state, *np.triu_indices(len(index), 1))
    else:
        first, second = (np.array([end[k] for end in ends], dtype=np.int64) for k in (0, 1))
        near.add(state, first, second)
        state.near = near


def _check_unused_contact(scene: Scene, contact: ContactStrategy | None) -> None:
    """Refuse options of the scene's contact, and a friction law, where there is one body and so nothing to touch."""
    given = scene.contact
    if contact is not None or given is None:
        return
    options = () if given.options is None else sorted(given.options.model_fields_set)
    keys = [f"{given.method}.{option}" for option in options]
    if given.friction_law is not None:
        keys.append("friction_law")
    if keys:
        raise SceneError(f"contact.{keys[0]}: has no effect, since the scene has one body only")


def _check_methods(scene: Scene, shape: ShapeFunction, contact: ContactStrategy | None) -> None:
    chosen: dict[Kind, Any] = {"shape": shape}
    if contact is not None:
        chosen["contact"] = contact
    for kind, plugin in chosen.items():
        _check_base(kind, type(plugin))
        refuse_nameless(type(plugin))
        refuse_dead_hooks(type(plugin))
        if scene.dim not in plugin.dimensions:
            works = " and ".join(f"{d}D" for d in plugin.dimensions)
            raise SceneError(f"{kind} '{plugin.name}' works in {works}; the scene's grid is {scene.dim}D")


def _layouts(scene: Scene) -> tuple[Layout, ...]:
    """Of bodies that are alike but for their centres one is discretised, about the origin, and moved to each centre."""
    asked = [_alike(body, scene) for body in scene.bodies.values()]
    made, times, about_the_origin = [], Counter(asked), functools.cache(discretise)
    for (name, body), alike in zip(scene.bodies.items(), asked, strict=True):
        geometry, particles, segment = alike
        try:
            if geometry is None or times[alike] == 1:
                made.append(discretise(body.geometry, particles, segment))
            else:
                by = np.subtract(body.geometry.centroid, geometry.centroid)
                made.append(about_the_origin(geometry, particles, segment).moved(by))
        except ValueError as error:
            raise SceneError(f"bodies.{name}: {error}") from error
    return tuple(made)


def _alike(body: Any, scene: Scene) -> tuple[Any, Any, float]:
    """What bodies that differ by their centres alone have in common: the geometry about the origin, None if it has no
    centre, the division into points, and the length of a segment."""
    centre, geometry = getattr(body.geometry, "centre", None), None
    if centre is not None:  # made anew: a copy would have what the original has worked out
        geometry = type(body.geometry)(**{**dict(body.geometry), "centre": (0.0,) * len(centre)})
    return geometry, body.particles, body.segment_length(scene.grid.cell_size)


def _bodies(
    scene: Scene, layouts: tuple[Layout, ...], materials: dict[str, Material], *, per_body: bool
) -> tuple[Body, ...]:
    bodies, start = [], 0
    for index, (name, model) in enumerate(scene.bodies.items()):
        layout, material = layouts[index], materials[model.material]
        count = len(layout.volume)
        corners = np.concatenate([layout.position, *layout.outlines])
        reach = np.abs(layout.half_edges).sum(axis=2)
        lower = np.minimum(corners.min(axis=0), (layout.position - reach).min(axis=0))
        upper = np.maximum(corners.max(axis=0), (layout.position + reach).max(axis=0))
        if layout.outlines:  # the true outline, not the particles' bulge beyond it
            nodes = np.concatenate(layout.outlines)
            lower, upper = nodes.min(axis=0), nodes.max(axis=0)
        bodies.append(
            Body(
                name=name,
                index=index,
                particles=slice(start, start + count),
                field=index if per_body else 0,
                density=scene.materials[model.material].density,
                bulk_modulus=material.bulk_modulus,
                shear_modulus=material.shear_modulus,
                lower=tuple(lower.tolist()),
                upper=tuple(upper.tolist()),
                outlines=layout.outlines,
                facets=layout.facets,
                thickness=1.0 if model.thickness is None else model.thickness,
            )
        )
        start += count
    return tuple(bodies)


def _check_inside(scene: Scene, layouts: tuple[Layout, ...], bodies: tuple[Body, ...]) -> None:
    for body, layout in zip(bodies, layouts, strict=True):
        low = np.minimum(layout.position.min(axis=0), body.lower)
        high = np.maximum(layout.position.max(axis=0), body.upper)
        check_box_inside(scene, body.name, low, high)


def _check_overlap(bodies: tuple[Body, ...]) -> None:
    """Refuse bodies whose surfaces overlap by more than rounding."""
    if len(bodies) < 2 or any(not body.outlines for body in bodies):
        return
    boxes = (np.array([body.lower for body in bodies]), np.array([body.upper for body in bodies]))
    first, second = overlapping(*boxes)
    if boxes[0].shape[1] == 3:
        _check_depth(bodies, first, second)
        return
    import shapely

    near = np.union1d(first, second)
    regions = np.array([_area(bodies[index], shapely) for index in near.tolist()], dtype=object)
    one, other = (regions[np.searchsorted(near, index)] for index in (first, second))
    common = shapely.area(shapely.intersection(one, other))
    too_much = np.flatnonzero(common > 1e-6 * np.minimum(shapely.area(one), shapely.area(other)))
    for pair in too_much[:1]:
        raise SceneError(
            f"bodies.{bodies[first[pair]].name} and bodies.{bodies[second[pair]].name} overlap by {common[pair]:.3g} m² at "
            "the start; move them apart, or say allow_overlap = true"
        )


def _check_depth(bodies: tuple[Body, ...], first: IntArray, second: IntArray) -> None:
    """Refuse bodies in space that have nodes inside each other, by more than 1e-6 of the smaller body's size."""
    from mpmfw.effects.surface import least_gaps, make_surface

    gaps = least_gaps(make_surface(bodies, 1, "gap"), first, second, (1.0, 1.0, 1.0))
    size = [min(np.subtract(body.upper, body.lower)) for body in bodies]
    for a, b, gap in zip(first.tolist(), second.tolist(), gaps, strict=True):
        if gap < -1e-6 * min(size[a], size[b]):
            raise SceneError(
                f"bodies.{bodies[a].name} and bodies.{bodies[b].name} overlap at the start, by {-gap:.3g} m at one node; "
                "move them apart, or say allow_overlap = true"
            )


def _area(body: Body, shapely: Any) -> Any:
    """The body's region as a shapely geometry; loops that run clockwise are holes."""
    if len(body.outlines) == 1:
        return shapely.Polygon(body.outlines[0])
    region = shapely.MultiPolygon()
    loops = [shapely.Polygon(loop) for loop in body.outlines]
    for loop, polygon in zip(body.outlines, loops, strict=True):
        if shapely.LinearRing(loop).is_ccw:
            region = shapely.union(region, polygon)
    for loop, polygon in zip(body.outlines, loops, strict=True):
        if not shapely.LinearRing(loop).is_ccw:
            region = shapely.difference(region, polygon)
    return region


def _particles(
    scene: Scene, layouts: tuple[Layout, ...], bodies: tuple[Body, ...], transfer: Transfer, n_fields: int
) -> Particles:
    volume = np.concatenate([layout.volume for layout in layouts])
    sizes = {"particle": len(volume), "axis": scene.dim, "axis2": scene.dim}
    arrays: dict[str, Any] = {declared.name: declared.allocate(sizes) for declared in PARTICLE_FIELDS}
    arrays["position"][:] = np.concatenate([layout.position for layout in layouts])
    arrays["initial_volume"][:] = arrays["volume"][:] = volume
    arrays["deformation_gradient"][:] = np.eye(scene.dim)
    for body in bodies:
        arrays["mass"][body.particles] = body.areal_density * volume[body.particles]
    thickness = None
    if any(body.thickness is not None for body in scene.bodies.values()):
        thickness = np.repeat([body.thickness for body in bodies], [len(layout.volume) for layout in layouts])
    starts = [body.particles.start for body in bodies] if n_fields == len(bodies) else [0]
    return Particles(
        **arrays,
        affine=AFFINE_FIELD.allocate(sizes) if transfer.affine is not None else None,
        moment=MOMENT_FIELD.allocate(sizes) if transfer.affine == "moment" else None,
        first=np.array([*starts, len(volume)], dtype=np.int64),
        thickness=thickness,
    )
