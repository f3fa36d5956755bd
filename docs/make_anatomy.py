"""Write docs/anatomy.md and its figure: what each ingredient of a contact does, ``python docs/make_anatomy.py [FOLDER]``.

About five minutes of CPU time. FOLDER keeps the runs, and a second call goes on from them.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

import mpmfw
from mpmfw.errors import ResultsWarning
from mpmfw.plots.style import dress, journal_style, legend_below, new_figure
from mpmfw.scene.specification import parse_specification
from mpmfw.studies.conclusion import rows

HERE = Path(__file__).parent
STUDIES = ("anatomy-cylinder", "anatomy-block", "anatomy-contact-stress", "anatomy-rings")
#: Quantities, with the least that counts: below, a ratio would compare round-off.
QUANTITIES = {"error": 1e-3, "penetration": 1e-3, "noise": 1e-3, "cpu_time": 1e-3}
HEADS = {
    "error": "error",
    "penetration": "deepest penetration",
    "noise": "noise of the force",
    "cpu_time": "CPU time",
}
#: Ticks of factors, over few decades and over many.
TICKS = ((0.25, 0.5, 1.0, 2.0, 4.0), (1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1000.0))
#: Of the scenes, in their order.
COLOURS = ("#0072B2", "#56B4E9", "#009E73", "#D55E00", "#7F3C8D")


class Parts(NamedTuple):
    """What a contact is made of; what a detection has no choice of is empty."""

    detection: str
    law: str
    criterion: str
    normal: str


def parts_of(label: str) -> Parts:
    """The ingredients of a contact by its label."""
    spec = parse_specification(label)
    detection, _, law = spec.name.partition("+")
    if detection != "nodes":
        return Parts(detection, law, "", "")
    default = "position" if law == "penalty" else "velocity"
    return Parts(
        detection, law, spec.options.get("criterion", default), spec.options.get("normal", "averaged")
    )


def _swap(
    name: str, old: Mapping[str, str], new: Mapping[str, str]
) -> tuple[str, Callable[[Parts], Parts | None]]:
    def other(parts: Parts) -> Parts | None:
        fits = all(getattr(parts, key) == value for key, value in old.items())
        return parts._replace(**new) if fits else None

    return name, other


PAGE = """\
# Anatomy of contact: which ingredient makes which error

<!-- Made by docs/make_anatomy.py, which runs all that it quotes. -->

