"""The suite's table: on a terminal, as CSV, and as a page of documentation."""

from __future__ import annotations

import csv
import io
import math
import platform
import shutil
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

from rich.table import Table

from mpmfw.campaigns.machine import processor
from mpmfw.results.replacing import replace_bytes
from mpmfw.validation.case import CONTACTS, RECOMMENDED, SHAPES, Method
from mpmfw.validation.known import KnownRed
from mpmfw.validation.rows import Row, Verdict
from mpmfw.validation.suite import CaseResult, shipped_suite

HEADINGS = ("case", "method", "quantity", "reference", "value", "tolerance", "verdict", "CPU s")
_STYLE = {
    Verdict.RED: "bold red",
    Verdict.HOLDS: "green",
    Verdict.FAILED: "yellow",
    Verdict.OUTSIDE: "yellow",
}


def number(value: float | str, unit: str = "") -> str:
    """Four significant digits and the unit; a dash for what is not known."""
    if isinstance(value, str):
        return value
    if math.isnan(value):
        return "–"
    return f"{value:.4g} {unit}".rstrip()


def cells(row: Row) -> tuple[str, ...]:
    """The texts of one row, in the order of :data:`HEADINGS`."""
    seconds = "–" if math.isnan(row.cpu_time) else f"{row.cpu_time:.2g}"
    value = row.note or number(row.value, row.unit)
    reference = number(row.reference, row.unit)
    return (row.case, row.method, row.quantity, reference, value, row.tolerance, row.verdict.value, seconds)


def terminal_table(outcomes: Iterable[CaseResult]) -> Table:
    """One table of all rows."""
    table = Table(title="Validation", title_justify="left")
    for heading in HEADINGS:
        table.add_column(heading, justify="right" if heading in ("value", "CPU s") else "left")
    for outcome in outcomes:
        for row in outcome.rows:
            table.add_row(*cells(row), style=_STYLE.get(row.verdict, ""))
        table.add_section()
    return table


def summary(outcomes: Sequence[CaseResult]) -> str:
    """One sentence: gates that hold and do not."""
    rows = [row for outcome in outcomes for row in outcome.rows]
    count = {verdict: sum(row.verdict is verdict for row in rows) for verdict in Verdict}
    broken = [outcome.folder.name for outcome in outcomes if outcome.error]
    gates = count[Verdict.HOLDS] + count[Verdict.RED]
    text = (
        f"{len(outcomes)} {'case' if len(outcomes) == 1 else 'cases'}, {gates} gates: {count[Verdict.HOLDS]} hold, "
        f"{count[Verdict.RED]} red; {len(rows) - gates} more values, of which {count[Verdict.OUTSIDE]} outside the "
        f"gates' limits and {count[Verdict.FAILED]} of runs that failed"
    )
    return text + (f"; broken cases: {', '.join(broken)}" if broken else "")


#: Columns of the CSV file: attributes of a row, but for the last heading but one, which says the unit.
_COLUMNS = (
    "case",
    "method",
    "quantity",
    "reference",
    "value",
    "unit",
    "least",
    "most",
    "verdict",
    "cpu_time",
    "note",
)


def write_csv(outcomes: Iterable[CaseResult], path: Path) -> None:
    """Write every row with its full digits."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(name.replace("cpu_time", "cpu_s") for name in _COLUMNS)
    writer.writerows([getattr(row, name) for name in _COLUMNS] for one in outcomes for row in one.rows)
    replace_bytes(text.getvalue().encode(), path)


def write_page(
    outcomes: Sequence[CaseResult],
    path: Path,
    known: Sequence[KnownRed] = (),
    repository: str = "..",
) -> None:
    """Write the page of documentation, its figures in a folder of its name beside it.

    Parameters
    ----------
    known
        Gates that are known not to hold, for their reasons.
    repository
        The way from the page to the folder that holds the suite, for links to the cases.
    """
    pictures = path.with_suffix("")
    pictures.mkdir(parents=True, exist_ok=True)
    parts = [_head(outcomes, known), *(_section(one, pictures, repository) for one in outcomes)]
    replace_bytes(("\n\n".join(parts) + "\n").encode(), path)


def _head(outcomes: Sequence[CaseResult], known: Sequence[KnownRed]) -> str:
    """What the tables are, under which conditions, and which gates do not hold."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("mpmfw", "numpy", "numba"))
    return "\n\n".join(
        [
            f"# {_title(outcomes)}",
            f"Written by {_written_by(outcomes)}; cases run one by one into the same folder join as long as the code is the "
            f"same. {summary(outcomes)}.",
            f"Conditions: Python {platform.python_version()}, {packages}; {processor()}. CPU times are of the steps and of "
            "settling, without compilation; where several processes ran, they shared the machine.",
            "A *gate* decides whether the suite passes; it binds the recommended combination, penalty contact with CPDI "
            "or CPDI2 and the scene's defaults, and what a case names beside it (`binds`). Other methods are shown at the "
            "same limits: *within* or *outside*, and so are these where their case says that a limit is not kept yet, and "
            "why (`open`). A method that failed keeps its row.",
            *_red(outcomes, known),
            *_matrix(outcomes),
        ]
    )


