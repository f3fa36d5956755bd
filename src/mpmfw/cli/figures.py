"""``mpmfw plot``, ``animate`` and ``export``: figures, moving pictures and ParaView's files of results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from mpmfw.cli.arguments import (
    ArrowsOption,
    BodiesOption,
    EveryOption,
    FieldOption,
    LimitsOption,
    OutputOption,
    ReplaceOption,
    check_files,
    limits_of,
)
from mpmfw.cli.errors import check_writable, figure_path, new_path
from mpmfw.cli.progress import outputs_progress
from mpmfw.errors import SceneError

FilesArgument: TypeAlias = Annotated[
    list[Path], typer.Argument(metavar="FILE", help="Files of runs or comparisons.")
]


def plot(
    file: FilesArgument,
    output: OutputOption = None,
    field: FieldOption = None,
    time: Annotated[
        float | None, typer.Option(metavar="T", help="Of the field [s]; the last output by default.")
    ] = None,
    series: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Series over time; repeatable. A wrong name lists all."),
    ] = None,
    body: BodiesOption = None,
    pair: Annotated[str | None, typer.Option(metavar="NAME", help="Only this pair of bodies.")] = None,
    axis: Annotated[str | None, typer.Option(metavar="NAME", help="Only this component: x, y or z.")] = None,
    limits: LimitsOption = None,
    arrows: ArrowsOption = False,
    plane: Annotated[
        str | None,
        typer.Option(
            metavar="AXIS[=AT]",
            help="Of a field in 3D: axis across the plane that is drawn, and its place [m]; the middle along "
            "z by "
            "default.",
        ),
    ] = None,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="CONTACT",
            help="Of a comparison: draw the difference of the field against this contact as well.",
        ),
    ] = None,
    force: ReplaceOption = False,
) -> None:
    """Draw the figures of FILE, by default to PNG files named as it; -o NAME.pdf or NAME.svg draws vectors.

    With --field, a field on the material points of a run, in 3D on a plane, or of the runs of a comparison
    side by side. With --series, series over time of a run or a comparison. Several FILEs then stand side by
    side, fields under one colour scale. Without either, several FILEs that are comparisons of a rolling
    cylinder make one figure, a row each.
    """
    check_files(file)
    output = None if output is None else figure_path(output)
    _check_options(
        field,
        series,
        time=time,
        body=body,
        pair=pair,
        axis=axis,
        limits=limits,
        arrows=arrows,
        against=against,
        plane=plane,
    )
    for option, value in (("--against", against), ("--plane", plane)):
        if value is not None and len(file) > 1:
            raise SceneError(f"{option} {value}: takes one FILE")
    alone = field is None and not series and len(file) == 1
    path = _target(file, output or _default(file, field, series), force or alone)
    if field is not None:
        looks = {"bodies": body or None, "limits": limits_of(limits), "arrows": arrows}
        written = _draw_field(file, path, field, time, _plane_of(plane), against, force, looks)
    elif series:
        from mpmfw.plots import history, write_figure

        if len(body or ()) > 1:
            raise SceneError(f"--body {(body or [])[1]}: histories take one body or all of them")
        name = body[0] if body else None
        figure = history(file if len(file) > 1 else file[0], series, body=name, pair=pair, axis=axis)
        written = [write_figure(figure, path)]
    else:
        from mpmfw.plots import plot_file, plot_files

        written = plot_file(file[0], path, force=force) if alone else [plot_files(file, path)]
    for one in written:
        typer.echo(str(one))


def _target(file: list[Path], path: Path, force: bool) -> Path:
    """Return the path to write, if it can be written without loss of a file and all FILEs are results."""
    from mpmfw.results import check_results

    new_path(path, force)
    for one in file:
        check_results(one)
    return path


def _default(file: list[Path], field: str | None, series: list[str] | None) -> Path:
    """Return the name of the figure: of the file, and of the quantity that is drawn."""
    if field is None and not series:
        return file[0].with_suffix(".png") if len(file) == 1 else file[0].with_name("motion.png")
    drawn = field or "-".join(series or ())
    return file[0].with_name(f"{file[0].stem}-{drawn}.png" if len(file) == 1 else f"{drawn}.png")


def _check_options(field: str | None, series: list[str] | None, **given: object) -> None:
    """Refuse options that would have no effect."""
    if field is not None and series:
        raise SceneError(f"--series {series[0]}: --field {field} draws another figure; leave one of them out")
    needed = {
        "time": "--field", "limits": "--field", "arrows": "--field", "plane": "--field", "against": "--field",
        "pair": "--series", "axis": "--series",
    }  # fmt: skip
    chosen = {"--field": field is not None, "--series": bool(series)}
    for name, option in needed.items():
        if given[name] is not None and given[name] is not False and not chosen[option]:
            raise SceneError(f"--{name}: has no effect without {option}")
    if given["body"] and not any(chosen.values()):
        raise SceneError("--body: has no effect without --field or --series")


def _draw_field(
    file: list[Path],
    path: Path,
    name: str,
    time: float | None,
    plane: tuple[str, float | None] | None,
    against: str | None,
    force: bool,
    looks: dict[str, Any],
) -> list[Path]:
    """Draw a field of all runs, and its difference against a contact in a second figure."""
    from mpmfw.plots import field, side_by_side, write_figure
    from mpmfw.results.replacing import check_new

    if len(file) > 1:
        return [write_figure(side_by_side(file, name, time, **looks), path)]
    figures = {path: field(file[0], name, time, plane=plane, **looks)}
    if against is not None:
        beside = check_new(path.with_stem(f"{path.stem}-difference"), force)
        figures[beside] = field(file[0], name, time, bodies=looks["bodies"], against=against)
    return [write_figure(figure, one) for one, figure in figures.items()]


def _plane_of(text: str | None) -> tuple[str, float | None] | None:
    """Read ``y`` or ``y=0.3``."""
    if text is None:
        return None
    axis, given, place = text.partition("=")
    try:
        return axis.strip(), float(place) if given else None
    except ValueError as error:
        raise SceneError(f"--plane {text}: expected AXIS or AXIS=AT, such as y=0.3") from error


def animate(
    file: FilesArgument,
    output: OutputOption = None,
    field: FieldOption = None,
    contact: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of a comparison: only the runs with this contact.")
    ] = None,
    fps: Annotated[int, typer.Option(metavar="N", min=1, help="Frames a second.")] = 20,
    every: EveryOption = 1,
    body: BodiesOption = None,
    limits: LimitsOption = None,
    arrows: ArrowsOption = False,
    force: ReplaceOption = False,
) -> None:
    """Write a moving picture of a field (default von_mises) of the run in FILE, a frame for each output.

    Several FILEs, or the runs of a comparison, stand side by side, at the times of the first. The ending of
    the output, .gif or .mp4, chooses the format; .mp4 needs ffmpeg. By default a .gif named as the first
    FILE.
    """
    from mpmfw.plots.animation import animate as animate_runs
    from mpmfw.plots.animation import check_movie

    check_files(file)
    scale, path = limits_of(limits), file[0].with_suffix(".gif") if output is None else output
    check_movie(_target(file, path, force))
    with outputs_progress("frames") as progress:
        animate_runs(
            file if len(file) > 1 else file[0],
            path,
            field or "von_mises",
            contact=contact,
            fps=fps,
            every=every,
            bodies=body or None,
            limits=scale,
            arrows=arrows,
            progress=progress,
        )
    typer.echo(str(path))


def export(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="File of a run.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FOLDER", help="Folder, or a name ending in .pvd."),
    ] = None,
    every: EveryOption = 1,
    body: BodiesOption = None,
    force: ReplaceOption = False,
) -> None:
    """Write the run in FILE for ParaView, by default to a folder named as it.

    Open …-points.pvd: material points with all their fields, as cells where the shape function has domains;
    …-surfaces.pvd: surfaces with contact force and gap; …-series.csv: the series.
    """
    check_files([file])
    target = file.with_name(f"{file.stem}-paraview") if output is None else output
    if target.exists() and not target.is_dir() and target.suffix != ".pvd":
        raise SceneError(f"{target}: is a file; give a folder, or a name that ends in .pvd")
    check_writable(target / "series.csv" if target.is_dir() else target)

    from mpmfw.paraview import export as export_run
    from mpmfw.results import check_results

    check_results(file)
    with outputs_progress("outputs") as progress:
        written = export_run(file, target, every=every, bodies=body or None, progress=progress, force=force)
    for path in written:
        typer.echo(str(path))
