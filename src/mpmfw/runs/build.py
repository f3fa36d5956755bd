"""Build bodies, methods and effects of a scene, the :class:`mpmfw.plugin.setup.Setup`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mpmfw.contact.rows import FrictionLaw
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import SceneError
from mpmfw.geometry import BodyGeometry, Layout
from mpmfw.plugin.base import Material, NamedPlugIn, OutputSeries, ShapeFunction
from mpmfw.plugin.checks import distribution_text, raise_named
from mpmfw.plugin.discovery import Kind, full_name, load, object_of, refuse_nameless
from mpmfw.plugin.hooks import HOOKS
from mpmfw.plugin.load import Boundary, Load
from mpmfw.plugin.measure import Measure, Reference
from mpmfw.plugin.setup import Setup
from mpmfw.runs.bodies import check_bodies, lay_out, make_bodies, make_particles
from mpmfw.runs.effects import add_effects
from mpmfw.runs.limits import check_memory
from mpmfw.scene import Scene, load_scene
from mpmfw.scene.options import NAMED
from mpmfw.state.structs import Body, State
from mpmfw.state.windows import FEW, BodyPairs, make_grid
from mpmfw.step.timestep import highest_frequency
from mpmfw.step.transfer import Transfer, make_transfer

#: Base classes of what a scene names.
BASES: dict[Kind, type[Any]] = {
    "contact": ContactStrategy, "friction": FrictionLaw, "shape": ShapeFunction, "material": Material,
    "load": Load,
    "boundary": Boundary, "output": OutputSeries, "geometry": BodyGeometry, "measure": Measure,
    "reference": Reference,
}  # fmt: skip


def build(
    scene: Any, contact: Any = None, shape: Any = None, loads: Mapping[str, Load] | None = None
) -> Setup:
    """Discretise the bodies, create the plug-ins that the scene names, and decide the effects.

    Names and objects replace the scene's methods; ``loads`` are added to the scene's."""
    contact, shape = _strategy("contact", contact), _strategy("shape", shape)
    chosen = chosen_methods(contact, shape)
    if isinstance(scene, Scene):  # methods that it has already need no second reading
        own = {"shape.method": scene.shape.method, "contact.method": scene.contact and scene.contact.method}
        chosen = {key: name for key, name in chosen.items() if own[key] != name}
    if chosen or not isinstance(scene, Scene):
        scene = load_scene(scene, set=chosen)
    if isinstance(shape, str | None):
        shape = _plugin("shape", scene.shape.method, scene.shape.options)
    _check_dimensions(scene, shape, "shape.method")
    by_name = isinstance(contact, str | None)
    if len(scene.bodies) == 1 and not any(body.self_contact for body in scene.bodies.values()):
        if by_name:
            _check_unused_contact(scene)
        contact = None
    elif by_name:
        contact = scene.contact and _plugin("contact", scene.contact.method, scene.contact.options)
    if contact is not None:
        _check_dimensions(scene, contact, "contact.method")
        contact = _by_pair(scene, contact, "mass_weighted" if shape.massless_boundary else "plain")
    check_memory(scene)
    layouts = lay_out(scene)
    materials = {
        name: _plugin("material", scene.materials[name].model, scene.materials[name].options)
        for name in dict.fromkeys(body.material for body in scene.bodies.values() if body.material)
    }
    return _put_together(scene, layouts, shape, contact, materials, loads or {})


def _by_pair(scene: Scene, contact: ContactStrategy, surface_map: str) -> ContactStrategy:
    """Return the contact of all pairs, or several where pairs name their own; ``auto`` is ``surface_map``."""
    given = [] if scene.contact is None else [pair for pair in scene.contact.pairs if pair.method]
    if not given:
        return contact
    from mpmfw.contact.by_pair import ContactsByPair

    made, named = list[tuple[Any, Any]](), {}
    for pair in given:
        known = [one for settings, one in made if settings == (pair.method, pair.options)]
        one = known[0] if known else _plugin("contact", pair.method, pair.options)
        _check_dimensions(scene, one, f"contact.pairs.{'-'.join(pair.bodies)}.method")
        made.append(((pair.method, pair.options), one))
        named[pair.bodies] = one
    return ContactsByPair(contact, named, surface_map)


def build_some(whole: Setup, which: Sequence[int]) -> Setup:
    """Build some of the bodies in their initial state; methods are new objects with the same options.

    The largest wave speed, friction, and whether surfaces are tracked are those of all bodies."""

    def again(plugin: Any) -> Any:
        return None if plugin is None else type(plugin).from_options(plugin.options)

    names = [whole.bodies[index].name for index in which]
    scene = whole.scene.of_bodies(names)
    used = dict.fromkeys(scene.bodies[name].material for name in names)
    shape, contact = again(whole.shape_function), again(whole.contact) if len(names) > 1 else None
    materials = {name: again(whole.materials[name]) for name in used}
    layouts = tuple(whole.layouts[index] for index in which)
    return _put_together(scene, layouts, shape, contact, materials, {}, whole)


def chosen_methods(contact: Any, shape: Any) -> dict[str, str]:
    """Return the keys of the scene that methods given by name set."""
    given = {"contact.method": contact, "shape.method": shape}
    return {key: value for key, value in given.items() if isinstance(value, str)}


def _transfer(name: str, scene: Scene, shape: ShapeFunction) -> Transfer:
    """The transfer called ``name``, fitted to the shape function."""
    spread = None if scene.grid.axisymmetric else shape.spread
    return make_transfer(
        name,
        singular_spread=shape.singular_spread,
        spread=None if spread is None else spread * scene.grid.cell_size**2,
        transported=scene.stepping.transported,
        pic_fraction=scene.stepping.pic_fraction,
    )


def _put_together(
    scene: Scene,
    layouts: tuple[Layout, ...],
    shape: ShapeFunction,
    contact: ContactStrategy | None,
    materials: dict[str, Material],
    loads: Mapping[str, Load],
    whole: Setup | None = None,
) -> Setup:
    """Join methods to bodies; ``whole`` has all bodies if these are only some."""
    per_body = whole is not None or (contact is not None and contact.velocity_fields == "per_body")
    bodies = make_bodies(scene, layouts, materials, per_body=per_body)
    scheme, name = scene.stepping.chosen(shape)
    transfer = _transfer(name, scene, shape)
    n_fields = len(bodies) if per_body else 1
    lower, upper = np.array([scene.grid.lower, scene.grid.upper])
    rigid = sum(body.rigid for body in bodies) if per_body else 0
    grid = make_grid(
        scene.grid.cell_size, lower, upper, n_fields, rigid_fields=rigid, axisymmetric=scene.grid.axisymmetric
    )
    particles = make_particles(scene, layouts, bodies, transfer, n_fields)
    soft = [body for body in bodies if not body.rigid]
    of_soft = [scene.bodies[body.name].material for body in soft]
    frequencies = [
        highest_frequency(body, scene.grid.cell_size, shape.courant, scene.materials[name].damping)
        for body, name in zip(soft, of_soft, strict=True)
    ]
    for body, name, frequency in zip(soft, of_soft, frequencies, strict=True):
        # neighbours become one slice, and take one call of a kernel
        material, own = materials[name], body.particles
        last = material.slices[-1:]
        if last and last[0].stop == own.start:
            material.slices, own = material.slices[:-1], slice(last[0].start, own.stop)
        material.slices = (*material.slices, own)
        material.bulk_frequency = max(material.bulk_frequency, frequency)
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
        whole=whole,
        scene=scene,
        shape_function=shape,
        contact=contact,
        materials=materials,
        exchange=transfer,
        named=_named(scene, bodies, loads),
        plugins=[*materials.values(), shape],
    )
    _add_interfaces(setup)
    if whole is None:
        check_bodies(scene, layouts, bodies)
    add_effects(setup)
    return setup


def _named(
    scene: Scene, bodies: tuple[Body, ...], loads: Mapping[str, Load]
) -> dict[str, dict[str, NamedPlugIn]]:
    made: dict[str, dict[str, NamedPlugIn]] = {}
    soft = tuple(body for body in bodies if not body.rigid)
    for group in ("loads", "boundaries", "outputs"):
        made[group] = {}
        for name, table in getattr(scene, group).items():
            plugin: NamedPlugIn = _plugin(NAMED[group], table.model, table.options)
            _check_dimensions(scene, plugin, f"{group}.{name}")
            plugin.title = name
            acted_on = bodies if group == "outputs" else soft
            if table.bodies is not None:
                acted_on = tuple(b for b in bodies if b.name in table.bodies)
            plugin.bodies = acted_on
            made[group][name] = plugin
    for name, given in loads.items():
        given.title, given.bodies = name, soft
        made["loads"][name] = given
    return made


def _add_interfaces(setup: Setup) -> None:
    """Add the friction law and all pairs of bodies, or only the named pairs if others can be added later."""
    given, contact, state = setup.scene.contact, setup.contact, setup.state
    if given is not None and given.friction_law is not None and contact and contact.takes_friction_law:
        setup.friction_law = _plugin("friction", given.friction_law, given.friction_options)
    law = setup.friction_law
    index = {body.name: body.index for body in state.bodies}
    named = () if given is None else given.pairs
    ends = np.array([sorted(map(index.__getitem__, pair.bodies)) for pair in named], np.int64).reshape(-1, 2)
    index_of = zip(ends.tolist(), named, strict=True)
    mu = {(a, b): float(pair.friction) for (a, b), pair in index_of if pair.friction is not None}
    by_law = None if law is None or law.is_coulomb else law.label
    near = BodyPairs(tuple(index), 0.0 if given is None else float(given.friction), mu, by_law)
    follows = hasattr(contact, "add_pairs") or not any(hasattr(contact, name) for name in HOOKS)
    pairs = np.column_stack(np.triu_indices(len(index), 1))
    if len(index) > FEW and follows:
        rigid = np.array([body.rigid for body in state.bodies])  # which have no window that comes near
        pairs = np.concatenate([ends, pairs[rigid[pairs[:, 1]]]])
        state.near = near
    itself = [body.index for body in state.bodies if setup.scene.bodies[body.name].self_contact]
    pairs = np.concatenate([pairs, np.column_stack((itself, itself)).astype(np.int64)])
    # Nothing moves two prescribed bodies apart, and few contacts two rigid ones
    kept: Any = ~np.array([body.rigid for body in state.bodies])[pairs].all(axis=1)
    for k in np.flatnonzero(~kept):
        a, b = (state.bodies[i] for i in pairs[k])
        own = None if contact is None else contact.between(a.name, b.name)
        kept[k] = own is not None and own.meets_rigid_pairs and not (a.prescribed and b.prescribed)
    near.add(state, *pairs[kept].T)


def _plugin(kind: Any, name: Any, options: Any) -> Any:
    plugin = load(kind, name)
    if not issubclass(plugin, BASES[kind]):
        raise _of_another_kind(kind, plugin)
    try:
        given = options is not None and hasattr(plugin, "from_options")
        return plugin.from_options(options) if given else plugin()
    except BaseException as error:
        raise_named(error, plugin, "its constructor")


def _strategy(kind: Kind, given: Any) -> Any:
    """Return None, a name or a strategy object; a class is instantiated."""
    if given is None or isinstance(given, str):
        return given
    if not isinstance(given, (type, BASES[kind])):
        raise SceneError(
            f"{kind}: found {given!r}; expected a name, module:Class, or a class derived from "
            f"mpmfw.api.{BASES[kind].__name__} or an object of one"
        )
    plugin = given if isinstance(given, type) else type(given)
    if not issubclass(plugin, BASES[kind]):
        raise _of_another_kind(kind, plugin)
    refuse_nameless(plugin)
    return object_of(given)


def _of_another_kind(kind: Kind, plugin: type[Any]) -> SceneError:
    return SceneError(
        f"{kind} plug-in {full_name(plugin)} of {distribution_text(plugin)}: expected a class derived from "
        f"mpmfw.api.{BASES[kind].__name__}"
    )


def _check_dimensions(scene: Scene, plugin: Any, key: str) -> None:
    if scene.dim not in plugin.dimensions:
        works = " and ".join(f"{d}D" for d in plugin.dimensions)
        note = f" ({plugin.dimensions_note})" if plugin.dimensions_note else ""
        raise SceneError(f"'{plugin.name}' works in {works}{note}; the scene's grid is {scene.dim}D", key=key)


def _check_unused_contact(scene: Scene) -> None:
    given = scene.contact
    options = () if given is None or given.options is None else sorted(given.options.model_fields_set)
    keys = [f"{given.method}.{option}" for option in options] if given else []
    if given is not None and given.friction_law is not None:
        keys.append("friction_law")
    if keys:
        raise SceneError("has no effect, since the scene has one body only", key=f"contact.{keys[0]}")