def _title(outcomes: Sequence[CaseResult]) -> str:
    """What a suite among mpmfw's own is called by its README."""
    suite = outcomes[0].folder.parent if outcomes else Path()
    if suite.parent.resolve() != shipped_suite().resolve():
        return "Validation"
    return (suite / "README.md").read_text(encoding="utf-8").splitlines()[0].lstrip("# ") + ": what holds"


def _matrix(outcomes: Iterable[CaseResult]) -> list[str]:
    """Of every case and method, how many of the values that have limits are within them."""
    passes = {outcome.folder.name: _passes(outcome.rows) for outcome in outcomes}
    methods = [one for one in _columns(passes.values()) if any(one in found for found in passes.values())]
    lines = [["case", *(one.replace("(", " (") for one in methods)], ["---"] * (len(methods) + 1)]
    lines += [
        [f"`{name}`", *(found.get(one, "") for one in methods)]
        for name, found in passes.items()
        if found.keys() & set(methods)
    ]
    if len(lines) == 2:
        return []
    return [
        "Values within their limits, of those that have any and of runs that failed; methods as the scenes have them:",
        _pipes(lines),
    ]


def _columns(passes: Collection[Mapping[str, str]]) -> list[str]:
    """The recommended contact with every shape function, the others with CPDI, and what more than half of the cases have."""
    recommended: list[str] = RECOMMENDED["shapes"]
    shapes = [*recommended, *(one for one in SHAPES if one not in recommended)]
    methods = [str(Method(contact, shapes[0])) for contact in CONTACTS]
    methods += [str(Method(contact, one)) for contact in RECOMMENDED["contacts"] for one in shapes[1:]]
    usual = Counter(method for found in passes for method in found if method)
    return list(
        dict.fromkeys([*methods, *(one for one, count in usual.items() if count > max(1, len(passes) // 2))])
    )


def _passes(rows: Iterable[Row]) -> dict[str, str]:
    """``3 / 4`` by method, of those that have values with limits."""
    judged: dict[str, list[bool]] = {}
    for row in rows:
        if row.verdict is not Verdict.SHOWN:
            judged.setdefault(row.method, []).append(row.verdict in (Verdict.HOLDS, Verdict.WITHIN))
    return {method: f"{sum(each)} / {len(each)}" for method, each in judged.items()}


def _written_by(outcomes: Sequence[CaseResult]) -> str:
    """The commands that were run, each with the cores that it ran on."""
    text = dict.fromkeys((outcome.command, outcome.cores) for outcome in outcomes if outcome.command)
    return ", ".join(f"`{command}` on {cores}" for command, cores in text)


def _red(outcomes: Sequence[CaseResult], known: Sequence[KnownRed]) -> list[str]:
    """The gates that do not hold, with the reason where it is known."""
    rows = [row for outcome in outcomes for row in outcome.rows if row.verdict is Verdict.RED]
    if not rows:
        return ["Every gate holds."]
    lines = []
    for row in rows:
        why = next((gate.why for gate in known if gate.is_of(row)), "not known why")
        value = f"{number(row.value, row.unit)} ({row.tolerance})"
        lines.append(f"- {row.case}: {row.method}, {row.quantity} {value}: {why}")
    return ["Gates that do not hold:", "\n".join(lines)]


def _section(outcome: CaseResult, pictures: Path, repository: str) -> str:
    """Title and first paragraph of the case's README, table, figures."""
    readme = (outcome.folder / "README.md").read_text(encoding="utf-8").strip().split("\n\n")
    title, introduction = readme[0].lstrip("# "), readme[1] if len(readme) > 1 else ""
    suite, option = outcome.folder.parent, ""
    if suite.parent.resolve() == shipped_suite().resolve():
        suite, option = Path(suite.parent.name, suite.name), f"--suite {suite.name} "
    else:
        suite = Path(suite.name)
    link = f"{repository}/{suite.as_posix()}/{outcome.folder.name}/README.md"
    lines = [
        f"## {title}",
        f"{introduction}",
        f"[Set-up, tolerances and their sources]({link}); `mpmfw validate {option}{outcome.folder.name}`.",
    ]
    if outcome.error:
        lines.append(f"The case went wrong:\n\n```\n{outcome.error}```")
    if outcome.rows:
        lines.append(_markdown(outcome.rows))
    for figure in outcome.figures:
        shutil.copyfile(figure, pictures / figure.name) if figure.parent != pictures else None
        lines.append(f"![{title}]({pictures.name}/{figure.name})")
    return "\n\n".join(lines)


def _markdown(rows: Sequence[Row]) -> str:
    lines: list[Sequence[str]] = [HEADINGS[1:], ["---"] * len(HEADINGS[1:])]
    for row in rows:
        verdict = f"**{row.verdict.value}**" if row.verdict is Verdict.RED else row.verdict.value
        texts = (*cells(row)[1:6], verdict, cells(row)[7])
        lines.append([text.replace("|", "\\|").replace("\n", " ") for text in texts])
    return _pipes(lines)


def _pipes(lines: Iterable[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
