"""The table of a suite: as CSV, and as the part of a page between two marks."""

from __future__ import annotations

import platform
import re
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path

import pandas as pd
from PIL import Image

from mpmfw.campaigns.work import processor
from mpmfw.results.replacing import replace_bytes
from mpmfw.validation.case import CONTACTS, SHAPES, Method
from mpmfw.validation.rows import Row, Verdict
from mpmfw.validation.suite import CaseResult

BEGIN, END = "<!-- mpmfw validate: begin -->", "<!-- mpmfw validate: end -->"
COLUMNS = (
    "case", "method", "quantity", "reference", "value", "unit", "least", "most", "verdict", "seconds", "note",
    "reason",
)  # fmt: skip
#: Colours of a page's figures; fewer make a smaller file.
PALETTE = 96


def rows_of(results: Iterable[CaseResult]) -> pd.DataFrame:
    """Return every row of some cases."""
    rows = [[getattr(row, name) for name in COLUMNS] for one in results for row in one.rows]
    return pd.DataFrame(rows, columns=COLUMNS)


def write_csv(results: Iterable[CaseResult], path: Path) -> None:
    """Write every row with its full digits."""
    replace_bytes(rows_of(results).to_csv(index=False, na_rep="nan").encode(), path)


def summary(results: Sequence[CaseResult]) -> str:
    """Return one sentence: gates that hold and do not."""
    count = rows_of(results)["verdict"].value_counts().reindex(list(Verdict), fill_value=0)
    gates = int(count[[Verdict.HOLDS, Verdict.RED, Verdict.KNOWN]].sum())
    text = (
        f"{len(results)} {'case' if len(results) == 1 else 'cases'}, {gates} gates: "
        f"{count[Verdict.HOLDS]} hold, {count[Verdict.RED]} red, {count[Verdict.KNOWN]} known red; "
        f"{count.sum() - gates} more values, of which "
        f"{count[Verdict.OUTSIDE]} outside the gates' limits and {count[Verdict.FAILED]} of runs that failed"
    )
    broken = ", ".join(one.folder.name for one in results if one.error)
    return text + (f"; broken cases: {broken}" if broken else "")


def red_rows(results: Iterable[CaseResult]) -> list[Row]:
    """Return the gates that do not hold."""
    return [row for one in results for row in one.rows if row.verdict in (Verdict.RED, Verdict.KNOWN)]


def write_page(results: Sequence[CaseResult], path: Path, command: str) -> None:
    """Write the results between the marks of a page; CSV and its figures in a folder of its name.

    ``command`` is the one that the page names."""
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    page = path.read_text(encoding="utf-8") if path.is_file() else f"# Validation\n\n{BEGIN}\n{END}\n"
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    shown = set(re.findall(rf"\]\({re.escape(folder.name)}/([\w.-]+\.png)\)", page))
    for figure in (figure for one in results for figure in one.figures if figure.name in shown):
        Image.open(figure).convert("RGB").quantize(PALETTE).save(folder / figure.name, optimize=True)
    write_csv(results, folder / "rows.csv")
    packages = ", ".join(f"{name} {version(name)}" for name in ("mpmfw", "numpy", "numba"))
    written = f"{command}, Python {platform.python_version()}, {packages}, {processor()}"
    red = [f"- `{row.case}`: {row}: {row.reason or 'not known why'}" for row in red_rows(results)]
    parts = [
        BEGIN,
        f"Written by {written}.\n{summary(results)}. [All rows]({folder.name}/rows.csv).",
        *(["Gates that do not hold:", "\n".join(red)] if red else ["Every gate holds."]),
        "Values within their limits, of those that have any, by case and method:",
        _matrix(rows_of(results)),
        END,
    ]
    text = "\n\n".join(parts)
    replace_bytes(f"{before}{text}{after}".encode(), path)


def _matrix(rows: pd.DataFrame) -> str:
    """Return ``3/4`` by case and method: values within limits, of those that have any or failed."""
    judged = rows[rows["verdict"] != Verdict.SHOWN]
    held = judged["verdict"].isin([Verdict.HOLDS, Verdict.WITHIN]).groupby([judged["case"], judged["method"]])
    shares = held.agg(lambda one: f"{one.sum()}/{len(one)}").unstack("method", fill_value="")
    usual = [str(Method(contact, "cpdi")) for contact in CONTACTS]
    usual += [str(Method("penalty", shape)) for shape in SHAPES if shape != "cpdi"]
    number = rows.groupby("method", sort=False)["case"].nunique()
    frequent = [one for one in number.index if one and number[one] > rows["case"].nunique() // 2]
    table = shares.reindex(columns=[one for one in usual if one in number], fill_value="")
    table = table.join(shares.reindex(columns=[one for one in frequent if one not in usual], fill_value=""))
    lines = [["case", *(f"`{one}`" for one in table)], ["---"] * (table.shape[1] + 1)]
    lines += [[f"`{case}`", *texts] for case, *texts in table.itertuples(name=None) if any(texts)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
