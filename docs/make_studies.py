"""Write docs/studies.md and docs/studies/: the shipped studies, ``python docs/make_studies.py [FOLDER]``.

Costs are taken with one process on each core, so that nothing else should use the computer; a quarter of an hour on a quiet
one of two cores, twice that on a slow one. FOLDER keeps the runs, and a second call goes on from them.
``pytest tests/unit/test_choosing.py`` then says which sentences of docs/guide/choosing.md the new tables contradict.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import xarray as xr

import mpmfw
from mpmfw.plots.ranking import profiles
from mpmfw.plots.study import study_figures
from mpmfw.studies.conclusion import conclusions, percent, rows
from mpmfw.studies.ranking import QUANTITIES, rank, summary

HERE = Path(__file__).parent
FIGURES = HERE / "studies"
STUDIES = ("rolling-cylinder", "sliding-block", "contact-stress", "rings")
DIMS = ("scene", "contact", "shape", "cell_size")

HEAD = """\
# What accuracy costs: the shipped studies

<!-- Made by docs/make_studies.py, which runs all that it quotes. -->

Every contact with every shape function at two or three cell sizes, error against a closed form or the finite elements, and
CPU time of the steps (without compilation and output; `contact-stress` ends at rest, where settling is the work): the least of
the repeats, taken in rounds of all, and half their range. {conditions}
How a study is written and read: [studies](guide/studies.md); what follows from these:
[choosing a method](guide/choosing.md). `auto` leaves scheme and transfer to the shape function: tables show both. Classical
contact has two rows, in its plainest form and in its strongest.

On the **front** (●) is a run that no other one of the same problem beats in both. A run may be on it with an error of 100 %: the
front says what is not beaten, not what is good. In the figures what is on the front is filled; markers that would cover
each other are moved up or down, and a dot is their place.
"""

RANKING = """
## Who wins at what price

```sh
mpmfw rank {files} -o ranking.png
```

Every method at its best settings: of its options, shape functions and cell sizes the cheapest run that brings a quantity
below a level. A column counts the problems, of {count}, that come so far; *over best* is the median of the cost over the
cheapest method's where the level is reached, *cheapest* at how many problems and levels the method is that one. Other
quantities count only where the error is below 10 %. Problems are few, and two of them one cylinder: this sums up the tables
below and is no verdict. A study of a law of one's own, run on the same machine, is ranked beside these: `mpmfw rank {files}
mine.nc`. Whoever knows better settings for a method is asked to send them.

![Share of problems and levels solved within a cost](studies/ranking.png)
"""


def section(name: str, dataset: xr.Dataset) -> str:
    """One study: command, what the error is, figures, conclusion, table."""
    for figure_name, (figure, _) in study_figures(dataset).items():
        figure.savefig(FIGURES / f"{name}-{figure_name}.png", dpi=200)
    said = "\n".join(f"- {sentence}" for sentence in conclusions(dataset))
    return f"""
## {dataset.attrs["title"]}

```sh
mpmfw study {name} -o {name}.nc && mpmfw plot {name}.nc
```

Error of {dataset.attrs["quantity"]}, against {dataset.attrs["error_against"]}. Costs: the least of {_runs(dataset)}.

![Error over CPU time](studies/{name}-front.png)

{said}

![CPU time by stage](studies/{name}-stages.png)

{table(dataset)}
"""


def _runs(dataset: xr.Dataset) -> str:
    """How many runs a cost is the least of; fewer than the study asks for where it was broken off."""
    least, most = int(dataset["repeats"].min()), int(dataset["repeats"].max())
    return f"{most} runs" if least == most else f"{least} to {most} runs (it was broken off)"


def table(dataset: xr.Dataset) -> str:
    """Every run: labels, error, cost, steps, front or why it failed."""
    dims = [dim for dim in DIMS if dim in dataset["status"].dims]
    words = [*dims, "scheme", "transfer"]
    head = [*words, "error [%]", "CPU [s]", "±", "steps", "front"]
    lines = [f"| {' | '.join(head)} |", "|" + " --- |" * len(head)]
    for row in rows(dataset):
        labels = [f"{row[dim]:g}" if isinstance(row[dim], float) else str(row[dim]) for dim in words]
        if row["status"] != "ok":
            lines.append(f"| {' | '.join(labels)} | {row['status']} | | | | |")
            continue
        front = "●" if row["pareto"] else ""
        error = percent(row["error"]) if row["error"] == row["error"] else "–"
        cost = f"{row['cpu_time']:.3g} | {row['cpu_time_spread']:.2g}"
        lines.append(f"| {' | '.join(labels)} | {error} | {cost} | {row['steps']:.0f} | {front} |")
    return "\n".join(lines)


def who_wins(datasets: list[xr.Dataset]) -> str:
    """All studies together: the table of each quantity, and the data profiles."""
    ranking = rank(datasets)
    profiles(ranking).savefig(FIGURES / "ranking.png", dpi=200)
    text = RANKING.format(files=" ".join(f"{name}.nc" for name in STUDIES), count=ranking.sizes["problem"])
    for quantity, meaning in QUANTITIES.items():
        if not bool(ranking["over_best"].sel(quantity=quantity).notnull().any()):
            text += f"\nNo run with an error below 10 % has a **{quantity}** ({meaning}) below 10 %, or none is known.\n"
            continue
        found = summary(ranking, quantity)
        head = [name for name in found[0] if name != "method"]
        text += f"\n**{quantity}**, {meaning}:\n\n| method | {' | '.join(head)} |\n|{' --- |' * (len(head) + 1)}\n"
        for row in found:
            text += f"| `{row['method']}` | " + " | ".join(f"{row[name]:.3g}" for name in head) + " |\n"
    return text.replace("| nan |", "| – |")


def main() -> None:
    """Run, draw, write."""
    FIGURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        folder.mkdir(parents=True, exist_ok=True)
        datasets = []
        for name in STUDIES:
            datasets.append(mpmfw.study(name, output=folder / f"{name}.nc"))
            print(name, *conclusions(datasets[-1]), sep="\n", flush=True)
    write(datasets)


def write(datasets: list[xr.Dataset]) -> None:
    """The page and its figures."""
    attributes = datasets[0].attrs
    conditions = (
        f"Here: {attributes['processor']}, {attributes['cores']}, {attributes['timing']}. Costs compare within this page alone, "
        "and where ± is large the machine was not quiet."
    )
    sections = [section(name, dataset) for name, dataset in zip(STUDIES, datasets, strict=True)]
    page = HEAD.format(conditions=conditions) + who_wins(datasets) + "".join(sections)
    (HERE / "studies.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
