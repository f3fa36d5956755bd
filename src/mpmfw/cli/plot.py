"""``mpmfw plot``: figures of a results' file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpmfw.cli.arguments import OutputOption
from mpmfw.cli.errors import check_writable, figure_path
from mpmfw.cli.result_files import (
    ArrowsOption,
    BodiesOption,
    FieldOption,
    LimitsOption,
    ReplaceOption,
    check_files,
    limits_of,
)
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(
    file: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help="File of a run or a comparison.", show_default=False),
    ],
    output: OutputOption = None,
    field: FieldOption = None,
    time: Annotated[
        float | None,
        typer.Option("--time", metavar="T", help="Of the field [s]; the last output by default."),
    ] = None,
    series: Annotated[
        list[str] | None,
        typer.Option(
            "--series", metavar="NAME", help="Series over time; repeatable. A wrong name lists all."
        ),
    ] = None,
    body: BodiesOption = None,
    pair: Annotated[str | None, typer.Option(metavar="NAME", help="Only this pair of bodies.")] = None,
    axis: Annotated[str | None, typer.Option(metavar="NAME", help="Only this component: x, y or z.")] = None,
    limits: LimitsOption = None,
    arrows: ArrowsOption = False,
    plane: Annotated[
        str | None,
        typer.Option(
            "--plane",
            metavar="AXIS[=AT]",
            help="Of a field in 3D: axis across the plane that is drawn, and its place [m]; the middle along z by default.",
            show_default=False,
        ),
    ] = None,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="CONTACT",
            help="Of a comparison: draw the difference of the field against this contact as well.",
            show_default=False,
        ),
    ] = None,
    force: ReplaceOption = False,
) -> None:
    """Draw the figures of FILE, by default to PNG files named as it; -o NAME.pdf or NAME.svg draws vectors.

    With --field, a field on the material points of a run, in 3D on a plane, or of the runs of a comparison side by side; with
    --series, series over time of a run or a comparison. Several FILEs then stand side by side, fields under one colour scale.
    Without either, several FILEs that are comparisons of a rolling cylinder with slip and without make one figure, a row each.
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
