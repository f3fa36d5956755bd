"""From a scene to its bodies and methods, the :class:`mpmfw.plugin.setup.Setup`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.contact.rows import FrictionLaw
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import SceneError
from mpmfw.geometry import BodyGeometry, Layout
from mpmfw.plugin.base import Material, ShapeFunction
from mpmfw.plugin.boundary import Boundary
from mpmfw.plugin.checks import distribution_text, naming
from mpmfw.plugin.discovery import Kind, full_name, load, object_of, refuse_nameless
from mpmfw.plugin.hooks import HOOKS
from mpmfw.plugin.load import Load
from mpmfw.plugin.measure import Measure, Reference
from mpmfw.plugin.named import NamedPlugIn, OutputSeries
from mpmfw.plugin.setup import Setup
from mpmfw.runs.bodies import check_bodies, lay_out, make_bodies, make_particles
from mpmfw.runs.limits import check_memory
from mpmfw.scene.options import NAMED
from mpmfw.state.pairs import FEW, BodyPairs
from mpmfw.state.structs import Body, State
from mpmfw.state.windows import make_grid
from mpmfw.step.timestep import stable_length
from mpmfw.step.transfer import make_transfer

if TYPE_CHECKING:
    from mpmfw.scene import Scene

#: Base classes of what a scene names.
BASES: dict[Kind, type[Any]] = {
    "contact": ContactStrategy, "friction": FrictionLaw, "shape": ShapeFunction, "material": Material,
    "load": Load,
    "boundary": Boundary, "output": OutputSeries, "geometry": BodyGeometry, "measure": Measure,
    "reference": Reference,
}  # fmt: skip


def build(
    scene: Scene,
    contact: ContactStrategy | None = None,
    shape: ShapeFunction | None = None,
    loads: Mapping[str, Load] | None = None,
) -> Setup:
    """Discretise the bodies and make the plug-ins that the scene names.

    Objects replace the scene's methods, and ``loads`` come on top. Raise SceneError if bodies overlap or
    leave the grid, or if a method cannot run this scene."""
    chosen_shape = shape or _plugin("shape", scene.shape.method, scene.shape.options)
    _check_dimensions(scene, chosen_shape, "shape.method")
    chosen_contact = contact
    if len(scene.bodies) == 1:
        _check_unused_contact(scene, contact)
        chosen_contact = None
    elif contact is None and scene.contact is not None:
        chosen_contact = _plugin("contact", scene.contact.method, scene.contact.options)
    if chosen_contact is not None:
        _check_dimensions(scene, chosen_contact, "contact.method")
    check_memory(scene)
    layouts = lay_out(scene)
    materials = {
        name: _plugin("material", scene.materials[name].model, scene.materials[name].options)
        for name in dict.fromkeys(body.material for body in scene.bodies.values())
    }
    setup = _put_together(scene, layouts, chosen_shape, chosen_contact, materials, loads or {})
    check_bodies(scene, layouts, setup.bodies)
    return setup


def build_some(whole: Setup, which: Sequence[int]) -> Setup:
    """Build some of the bodies as they were at the start; methods are made anew of the same options.

    One body alone has no contact. All bodies together decide the largest wave speed, whether there is
    friction, and whether surfaces are tracked."""

    def again(plugin: Any) -> Any:
        return None if plugin is None else type(plugin).from_options(plugin.options)

    names = [whole.bodies[index].name for index in which]
    scene = whole.scene.of_bodies(names)
    used = dict.fromkeys(scene.bodies[name].material for name in names)
    shape, contact = again(whole.shape_function), again(whole.contact) if len(names) > 1 else None
    materials = {name: again(whole.materials[name]) for name in used}
    layouts = tuple(whole.layouts[index] for index in which)
    return _put_together(scene, layouts, shape, contact, materials, {}, whole)


def _put_together(
    scene: Scene,
    layouts: tuple[Layout, ...],
    shape: ShapeFunction,
    contact: ContactStrategy | None,
    materials: dict[str, Material],
    loads: Mapping[str, Load],
    whole: Setup | None = None,
) -> Setup:
    """Make the bodies and their state, of methods that are made; ``whole`` has all bodies if these are
    some."""
    per_body = whole is not None or (contact is not None and contact.velocity_fields == "per_body")
    bodies = make_bodies(scene, layouts, materials, per_body=per_body)
    scheme, name = scene.stepping.chosen(shape)
    transfer = make_transfer(
        name,
        singular_spread=shape.singular_spread,
        transported=scene.stepping.transported,
        pic_fraction=scene.stepping.pic_fraction,
    )
    n_fields = len(bodies) if per_body else 1
    grid = make_grid(scene.grid.cell_size, np.array(scene.grid.lower), np.array(scene.grid.upper), n_fields)
    particles = make_particles(scene, layouts, bodies, transfer, n_fields)
    for body in bodies:
        material = materials[scene.bodies[body.name].material]
        material.slices = joined(material.slices, body.particles)
    cell, of = scene.grid.cell_size, scene.bodies
    frequencies = [2.0 * b.wave_speed / stable_length(cell, of[b.name].geometry.width) for b in bodies]
    setup = Setup(
        State(particles, grid, bodies, ()),
        layouts,
        shape=shape.name,
        massless_boundary=shape.massless_boundary,
        scheme=scheme,
        transfer=transfer.name,
        flip=transfer.flip,
        bulk_frequency=max(frequencies) if whole is None else whole.bulk_frequency,
        safety=scene.time.safety,
        allow_unstable=scene.allow_unstable,
        friction_law=_friction_law(scene, contact),
        whole=whole,
        scene=scene,
        shape_function=shape,
        contact=contact,
        materials=materials,
        exchange=transfer,
        named=_named(scene, bodies, loads),
        plugins=[*materials.values(), shape],
    )
    _list_pairs(scene, setup.state, contact, setup.friction_law)
    return setup


def _named(
    scene: Scene, bodies: tuple[Body, ...], loads: Mapping[str, Load]
) -> dict[str, dict[str, NamedPlugIn]]:
    """Return the plug-ins with tables that the scene names, by table and name; each gets its title and its
    bodies.
    """
    made: dict[str, dict[str, NamedPlugIn]] = {}
    for group in ("loads", "boundaries", "outputs"):
        made[group] = {}
        for name, table in getattr(scene, group).items():
            plugin: NamedPlugIn = _plugin(NAMED[group], table.model, table.options)
            _check_dimensions(scene, plugin, f"{group}.{name}")
            plugin.title = name
            plugin.bodies = tuple(b for b in bodies if table.bodies is None or b.name in table.bodies)
            made[group][name] = plugin
    for name, given in loads.items():
        given.title, given.bodies = name, bodies
        made["loads"][name] = given
    return made


def _friction_law(scene: Scene, contact: ContactStrategy | None) -> FrictionLaw | None:
    """Return the scene's, if contact takes any."""
    given = scene.contact
    if given is None or given.friction_law is None or contact is None or not contact.takes_friction_law:
        return None
    law: FrictionLaw = _plugin("friction", given.friction_law, given.friction_options)
    return law


