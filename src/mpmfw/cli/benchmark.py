"""``mpmfw benchmark``: nanoseconds per material point and step, by stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from mpmfw.errors import SceneError

#: Steps after which the shipped scenes are in contact.
IN_CONTACT = {"colliding-rings": 250}

#: Terminal width below which a table of twelve columns would lose digits.
WIDTH = 170


def benchmark(
    shapes: Annotated[
        str, typer.Option("--shapes", help="Shape functions between commas.")
    ] = "linear,gimp,bspline,cpdi",
    counts: Annotated[
        str, typer.Option("--counts", help="Numbers of material points between commas.")
    ] = "600,17600",
    scenes: Annotated[
        str, typer.Option("--scenes", help="Scenes between commas; empty for none.")
    ] = "rolling-cylinder-slip,colliding-rings",
    dim: Annotated[int, typer.Option("--dim", min=2, max=3, help="Dimensions of the synthetic block.")] = 2,
    repeats: Annotated[int, typer.Option("--repeats", min=3, help="Samples of each measurement.")] = 15,
) -> None:
    """Print ns per material point and step by stage, and the ratio to a plain compiled loop in the same run.

    The first table steps a block of material without contact and, in alternation, a plain loop of the same arithmetic
    (C++ where a compiler is found). The second steps whole scenes; its ratio is to the plain loop of the scene's shape
    function at the nearest number of points.
    """
    from rich.console import Console

    from mpmfw.benchmark import measure_kernels, measure_scene, table
    from mpmfw.scene import load_scene

    known = ("linear", "gimp", "bspline", "cpdi")
    chosen = [name for name in shapes.split(",") if name]
    for name in chosen:
        if name not in known:
            raise SceneError(f"--shapes {name}: there is a plain loop for {', '.join(known)} only")
    try:
        points = [int(text) for text in counts.split(",")]
    except ValueError:
        raise SceneError(f"--counts {counts}: expected whole numbers between commas") from None
    if min(points) < 1:
        raise SceneError(f"--counts {counts}: expected numbers of material points, 1 or more")
    names = [name for name in scenes.split(",") if name]
    for name in names:
        load_scene(name)  # an unknown one is refused before anything is measured
    console = Console(width=max(Console().width, WIDTH))
    rows = measure_kernels(chosen, points, repeats, dim=dim)
    blocks = [_without(row, ("dim",)) for row in rows]
    console.print(table(blocks, f"{dim}D block without contact: ns per material point and step"))
    if names:
        measured = [measure_scene(name, repeats, start=IN_CONTACT.get(name, 0)) for name in names]
        shown = [_without(_with_ratio(row, rows), ("dim", "ns_low", "ns_high")) for row in measured]
        console.print(table(shown, "Scenes: ns per material point and step"))


def _without(row: Mapping[str, Any], keys: tuple[str, ...]) -> dict[str, Any]:
    return {key: value for key, value in row.items() if key not in keys}


def _with_ratio(row: dict[str, Any], plain: list[dict[str, Any]]) -> Mapping[str, Any]:
    """Add the contact's share, and the ratio to the plain loop of the same shape at the nearest number of points."""
    share = 100.0 * row["ns_contact"] / row["ns_total"]
    found = [other for other in plain if other["shape"] == row["shape"] and other["dim"] == row["dim"]]
    if not found:
        return {**row, "contact %": share}
    nearest = min(found, key=lambda other: abs(other["particles"] - row["particles"]))
    return {
        **row,
        "contact %": share,
        "ns_plain": nearest["ns_plain"],
        "ratio": row["ns_total"] / nearest["ns_plain"],
    }
