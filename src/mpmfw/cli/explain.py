"""``mpmfw explain``: what a scene would run, before it runs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpmfw.cli.arguments import (
    ContactOption,
    SceneArgument,
    SetOption,
    ShapeOption,
    TrustOption,
    chosen_scene,
)
from mpmfw.cli.tables import print_rows
from mpmfw.cli.unused import unused_facts
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from mpmfw.runs.prediction import Prediction
    from mpmfw.runs.simulation import Simulation


def explain(
    scene: SceneArgument,
    contact: ContactOption = None,
    shape: ShapeOption = None,
    set_: SetOption = None,
    trust: TrustOption = False,
    everything: Annotated[
        bool,
        typer.Option(
            "--all", help="Print the reason of every effect, hooks, arrays, limits and stages, too."
        ),
    ] = False,
) -> None:
    """Print what SCENE would run: effects, the time step, its cost, and facts that are not used."""
    loaded = chosen_scene(scene, contact, shape, set_, trust)

    from mpmfw.runs.simulation import Simulation
    from mpmfw.scene import located

    try:
        simulation = Simulation(loaded)
    except SceneError as error:
        raise located(error, loaded) from error
    _print_head(simulation)
    if everything:
        _print_effects(simulation)
        _print_hooks(simulation)
        _print_arrays(simulation)
    else:
        _print_effect_names(simulation)
    from mpmfw.runs.prediction import predict

    found = predict(simulation, [array.nbytes for _, array in named_arrays(simulation.state)])
    _print_step(simulation, found, everything)
    _print_share_of_springs(simulation)
    _print_cost(simulation, found, everything)
    _print_unused(simulation)


def _print_head(simulation: Simulation) -> None:
    scene, state = simulation.scene, simulation.state
    typer.echo(scene.title or scene.name)
    method = "none needed" if simulation.contact is None else simulation.contact.label
    typer.echo(
        f"{scene.dim}D, {len(state.bodies)} bodies, {state.particles.count} material points, "
        f"contact {method}, shape {simulation.shape.label}"
    )
    if simulation.threads > 1:
        typer.echo(_of_threads(simulation))
    typer.echo("")


def _of_threads(simulation: Simulation) -> str:
    """How many threads share which work, and whether there are cores for them."""
    from mpmfw.runs.limits import remark_on_threads

    what = (
        "points and sums at nodes"
        if simulation.shape.rows_ascend
        else "points; sums at nodes are one thread's"
    )
    remark = remark_on_threads(simulation.threads)
    return f"{simulation.threads} threads share {what}" + (f"\n{remark}" if remark else "")


def _print_effect_names(simulation: Simulation) -> None:
    """What runs and what does not; ``--all`` has the reasons."""
    for on, word in ((True, "on"), (False, "off")):
        names = [effect.name for effect in simulation.effects if effect.on == on]
        text = f"{word}: {', '.join(names) or 'nothing'}"
        typer.echo(textwrap.fill(text, 100, subsequent_indent="  ", break_on_hyphens=False))
    typer.echo("(mpmfw explain --all says why, and lists hooks, arrays, limits and stages)\n")


def _print_effects(simulation: Simulation) -> None:
    rows = [{"effect": e.name, "": "on" if e.on else "off", "because": e.reason} for e in simulation.effects]
    print_rows(rows, "Effects")


def _print_hooks(simulation: Simulation) -> None:
    callers = simulation.hook_callers()
    print_rows(
        [{"hook": hook, "implemented by": ", ".join(who)} for hook, who in callers.items() if who], "Hooks"
    )


def _print_arrays(simulation: Simulation) -> None:
    arrays = list(named_arrays(simulation.state))
    rows = [{"array": name, "shape": str(a.shape), "bytes": f"{a.nbytes:,}"} for name, a in arrays]
    total = sum(array.nbytes for _, array in arrays)
    print_rows([*rows, {"array": "all", "shape": "", "bytes": f"{total:,}"}], "Arrays")


def named_arrays(state: Any) -> Iterable[tuple[str, Any]]:
    """Arrays of material points, grid, surface and plug-ins by name."""
    from dataclasses import fields

    for group in ("particles", "grid", "surface"):
        struct = getattr(state, group)
        for entry in () if struct is None else fields(struct):
            value = getattr(struct, entry.name)
            if hasattr(value, "nbytes"):
                yield f"{group}/{entry.name}", value
    yield from state.arrays.items()


def _print_step(simulation: Simulation, found: Prediction, everything: bool) -> None:
    """The first step that a run takes, and what limits it."""
    limits = sorted(found.limits)
    if everything:
        rows = [{"limit [s]": f"{seconds:.6g}", "set by": owner} for seconds, owner in limits]
        print_rows(rows, "Limits of the time step: the least rules")
    time = simulation.scene.time
    why = "fixed by time.step" if time.step is not None else f"{time.safety:g} of the stability limit at most"
    what = "first step" if simulation.scene.settle is None else "first step, of settling"
    typer.echo(f"dt = {found.first_step:.6g} s: {what}, {why}")
    typer.echo(f"least limit: {limits[0][0]:.6g} s, {limits[0][1]}\n")


def _print_share_of_springs(simulation: Simulation) -> None:
    """Part of driven sides' motion and of initial overlaps that contact springs take, where a scene has either."""
    from mpmfw.runs.share_of_springs import driven_speed, share_of_springs

    speed = driven_speed(simulation)
    axis = int(speed.argmax()) if speed.any() else None
    if axis is None and not simulation.scene.allow_overlap:
        return
    share = share_of_springs(simulation, axis)
    if share > 0.0:
        of = "the overlap" if axis is None else "the sides' motion"
        law = simulation.contact.label if simulation.contact is not None else ""
        typer.echo(f"springs of {law} take about {100.0 * share:.2g} % of {of}; stiffer ones take less\n")


def _print_cost(simulation: Simulation, found: Prediction, everything: bool) -> None:
    """Steps, CPU time, by stage where ``everything`` is printed, and memory, predicted from a trial."""
    from mpmfw.runs.limits import results_size
    from mpmfw.runs.prediction import TIMED
    from mpmfw.runs.sizing import most_memory, shown_bytes

    if everything:
        rows = [{"stage": stage, "CPU [s]": f"{seconds:.3g}"} for stage, seconds in found.stages.items()]
        print_rows(
            [*rows, {"stage": "all", "CPU [s]": f"{found.cpu_time:.3g}"}], "Predicted cost of the steps"
        )
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
    typer.echo(f"from a trial of {TIMED} steps; compilation is not in it")
    typer.echo("")


def _print_unused(simulation: Simulation) -> None:
    from rich.console import Console
    from rich.text import Text

    unused = unused_facts(simulation)
    console = Console()
    console.print(Text("Facts of the scene that are not used", style="bold"))
    for line in unused or ["none"]:
        console.print(Text(f"  {line}"))