def _plugin(kind: Any, name: str, options: Any) -> Any:
    """Import and make one plug-in."""
    plugin = load(kind, name)
    _check_base(kind, plugin)
    with naming(plugin, "its constructor"):
        given = options is not None and hasattr(plugin, "from_options")
        return plugin.from_options(options) if given else plugin()


def strategy(kind: Kind, given: Any) -> Any:
    """Return a method as it was given: None, a name, or a strategy object, which a class is made into."""
    if given is None or isinstance(given, str):
        return given
    if not isinstance(given, (type, BASES[kind])):
        raise SceneError(
            f"{kind}: found {given!r}; expected a name, module:Class, or a class derived from "
            f"mpmfw.api.{BASES[kind].__name__} or an object of one"
        )
    _check_base(kind, given if isinstance(given, type) else type(given))
    refuse_nameless(given if isinstance(given, type) else type(given))
    return object_of(given)


def _check_base(kind: Kind, plugin: type[Any]) -> None:
    """Refuse a class of another kind."""
    base = BASES[kind]
    if not issubclass(plugin, base):
        raise SceneError(
            f"{kind} plug-in {full_name(plugin)} of {distribution_text(plugin)}: expected a class derived "
            f"from mpmfw.api.{base.__name__}"
        )


def _check_dimensions(scene: Scene, plugin: Any, key: str) -> None:
    """Refuse a plug-in that does not work in the scene's dimensions."""
    if scene.dim not in plugin.dimensions:
        works = " and ".join(f"{d}D" for d in plugin.dimensions)
        note = f" ({plugin.dimensions_note})" if plugin.dimensions_note else ""
        raise SceneError(f"'{plugin.name}' works in {works}{note}; the scene's grid is {scene.dim}D", key=key)


def _list_pairs(scene: Scene, state: State, contact: ContactStrategy | None, law: FrictionLaw | None) -> None:
    """All pairs of bodies; of more than a few those that the scene names, if the strategy takes the others as
    they come.
    """
    index = {body.name: body.index for body in state.bodies}
    friction = 0.0 if scene.contact is None else scene.contact.friction
    named = () if scene.contact is None else scene.contact.pairs
    ends = [sorted(index[name] for name in pair.bodies) for pair in named]
    given = {(a, b): float(pair.friction) for (a, b), pair in zip(ends, named, strict=True)}
    by_law = None if law is None or law.is_coulomb else law.label
    near = BodyPairs(tuple(index), float(friction), given, by_law)
    follows = hasattr(contact, "add_pairs") or not any(hasattr(contact, name) for name in HOOKS)
    if len(index) <= FEW or not follows:
        near.add(state, *np.triu_indices(len(index), 1))
    else:
        first, second = (np.array([end[k] for end in ends], dtype=np.int64) for k in (0, 1))
        near.add(state, first, second)
        state.near = near


def _check_unused_contact(scene: Scene, contact: ContactStrategy | None) -> None:
    """Refuse options of the scene's contact, and a friction law, where there is one body and so nothing to
    touch.
    """
    given = scene.contact
    if contact is not None or given is None:
        return
    options = () if given.options is None else sorted(given.options.model_fields_set)
    keys = [f"{given.method}.{option}" for option in options]
    if given.friction_law is not None:
        keys.append("friction_law")
    if keys:
        raise SceneError("has no effect, since the scene has one body only", key=f"contact.{keys[0]}")


def joined(slices: tuple[slice, ...], own: slice) -> tuple[slice, ...]:
    """Return the slices and one more; neighbours become one slice, and take one call of a kernel."""
    if slices and slices[-1].stop == own.start:
        return (*slices[:-1], slice(slices[-1].start, own.stop))
    return (*slices, own)
