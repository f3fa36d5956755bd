"""``mpmfw plot``, ``animate``, ``export``, ``report`` and ``view``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import outputs_progress
from mpmfw.errors import SceneError

FilesArgument: TypeAlias = Annotated[list[Path], Argument(metavar="FILE", help="Runs or comparisons.")]


def plot(
    file: FilesArgument,
    output: args.Output = None,
    field: args.Field = None,
    time: Annotated[float | None, Option(metavar="T", help="Of the field [s]; by default the last.")] = None,
    series: Annotated[
        list[str] | None, Option(metavar="NAME", help="Series; repeatable. A wrong name lists all.")
    ] = None,
    body: args.Bodies = None,
    pair: Annotated[str | None, Option(metavar="NAME", help="Only this pair of bodies.")] = None,
    axis: Annotated[str | None, Option(metavar="NAME", help="Only this component: x, y or z.")] = None,
    limits: args.Limits = None,
    arrows: args.Arrows = False,
    plane: Annotated[
        str | None,
        Option(metavar="AXIS[=AT]", help="Plane in 3D [m]; by default the middle of z."),
    ] = None,
    against: Annotated[
        str | None, Option(metavar="CONTACT", help="Draw the difference from this contact as well.")
    ] = None,
    force: args.Replace = False,
) -> None:
    """Draw the figures of FILE, by default to PNG files named after it; for vectors -o NAME.pdf or .svg.

    With --field, a field on the material points of a run, in 3D on a plane, or of the runs of a comparison
    side by side; contact_pressure and contact_traction along the surfaces that touch. With --series, series
    over time. Several FILEs, with either of these, stand side by side.
    """
    args.check_files(file)
    if field is not None and series:
        raise SceneError(f"--series {series[0]}: --field {field} draws another figure; leave one of them out")
    of_field = {"--time": time, "--limits": limits, "--arrows": arrows or None, "--plane": plane}
    _check_effect({**of_field, "--against": against}, "--field", field)
    _check_effect({"--pair": pair, "--axis": axis}, "--series", series)
    _check_effect({"--body": body or None}, "--field or --series", field or series)
    for option, value in (("--against", against), ("--plane", plane)):
        if value is not None and len(file) > 1:
            raise SceneError(f"{option} {value}: takes one FILE")
    alone = field is None and not series
    if alone and len(file) > 1:
        raise SceneError(f"{file[1]}: expected one FILE, or --field or --series")
    path = _default(file, field, series) if output is None else args.figure_path(output)
    _check_paths(file, path, force or alone)
    from mpmfw import plots

    looks: dict[str, Any] = {"bodies": body or None, "limits": args.limits_of(limits), "arrows": arrows}
    if field is not None and len(file) > 1:
        written = [plots.write_figure(plots.side_by_side(file, field, time, **looks), path)]
    elif field is not None:
        figures = {path: plots.field(file[0], field, time, plane=_plane_of(plane), **looks)}
        if against is not None:
            beside = args.new_path(path.with_stem(f"{path.stem}-difference"), force)
            figures[beside] = plots.field(file[0], field, time, bodies=body or None, against=against)
        written = [plots.write_figure(drawn, target) for target, drawn in figures.items()]
    elif series:
        if len(body or ()) > 1:
            raise SceneError(f"--body {(body or [])[1]}: histories take one body or all of them")
        name = body[0] if body else None
        drawn = plots.history(file if len(file) > 1 else file[0], series, body=name, pair=pair, axis=axis)
        written = [plots.write_figure(drawn, path)]
    else:
        written = plots.plot_file(file[0], path, force=force)
    for one in written:
        typer.echo(str(one))


def _check_effect(given: dict[str, Any], needed: str, chosen: object) -> None:
    for option, value in given.items():
        if value is not None and not chosen:
            raise SceneError(f"{option}: has no effect without {needed}")


def _check_paths(file: list[Path], path: Path, force: bool) -> None:
    from mpmfw.results import check_results

    args.new_path(path, force)
    for one in file:
        check_results(one)


def _default(file: list[Path], field: str | None, series: list[str] | None) -> Path:
    if field is None and not series:
        return file[0].with_suffix(".png")
    drawn = field or "-".join(series or ())
    return file[0].with_name(f"{file[0].stem}-{drawn}.png" if len(file) == 1 else f"{drawn}.png")


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
    output: args.Output = None,
    field: args.Field = None,
    fps: Annotated[int, Option(metavar="N", min=1, help="Frames per second.")] = 20,
    every: args.Every = 1,
    body: args.Bodies = None,
    limits: args.Limits = None,
    arrows: args.Arrows = False,
    force: args.Replace = False,
) -> None:
    """Write a moving picture of a field, by default von_mises, of the run in FILE.

    Several FILEs, or the runs of a comparison, stand side by side, at the times of the first. The output is
    a .gif, or an .mp4, which needs ffmpeg.
    """
    from mpmfw.plots.animation import animate as animate_runs
    from mpmfw.plots.animation import check_movie

    args.check_files(file)
    path = output or file[0].with_suffix(".gif")
    chosen: dict[str, Any] = {"bodies": body or None, "limits": args.limits_of(limits), "arrows": arrows}
    _check_paths(file, path, force)
    check_movie(path)
    with outputs_progress("frames") as progress:
        files, chosen["progress"] = file if len(file) > 1 else file[0], progress
        animate_runs(files, path, field or "von_mises", fps=fps, every=every, **chosen)
    typer.echo(str(path))


def export(
    file: Annotated[Path, Argument(metavar="FILE", help="File of a run; with --to, a scene.")],
    output: Annotated[
        Path | None, Option("-o", "--output", metavar="FOLDER", help="Folder, or a name ending in .pvd.")
    ] = None,
    every: args.Every = 1,
    body: args.Bodies = None,
    to: Annotated[
        str | None, Option(metavar="CODE", help="Write the scene as input of another code, such as uintah.")
    ] = None,
    set_: args.Set = None,
    trust: args.Trust = False,
    force: args.Replace = False,
) -> None:
    """Write a run for ParaView, or a scene for another code, by default to a folder named after FILE.

    Open …-points.pvd: material points with all their fields, as cells where the shape function has domains;
    …-surfaces.pvd: surfaces with contact force and gap; …-series.csv: the series.
    """
    _check_effect({"--set": set_ or None, "--trust": trust or None}, "--to", to)
    if to is not None:
        for option, given in (("--every", every > 1), ("--body", body), ("--force", force)):
            if given:
                raise SceneError(f"{option}: has no effect with --to")
        _export_scene(str(file), to, output, args.assignments(set_), trust)
        return
    args.check_files([file])
    target = output or file.with_name(f"{file.stem}-paraview")
    if target.exists() and not target.is_dir() and target.suffix != ".pvd":
        raise SceneError(f"{target}: is a file; give a folder, or a name that ends in .pvd")

    from mpmfw.paraview import export as export_run
    from mpmfw.results import check_results
    from mpmfw.results.replacing import check_writable

    check_writable(target / "series.csv" if target.is_dir() else target)
    check_results(file)
    with outputs_progress("outputs") as progress:
        written = export_run(file, target, every=every, bodies=body or None, progress=progress, force=force)
    for path in written:
        typer.echo(str(path))


def _export_scene(name: str, to: str, output: Path | None, keys: dict[str, str], trust: bool) -> None:
    """Write the input of another code to a folder that is new or empty."""
    from mpmfw.codes.code import Code
    from mpmfw.scene import load_scene

    code, scene = Code.named(to)[0], load_scene(name, set=keys, trust=trust)
    folder = output or Path(f"{Path(name).stem}-{code.name}")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise SceneError(f"{folder}: exists; give an empty folder, or a name for a new one")
    if not code.problems(scene):
        folder.mkdir(parents=True, exist_ok=True)
    code.prepare(scene, folder)
    for path in sorted(folder.iterdir()):
        typer.echo(str(path))


def report(
    file: Annotated[list[Path], Argument(metavar="FILE", help="Runs, comparisons, studies or maps.")],
    output: args.Output = None,
    force: args.Replace = False,
) -> None:
    """Write an HTML page for each FILE: what differs most, pictures, tables. It opens without a network."""
    if output is not None and len(file) > 1:
        raise SceneError(f"--output {output}: takes one FILE")
    args.check_files(file)
    from mpmfw.report import write_report
    from mpmfw.results import check_results

    pages = [args.new_path(output or one.with_suffix(".html"), force) for one in file]
    for one in file:
        check_results(one)
    for one, page in zip(file, pages, strict=True):
        write_report(one, page)
        typer.echo(str(page))


def view(
    file: Annotated[Path, Argument(metavar="FILE", help="File of a run.")],
    field: args.Field = None,
    every: args.Every = 1,
    port: Annotated[int, Option(metavar="N", min=0, max=65535, help="Port; by default a free one.")] = 0,
    browser: Annotated[bool, Option(help="Open the page in the browser.")] = True,
) -> None:
    """Show the run in FILE in the browser: time, field, deformation, contact forces.

    The page is served to this computer alone, at 127.0.0.1, until Ctrl-C.
    """
    args.check_files([file])
    from mpmfw.plots.space import view as show
    from mpmfw.results import check_results

    check_results(file)
    show(file, field or "von_mises", every=every, port=port, open_browser=browser)
