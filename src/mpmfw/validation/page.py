"""The table of a suite: as CSV, and as the part of a page between two marks."""

from __future__ import annotations

import platform
import re
from collections import Counter
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


def write_csv(results: Iterable[CaseResult], path: Path) -> None:
    """Write every row with its full digits."""
    rows = [[getattr(row, name) for name in COLUMNS] for one in results for row in one.rows]
    replace_bytes(pd.DataFrame(rows, columns=COLUMNS).to_csv(index=False, na_rep="nan").encode(), path)


def summary(results: Sequence[CaseResult]) -> str:
    """Return one sentence: gates that hold and do not."""
    rows = [row for one in results for row in one.rows]
    count = Counter(row.verdict for row in rows)
    gates = count[Verdict.HOLDS] + count[Verdict.RED] + count[Verdict.KNOWN]
    text = (
        f"{len(results)} {'case' if len(results) == 1 else 'cases'}, {gates} gates: "
        f"{count[Verdict.HOLDS]} hold, {count[Verdict.RED]} red, {count[Verdict.KNOWN]} known red; "
        f"{len(rows) - gates} more values, of which "
        f"{count[Verdict.OUTSIDE]} outside the gates' limits and {count[Verdict.FAILED]} of runs that failed"
    )
    broken = ", ".join(one.folder.name for one in results if one.error)
    return text + (f"; broken cases: {broken}" if broken else "")


def write_page(results: Sequence[CaseResult], path: Path) -> None:
    """Write the results between the marks of a page; CSV and its figures in a folder of its name."""
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    page = path.read_text(encoding="utf-8") if path.is_file() else f"# Validation\n\n{BEGIN}\n{END}\n"
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    shown = set(re.findall(rf"\]\({re.escape(folder.name)}/([\w.-]+\.png)\)", page))
    for figure in (figure for one in results for figure in one.figures if figure.name in shown):
        Image.open(figure).convert("RGB").quantize(PALETTE).save(folder / figure.name, optimize=True)
    write_csv(results, folder / "rows.csv")
    text = "\n\n".join([BEGIN, *_parts(results, folder.name), END])
    replace_bytes(f"{before}{text}{after}".encode(), path)


def _parts(results: Sequence[CaseResult], folder: str) -> Iterable[str]:
    """Yield conditions, red gates, and the matrix."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("mpmfw", "numpy", "numba"))
    yield (
        f"Written by {', '.join(dict.fromkeys(one.command for one in results))}, Python "
        f"{platform.python_version()}, {packages}, {processor()}.\n{summary(results)}. "
        f"[All rows]({folder}/rows.csv)."
    )
    rows = [row for one in results for row in one.rows]
    red = [row for row in rows if row.verdict in (Verdict.RED, Verdict.KNOWN)]
    if red:
        yield "Gates that do not hold:"
        yield "\n".join(f"- `{row.case}`: {row}: {row.reason or 'not known why'}" for row in red)
    else:
        yield "Every gate holds."
    yield "Values within their limits, of those that have any, by case and method:"
    yield _matrix(rows)


def _matrix(rows: Sequence[Row]) -> str:
    cases = sorted({row.case for row in rows})
    usual = [str(Method(contact, "cpdi")) for contact in CONTACTS]
    usual += [str(Method("penalty", shape)) for shape in SHAPES if shape != "cpdi"]
    number = Counter(method for _, method in dict.fromkeys((row.case, row.method) for row in rows))
    columns = [one for one in usual if one in number]
    columns += [one for one in number if one and one not in usual and number[one] > len(cases) // 2]
    lines = [["case", *(f"`{one}`" for one in columns)], ["---"] * (len(columns) + 1)]
    for case in cases:
        own = [[row for row in rows if (row.case, row.method) == (case, one)] for one in columns]
        if any(texts := [_share(each) for each in own]):
            lines.append([f"`{case}`", *texts])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _share(rows: Sequence[Row]) -> str:
    """Return ``3/4``: values within their limits, of those that have any and of runs that failed."""
    judged = [
        row.verdict in (Verdict.HOLDS, Verdict.WITHIN) for row in rows if row.verdict is not Verdict.SHOWN
    ]
    return f"{sum(judged)}/{len(judged)}" if judged else ""
