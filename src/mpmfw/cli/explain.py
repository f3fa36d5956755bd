"""``mpmfw explain``: the effects, time step and cost of a scene, before it runs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import print_table
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from mpmfw.runs.prediction import Prediction
    from mpmfw.runs.simulation import Simulation


def explain(
    scene: args.SceneName,
    contact: args.Contact = None,
    shape: args.Shape = None,
    set_: args.Set = None,
    trust: args.Trust = False,
    everything: Annotated[
        bool, Option("--all", help="Also print reasons, hooks, arrays, limits and stages.")
    ] = False,
) -> None:
    """Print what SCENE would run: effects, the time step, its cost, and facts that are not used."""
    loaded = args.chosen_scene(scene, contact, shape, set_, trust)

    from mpmfw.runs.simulation import Simulation
    from mpmfw.scene import located

    try:
        simulation = Simulation(loaded)
    except SceneError as error:
        raise located(error, loaded) from error
    _print_head(simulation)
    if everything:
        _print_parts(simulation)
    else:
        for on, word in ((True, "on"), (False, "off")):
            names = [effect.name for effect in simulation.effects if effect.on == on]
            text = f"{word}: {', '.join(names) or 'nothing'}"
            typer.echo(textwrap.fill(text, 100, subsequent_indent="  ", break_on_hyphens=False))
        typer.echo("(mpmfw explain --all says why, and lists hooks, arrays, limits and stages)\n")
    from mpmfw.runs.prediction import predict

    found = predict(simulation, [array.nbytes for _, array in named_arrays(simulation.state)])
    _print_step(simulation, found, everything)
    _print_share_of_springs(simulation)
    _print_cost(simulation, found, everything)
    typer.echo("Facts of the scene that are not used")
    for line in unused_facts(simulation) or ["none"]:
        typer.echo(textwrap.fill(line, 100, initial_indent="  ", subsequent_indent="    "))


def _print_head(simulation: Simulation) -> None:
    scene, state = simulation.scene, simulation.state
    typer.echo(scene.title or scene.name)
    method = "none needed" if simulation.contact is None else simulation.contact.label
    typer.echo(
        f"{scene.dim}D, {len(state.bodies)} bodies, {state.particles.count} material points, "
        f"contact {method}, shape {simulation.shape.label}"
    )
    from mpmfw.runs.limits import coarse_bodies, remarks_on_threads

    if simulation.threads > 1:
        typer.echo(f"{simulation.threads} threads")
    for remark in [*remarks_on_threads(simulation.threads), *coarse_bodies(scene)]:
        typer.echo(remark)
    typer.echo("")


def _print_parts(simulation: Simulation) -> None:
    effects = [
        {"effect": e.name, "state": "on" if e.on else "off", "because": e.reason} for e in simulation.effects
    ]
    print_table(effects, labels=("effect",), words=("state", "because"), title="Effects")
    hooks = [
        {"hook": hook, "implemented by": ", ".join(who)}
        for hook, who in simulation.hook_callers().items()
        if who
    ]
    print_table(hooks, labels=("hook",), words=("implemented by",), title="Hooks")
    arrays = list(named_arrays(simulation.state))
    rows = [{"array": name, "shape": str(a.shape), "bytes": f"{a.nbytes:,}"} for name, a in arrays]
    total = {"array": "all", "shape": "", "bytes": f"{sum(array.nbytes for _, array in arrays):,}"}
    print_table([*rows, total], labels=("array",), words=("shape",), title="Arrays")


def named_arrays(state: Any) -> Iterable[tuple[str, Any]]:
    """Yield the arrays of material points, grid, surface and plug-ins by name."""
    from dataclasses import fields

    for group in ("particles", "grid", "surface"):
        struct = getattr(state, group)
        for entry in () if struct is None else fields(struct):
            value = getattr(struct, entry.name)
            if hasattr(value, "nbytes"):
                yield f"{group}/{entry.name}", value
    yield from state.arrays.items()


def _print_step(simulation: Simulation, found: Prediction, everything: bool) -> None:
    limits = sorted(found.limits)
    if everything:
        rows = [{"set by": owner, "limit [s]": f"{seconds:.6g}"} for seconds, owner in limits]
        print_table(rows, labels=("set by",), title="Limits of the time step: the least applies")
    time = simulation.scene.time
    why = "fixed by time.step" if time.step is not None else f"{time.safety:g} of the stability limit at most"
    what = "first step" if simulation.scene.settle is None else "first step, of settling"
    typer.echo(f"dt = {found.first_step:.6g} s: {what}, {why}")
    typer.echo(f"least limit: {limits[0][0]:.6g} s, {limits[0][1]}\n")


def _print_share_of_springs(simulation: Simulation) -> None:
    """Print the part of the driven motion, or of overlaps, that contact springs take."""
    from mpmfw.runs.prediction import driven_speed, share_of_springs

    speed = driven_speed(simulation)
    axis = int(speed.argmax()) if speed.any() else None
    if axis is None and not simulation.scene.allow_overlap:
        return
    share, law = share_of_springs(simulation, axis), simulation.contact
    if share > 0.0 and law is not None:
        of = "the overlap" if axis is None else "the driven motion"
        typer.echo(f"springs of {law.label} take about {100 * share:.2g} % of {of}; stiffer ones take less\n")


def _print_cost(simulation: Simulation, found: Prediction, everything: bool) -> None:
    from mpmfw.runs.limits import most_memory, results_size, shown_bytes
    from mpmfw.runs.prediction import TIMED

    if everything:
        stages = {**found.stages, "all": found.cpu_time}
        rows = [{"stage": stage, "CPU [s]": f"{seconds:.3g}"} for stage, seconds in stages.items()]
        print_table(rows, labels=("stage",), title="Predicted cost of the steps")
    typer.echo(f"{found.steps} steps if the limit stays as it is, {1e-6 * found.memory:.3g} MB of arrays")
    largest = max(found.stages, key=lambda stage: found.stages[stage])
    share = found.stages[largest] / found.cpu_time if found.cpu_time > 0.0 else 0.0
    typer.echo(f"{found.cpu_time:.3g} s of CPU time for the steps, {100.0 * share:.0f} % of it {largest}")
    typer.echo(f"at most {shown_bytes(most_memory(simulation.scene))} of memory")
    frames, each, size = results_size(simulation.scene, simulation.header())
    typer.echo(f"{frames:g} frames of {shown_bytes(each)}, and series: {shown_bytes(size)}")
    typer.echo(f"{found.output_time:.3g} s for output, {found.start_time:.3g} s to start")
    if found.settle_steps:
        typer.echo(f"settling: at most {found.settle_steps} steps, {found.settle_time:.3g} s")
    typer.echo(f"from a trial of {TIMED} steps, without compilation, later contacts and plastic flow\n")


#: Keys of ``[output]`` that an effect records, its name, and the words if it is off.
_DIAGNOSTICS = (
    ("ledger", "energy ledger", "no ledger is kept"),
    ("gap", "least gap", "no gap is measured"),
    ("contact_moment", "contact moment", "no moment is measured"),
)


def unused_facts(simulation: Simulation) -> list[str]:
    """Return the facts that have no effect in this run, one line each."""
    groups = (_alternatives, _friction, _bodies, _diagnostics)
    return [line for group in groups for line in group(simulation)]


def _alternatives(simulation: Simulation) -> Iterator[str]:
    from mpmfw.scene.options import CORE_KEYS

    scene = simulation.scene
    tables = scene.to_mapping()
    for kind, chosen in (("contact", scene.contact), ("shape", scene.shape)):
        runs = None if chosen is None else chosen.method
        used = (*CORE_KEYS[kind], runs, getattr(chosen, "friction_law", None))
        for name, options in tables.get(kind, {}).items():
            if name not in used:
                yield from (f"{kind}.{name}.{key}: {kind} '{runs}' runs, not '{name}'" for key in options)


def _friction(simulation: Simulation) -> Iterator[str]:
    contact = simulation.contact
    if contact is not None and not contact.uses_friction:
        with_friction = [pair.label for pair in simulation.state.pairs if pair.friction]
        yield from (f"friction of {pair}: contact '{contact.name}' has none" for pair in with_friction)
        if simulation.state.near is not None and simulation.state.near.friction:
            yield f"contact.friction: contact '{contact.name}' has none"
    given = simulation.scene.contact
    if contact is not None and given is not None and given.friction_law and not contact.takes_friction_law:
        has = "Coulomb's friction alone" if contact.uses_friction else "no friction"
        yield f"contact.friction_law = '{given.friction_law}': contact '{contact.name}' has {has}"
    if contact is not None:
        yield from contact.unused(simulation.state.pairs)


def _bodies(simulation: Simulation) -> Iterator[str]:
    scene, bodies = simulation.scene, simulation.scene.bodies
    if simulation.state.surface is None:
        given = [name for name, body in bodies.items() if body.segment is not None]
        yield from (f"bodies.{name}.segment: no surface is tracked" for name in given)
        if _asked(scene, "surface"):
            yield "output.surface: no surface is tracked"
    for effect in simulation.effects:
        name = effect.name.removeprefix("rotation of ").removesuffix(": lumped")
        if name in bodies and bodies[name].rotation not in (None, "lumped"):
            yield f"bodies.{name}.rotation: lumped anyway: {effect.reason}"
    used = {body.material for body in bodies.values()}
    yield from (f"materials.{name}: no body is made of it" for name in scene.materials if name not in used)


def _diagnostics(simulation: Simulation) -> Iterator[str]:
    scene, contact = simulation.scene, simulation.contact
    effects = {effect.name: effect for effect in simulation.effects}
    for key, name, words in _DIAGNOSTICS:
        if _asked(scene, key) and not effects[name].on:
            yield f"output.{key}: {words}: {effects[name].reason}"
    interval = "output.particle_interval: "
    if _asked(scene, "particle_interval") and not scene.output.particles:
        yield f"{interval}no material points are stored: output.particles = false"
    elif _asked(scene, "particle_interval") and scene.output.particle_interval <= scene.time.output_interval:
        yield f"{interval}material points are stored at every output: time.output_interval is not shorter"
    if _asked(scene, "stability") and contact is not None and not contact.monitors():
        yield f"output.stability: of the time step alone: contact '{contact.name}' has no such series"


def _asked(scene: Any, diagnostic: str) -> bool:
    return diagnostic in scene.output.model_fields_set and bool(getattr(scene.output, diagnostic))
