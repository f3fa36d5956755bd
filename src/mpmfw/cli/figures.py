"""``mpmfw plot``, ``animate`` and ``export``: figures, moving pictures and ParaView's files of results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

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
from mpmfw.cli.errors import check_writable, figure_path
from mpmfw.cli.progress import outputs_progress
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    from mpmfw.results import check_results
    from mpmfw.results.replacing import check_new

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
    scale = limits_of(limits)
    path = check_writable(_default(file, field, series) if output is None else output)
    if field is not None or series or len(file) > 1:
        check_new(path, force)

    beside = path.with_stem(f"{path.stem}-difference")
    if against is not None:
        check_new(beside, force)
        if len(file) > 1:
            raise SceneError(f"--against {against}: takes one FILE, a comparison")
    for one in file:
        check_results(one)
    if field is not None:
        from mpmfw.plots import write_figure

        on = _plane_of(plane)
        figures = {path: _field_figure(file, field, time, body, scale, arrows, on)}
        if against is not None:
            figures[beside] = _field_figure(file, field, time, body, None, False, on, against)
        written = [write_figure(figure, one) for one, figure in figures.items()]
    elif series:
        written = [_draw_series(file, path, series, body, pair, axis)]
    else:
        from mpmfw.plots import plot_file, plot_files

        written = plot_file(file[0], path, force=force) if len(file) == 1 else [plot_files(file, path)]
    for one in written:
        typer.echo(str(one))


def _default(file: list[Path], field: str | None, series: list[str] | None) -> Path:
    """Name of the figure: of the file, and of what is drawn of it."""
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


def _field_figure(
    file: list[Path],
    name: str,
    time: float | None,
    bodies: list[str] | None,
    limits: tuple[float, float] | None,
    arrows: bool,
    plane: tuple[str, float | None] | None,
    against: str | None = None,
) -> Figure:
    from mpmfw.plots import field, side_by_side

    chosen = bodies or None
    if len(file) == 1:
        return field(
            file[0], name, time, bodies=chosen, limits=limits, arrows=arrows, plane=plane, against=against
        )
    if plane is not None:
        raise SceneError(f"--plane {plane[0]}: takes one FILE")
    return side_by_side(file, name, time, bodies=chosen, limits=limits, arrows=arrows)


def _plane_of(text: str | None) -> tuple[str, float | None] | None:
    """Read ``y`` or ``y=0.3``."""
    if text is None:
        return None
    axis, given, place = text.partition("=")
    try:
        return axis.strip(), float(place) if given else None
    except ValueError as error:
        raise SceneError(f"--plane {text}: expected AXIS or AXIS=AT, such as y=0.3") from error


def _draw_series(
    file: list[Path],
    path: Path,
    names: list[str],
    bodies: list[str] | None,
    pair: str | None,
    axis: str | None,
) -> Path:
    from mpmfw.plots import history, write_figure

    if bodies and len(bodies) > 1:
        raise SceneError(f"--body {bodies[1]}: histories take one body or all of them")
    figure = history(
        file if len(file) > 1 else file[0], names, body=bodies[0] if bodies else None, pair=pair, axis=axis
    )
    return write_figure(figure, path)


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
    from mpmfw.results.replacing import check_new

    check_files(file)
    path = check_writable(file[0].with_suffix(".gif") if output is None else output)
    check_new(path, force)
    scale = limits_of(limits)

    from mpmfw.plots.animation import animate as animate_runs
    from mpmfw.plots.animation import check_movie
    from mpmfw.results import check_results

    check_movie(path)
    for one in file:
        check_results(one)
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
