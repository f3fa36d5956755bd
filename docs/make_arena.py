"""Print the tables of docs/arena.md from its records: ``python docs/make_arena.py``."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from pathlib import Path

from mpmfw.plots.records import Dot
from mpmfw.report.records import Record, dots_of, read_records

RECORDS = Path(__file__).parent / "arena" / "records"

HEAD = """| method | runs | motion [%] | spin [%] | noise [%] | gap [% of h] | lost [%] | CPU |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"""

#: Codes that each table leaves out, as they run too few scenes.
LEFT_OUT: tuple[set[str], ...] = ({"CalculiX", "Newton"}, {"CalculiX"}, {"Newton"})


def tables(records: Sequence[Record]) -> list[str]:
    """Return a table for each of ``LEFT_OUT``, over the scenes and cells that all its methods ran."""
    found = []
    for left_out in LEFT_OUT:
        listed = [one for one in records if one.status == "ok" and one.code.split()[0] not in left_out]
        ran: dict[str, set[tuple[str, float]]] = {}
        for one in listed:
            ran.setdefault(one.method, set()).add((one.problem, one.cell_size))
        shared = set.intersection(*ran.values()) if ran else set()
        found.append(rows([one for one in listed if (one.problem, one.cell_size) in shared]))
    return found


def rows(records: Sequence[Record]) -> str:
    """Return a row for each method: medians, and the worst error in brackets."""
    dots: dict[str, list[Dot]] = {}
    figures: dict[str, list[dict[str, float]]] = {}
    for dot in dots_of(records):
        dots.setdefault(dot.method, []).append(dot)
    for record in records:
        if record.status == "ok":
            figures.setdefault(record.method, []).append(record.figures)
    base = {dot.row: dot.cpu_time for dot in dots.get("penalty", []) if dot.cpu_time > 0.0}
    lines = [HEAD]
    for method in sorted(dots, key=lambda name: (dots[name][0].code != "mpmfw", name)):
        own, seen = dots[method], figures[method]
        cells = [method.replace(", ", ",<br>"), str(len(own))]
        for errors in ([dot.motion for dot in own], [dot.spin for dot in own]):
            values = [error for error in errors if not math.isnan(error)]
            cells.append(f"{statistics.median(values):.3g} ({max(values):.3g})" if values else "–")
        for name, scale in (("force_noise", 1.0), ("gap", 100.0), ("dissipation", 1.0)):
            cells.append(_median(scale * one[name] for one in seen if name in one))
        cells.append(_median(dot.cpu_time / base[dot.row] for dot in own if dot.row in base))
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _median(values: Iterable[float]) -> str:
    known = [value for value in values if not math.isnan(value)]
    return f"{round(statistics.median(known), 2) + 0.0:.2f}" if known else "–"  # no -0.00


if __name__ == "__main__":
    found = read_records(RECORDS)
    print(*tables(found), sep="\n\n")
