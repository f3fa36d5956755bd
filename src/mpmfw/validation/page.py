"""The table of a suite: as CSV, and as the part of a page between two marks."""

from __future__ import annotations

import platform
import re
from collections import Counter
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd
from PIL import Image

from mpmfw.campaigns.work import processor
from mpmfw.results.replacing import replace_bytes
from mpmfw.validation.case import CONTACTS, SHAPES, Method

Rows = list[dict[str, Any]]
BEGIN, END = "<!-- mpmfw validate: begin -->", "<!-- mpmfw validate: end -->"
#: Verdicts on gates.
GATES = ("holds", "RED", "known red")
#: Colours of a page's figures; fewer make a smaller file.
PALETTE = 96


def said(row: Mapping[str, Any]) -> str:
    """Return a row as a sentence."""
    value, reason = row["note"] or f"{row['value']:.4g} {row['unit']}".rstrip(), row["reason"]
    cured = ", which holds, and is marked as known red" if reason and row["verdict"] == "RED" else ""
    text = f"{row['method']}, {row['quantity']}: {value} ({row['least']:g} … {row['most']:g}){cured}"
    return f"{text}: {reason}" if reason else text


def write_csv(rows: Rows, path: Path) -> None:
    """Write every row with its full digits."""
    replace_bytes(pd.DataFrame(rows).to_csv(index=False, na_rep="nan").encode(), path)


def summary(rows: Rows) -> str:
    """Return one sentence: gates that hold and do not."""
    count, cases = Counter(row["verdict"] for row in rows), len({row["case"] for row in rows})
    holds, red, known = (count[verdict] for verdict in GATES)
    return (
        f"{cases} {'case' if cases == 1 else 'cases'}, {holds + red + known} gates: {holds} hold, {red} red, "
        f"{known} known red; {len(rows) - holds - red - known} more values, of which {count['outside']} "
        f"outside the gates' limits and {count['failed']} of runs that failed"
    )


def write_page(rows: Rows, path: Path, command: str, figures: Path | None = None) -> None:
    """Write the results between the marks of a page; CSV and its figures in a folder of its name.

    ``command`` is the one that the page names; ``figures`` are those in this folder that the page shows."""
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    page = path.read_text(encoding="utf-8") if path.is_file() else f"# Validation\n\n{BEGIN}\n{END}\n"
    before, _, rest = page.partition(BEGIN)
    for name in re.findall(rf"\]\({re.escape(folder.name)}/([\w.-]+\.png)\)", page):
        if figures is not None and (figures / name).is_file():
            image = Image.open(figures / name).convert("RGB").quantize(PALETTE)
            image.save(folder / name, optimize=True)
    write_csv(rows, folder / "rows.csv")
    packages = ", ".join(f"{name} {version(name)}" for name in ("mpmfw", "numpy", "numba"))
    written = f"{command}, Python {platform.python_version()}, {packages}, {processor()}"
    known = [row for row in rows if row["verdict"] in GATES[1:]]
    red = [f"- `{row['case']}`: {said(row)}" for row in known]
    parts = [
        f"{BEGIN}\n\nWritten by {written}.\n{summary(rows)}. [All rows]({folder.name}/rows.csv).",
        "\n".join(["Gates that do not hold:\n", *red]) if red else "Every gate holds.",
        "Values within their limits, of those that have any, by case and method:",
        f"{_matrix(pd.DataFrame(rows)) if rows else ''}\n\n{END}",
    ]
    text = "\n\n".join(parts)
    replace_bytes(f"{before}{text}{rest.partition(END)[2]}".encode(), path)


def _matrix(rows: pd.DataFrame) -> str:
    """Return ``3/4`` by case and method: values within limits, of those that have any or failed."""
    judged = rows[rows["verdict"] != "shown"]
    held = judged["verdict"].isin(["holds", "within"]).groupby([judged["case"], judged["method"]])
    shares = held.agg(lambda one: f"{one.sum()}/{len(one)}").unstack("method", fill_value="")
    usual = [str(Method(contact, "cpdi")) for contact in CONTACTS]
    usual += [str(Method("penalty", shape)) for shape in SHAPES if shape != "cpdi"]
    number = rows.groupby("method", sort=False)["case"].nunique()
    frequent = [one for one in number.index if one and number[one] > rows["case"].nunique() // 2]
    shown = [one for one in dict.fromkeys([*usual, *frequent]) if one in number]
    table = shares.reindex(columns=shown, fill_value="")
    lines = [["case", *(f"`{one}`" for one in table)], ["---"] * (table.shape[1] + 1)]
    lines += [[f"`{case}`", *texts] for case, *texts in table.itertuples(name=None) if any(texts)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
