"""``mpmfw explain``: what a scene would run, before it runs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import print_table
from mpmfw.cli.unused import unused_facts
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
        bool, Option("--all", help="Print reasons of effects, hooks, arrays, limits and stages, too.")
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
    if simulation.threads > 1:
        from mpmfw.runs.limits import remark_on_threads

        shared = " and sums at nodes" if simulation.shape.rows_ascend else "; sums at nodes are one thread's"
        typer.echo(f"{simulation.threads} threads share points{shared}")
        if remark := remark_on_threads(simulation.threads):
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
    """Print the first step that a run takes, and its least limit."""
    limits = sorted(found.limits)
    if everything:
        rows = [{"set by": owner, "limit [s]": f"{seconds:.6g}"} for seconds, owner in limits]
        print_table(rows, labels=("set by",), title="Limits of the time step: the least rules")
    time = simulation.scene.time
    why = "fixed by time.step" if time.step is not None else f"{time.safety:g} of the stability limit at most"
    what = "first step" if simulation.scene.settle is None else "first step, of settling"
    typer.echo(f"dt = {found.first_step:.6g} s: {what}, {why}")
    typer.echo(f"least limit: {limits[0][0]:.6g} s, {limits[0][1]}\n")


def _print_share_of_springs(simulation: Simulation) -> None:
    """Print the part of driven sides' motion or of overlaps that contact springs take."""
    from mpmfw.runs.prediction import driven_speed, share_of_springs

    speed = driven_speed(simulation)
    axis = int(speed.argmax()) if speed.any() else None
    if axis is None and not simulation.scene.allow_overlap:
        return
    share, law = share_of_springs(simulation, axis), simulation.contact
    if share > 0.0 and law is not None:
        of = "the overlap" if axis is None else "the sides' motion"
        typer.echo(f"springs of {law.label} take about {100 * share:.2g} % of {of}; stiffer ones take less\n")


def _print_cost(simulation: Simulation, found: Prediction, everything: bool) -> None:
    """Print steps, CPU time and memory, predicted from a trial."""
    from mpmfw.runs.limits import results_size
    from mpmfw.runs.prediction import TIMED
    from mpmfw.runs.sizing import most_memory, shown_bytes

    if everything:
        stages = {**found.stages, "all": found.cpu_time}
        rows = [{"stage": stage, "CPU [s]": f"{seconds:.3g}"} for stage, seconds in stages.items()]
        print_table(rows, labels=("stage",), title="Predicted cost of the steps")
    typer.echo(f"{found.steps} steps if the limit stays as it is, {1e-6 * found.memory:.3g} MB of arrays")
    largest = max(found.stages, key=lambda stage: found.stages[stage])
    share = found.stages[largest] / found.cpu_time if found.cpu_time > 0.0 else 0.0
    typer.echo(f"{found.cpu_time:.3g} s of CPU time for the steps, {100.0 * share:.0f} % of it {largest}")
    typer.echo(f"at most {shown_bytes(most_memory(simulation.scene))} of memory while it is built and runs")
    frames, each, size = results_size(simulation, simulation.header())
    typer.echo(f"{frames:g} frames of {shown_bytes(each)}, and series: {shown_bytes(size)}")
    typer.echo(f"{found.output_time:.3g} s for output, {found.start_time:.3g} s to start")
    if found.settle_steps:
        typer.echo(f"settling: at most {found.settle_steps} steps, {found.settle_time:.3g} s")
    flows = any(one.dissipates and one.slices for one in simulation.setup.materials.values())
    missing = "contacts that come later" + (" and plastic flow" if flows else "")
    typer.echo(f"from a trial of {TIMED} steps, without compilation{', ' if flows else ' and '}{missing}\n")