A contact is a [detection and a law](guide/methods.md#detection-and-law); where it is detected at grid nodes, a criterion
and a kind of normal come with it. Published methods differ in several of these at a time, so that a comparison of them
does not say what an error comes from. Here every one is exchanged for another with all else alike: 18 contacts on five
problems, with CPDI, at one coarse cell size each (cylinder 0.8 m, two cells in the radius, with slip and without; block
0.1 m; pressed blocks 0.1 m; rings 4 mm).

```sh
mpmfw study anatomy-cylinder && mpmfw study anatomy-block && mpmfw study anatomy-contact-stress && mpmfw study anatomy-rings
python docs/make_anatomy.py
```

![Factor by which each exchange changes error, penetration, noise and CPU time](studies/anatomy.png)

Factors by which an exchange changes each quantity: a mark is the geometric mean over all pairs of runs of a problem that
differ in nothing else, a bar that over the problems. Errors and noise below 0.1 % and penetrations below 0.001 cells
count as these.

## What it says

All problems lie along grid lines with fitted points. [Turned against the grid](turned.md) contact at nodes is worse:
the stiffer body's normal then has up to 10 % on the block, and up to 61 and 95 % with the cylinder of two cells' radius.

- **The normal makes friction.** Normals averaged over both bodies lean at the edges of a face: the block does not slide
  at all (error 100 %, with the stiffer body's normal 0.00003 to 0.001 %), and the cylinder with slip has 11 % instead of
  0.6 %. Where nothing slides it makes no difference: 11 % of the rings' impulse with either. A normal by logistic
  regression mends most of it (block 1 %, cylinder with slip 4 to 5 %).
- **The criterion makes the gap, and what follows from it.** By approach alone bodies are held a cell apart, and hardly
  ever overlap; by position they come together: the error without slip falls from 38 to 7 %, the rings' from 11 to 5 %.
  The price is noise (twice as much) and contact stress (62 to 63 % instead of 25 to 30 %).
- **The detection makes the contact stress.** No criterion, normal or law brings contact at shared nodes below 25 % there,
  and surfaces have 0.3 to 0.5 % with impulses, lcp and springs alike; logistic regression is between (5 to 7 %), material
  points as spheres are as good (0.3 to 0.7 %). Those are no surface to slide on: on spheres the block stands still, and
  the cylinder with slip has 17 to 30 %.
- **The law makes little of the error.** Solving all rows at once in place of row by row changes no error by more than a
  tenth in the mean, but leaves the least overlap (0.005 cells between surfaces, impulses row by row 0.08, springs 0.1).
  Springs, whose friction has a history, help where it has to hold: without slip 0.3 % between surfaces and 0.3 to 1.4 %
  at nodes, where impulses have 1 and 5 to 7 %. `hybrid` has half the noise of springs for less time, and pays with
  contact stress (10 %) and rolling without slip (3.3 %).
- **Cost.** Surfaces take 1.6 times the time of nodes, the regression 1.7 times that of an average, all rows at once 1.2
  times that of one by one; criterion and normal are free.

So an error in sliding is to be sought in the normal, one in contact stress in the detection, one in the moment of contact
in the criterion; a new law between the same surfaces will change the noise.

## All runs

Errors of displacement (cylinder), acceleration (block), stress beside the interface and impulse (rings), as in [the
shipped studies](studies.md); the largest penetration of all problems, the median noise, and the geometric mean of CPU
time over that of the first row. One run each
({conditions}): costs are good to a fifth.

{table}

## All exchanges

Geometric mean over the problems, and least and largest of these.

{swaps}
"""

#: One ingredient for another, all else alike; the facing of a surface is best compared with the best that nodes have.
SWAPS = (
    _swap("criterion: velocity → position", {"criterion": "velocity"}, {"criterion": "position"}),
    _swap("normal: averaged → master", {"normal": "averaged"}, {"normal": "master"}),
    _swap(
        "normal: averaged → logistic regression",
        {"detection": "nodes", "criterion": "velocity", "normal": "averaged"},
        {"detection": "logistic", "criterion": "", "normal": ""},
    ),
    _swap(
        "detection: nodes (position, master) → surfaces",
        {"detection": "nodes", "criterion": "position", "normal": "master"},
        {"detection": "surfaces", "criterion": "", "normal": ""},
    ),
    _swap("detection: surfaces → points", {"detection": "surfaces"}, {"detection": "points"}),
    _swap("law: impulse → lcp", {"law": "impulse"}, {"law": "lcp"}),
    _swap("law: impulse → penalty", {"law": "impulse"}, {"law": "penalty"}),
    _swap("law: penalty → hybrid", {"law": "penalty"}, {"law": "hybrid"}),
)

#: Rows of one problem by their parts.
Problem = dict[Parts, dict[str, Any]]


def problems(datasets: Iterable[xr.Dataset]) -> dict[str, Problem]:
    """All runs by problem and parts."""
    found: dict[str, Problem] = {}
    for dataset in datasets:
        title = str(dataset.attrs["title"]).removeprefix("Anatomy: ")
        for row in rows(dataset):
            name = f"{title}, {row['scene']}" if "scene" in row else title
            found.setdefault(name, {})[parts_of(row["contact"])] = row
    return found


def effect(problem: Problem, other: Callable[[Parts], Parts | None], quantity: str) -> float:
    """Factor by which a swap changes a quantity: geometric mean over all pairs that differ in nothing else; NaN without any."""
    least, factors = QUANTITIES[quantity], []
    for parts, row in problem.items():
        twin = problem.get(other(parts) or parts, row)
        values = [max(one[quantity], least) for one in (row, twin)]
        if twin is not row and np.isfinite(values).all():
            factors.append(np.log(values[1] / values[0]))
    return float(np.exp(np.mean(factors))) if factors else np.nan


@journal_style()
def draw(found: Mapping[str, Problem]) -> None:
    """The effect of every swap on every quantity, a mark for each problem and a bar for their geometric mean."""
    figure = new_figure(2, 2, height=70.0)
    panels = figure.subplots(2, 2, sharey=True)
    for axes, (quantity, head) in zip(panels.ravel(), HEADS.items(), strict=True):
        for k, (_, other) in enumerate(SWAPS):
            factors = [effect(problem, other, quantity) for problem in found.values()]
            known = [factor for factor in factors if np.isfinite(factor)]
            if known:
                mean = float(np.exp(np.mean(np.log(known))))
                axes.barh(k, mean - 1.0, left=1.0, height=0.5, color="0.85", zorder=1)
            for i, (factor, colour) in enumerate(zip(factors, COLOURS, strict=True)):
                axes.plot(factor, k + 0.12 * (i - 2), "o", color=colour, zorder=3)
        axes.axvline(1.0, color="0.3", linewidth=0.8, zorder=2)
        axes.set_xscale("log")
        low, high = axes.get_xlim()
        axes.set_xticks([tick for tick in TICKS[int(high > 100.0 * low)] if low < tick < high])
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_yticks(range(len(SWAPS)), [name for name, _ in SWAPS])
        dress(axes, "factor (left of 1 is better)", "", head)
    panels[0, 0].invert_yaxis()
    marks = [
        Line2D([], [], color=colour, marker="o", linestyle="", label=name)
        for name, colour in zip(found, COLOURS, strict=True)
    ]
    legend_below(figure, [marks])
    figure.savefig(HERE / "studies" / "anatomy.png", dpi=200)


def table(found: Mapping[str, Problem]) -> str:
    """Every contact: errors by problem, worst penetration and noise, cost over that of the first."""
    head = [
        "detection",
        "criterion",
        "normal",
        "law",
        *(f"{name} [%]" for name in found),
        "penetration [cells]",
        "noise [%]",
        "cost",
    ]
    lines = [f"| {' | '.join(head)} |", "|" + " --- |" * len(head)]
    first = next(iter(next(iter(found.values()))))
    for parts in next(iter(found.values())):
        runs = [problem[parts] for problem in found.values()]
        costs = [problem[parts]["cpu_time"] / problem[first]["cpu_time"] for problem in found.values()]
        cells = [parts.detection, parts.criterion, parts.normal, parts.law]
        cells += [_number(100.0 * run["error"]) if run["status"] == "ok" else "failed" for run in runs]
        cells += [_number(np.nanmax([run["penetration"] for run in runs]))]
        cells += [_number(100.0 * np.nanmedian([run["noise"] for run in runs]))]
        cells += [_number(np.exp(np.nanmean(np.log(costs))))]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _number(value: float) -> str:
    return f"{value:.2g}" if value < 10.0 else f"{value:.0f}" if np.isfinite(value) else "–"


def swaps(found: Mapping[str, Problem]) -> str:
    """What each swap does to each quantity: the geometric mean over the problems, and the range of these."""
    lines = [f"| instead of → | {' | '.join(HEADS.values())} |", "|" + " --- |" * (len(HEADS) + 1)]
    for name, other in SWAPS:
        cells = []
        for quantity in QUANTITIES:
            factors = [effect(problem, other, quantity) for problem in found.values()]
            known = [factor for factor in factors if np.isfinite(factor)]
            mean = (
                f"{_number(np.exp(np.mean(np.log(known))))} ({_number(min(known))} to {_number(max(known))})"
            )
            cells.append(mean if known else "–")
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Run, draw, write."""
    warnings.simplefilter("ignore", ResultsWarning)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        folder.mkdir(parents=True, exist_ok=True)
        datasets = [mpmfw.study(name, output=folder / f"{name}.nc", jobs=1) for name in STUDIES]
    write(datasets)


def write(datasets: Iterable[xr.Dataset]) -> None:
    """The page and its figure."""
    datasets = list(datasets)
    found = problems(datasets)
    draw(found)
    conditions = f"{datasets[0].attrs['processor']}, {datasets[0].attrs['timing']}"
    page = PAGE.format(table=table(found), swaps=swaps(found), conditions=conditions)
    (HERE / "anatomy.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
