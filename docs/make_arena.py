"""Print the table of docs/arena.md from its records: ``python docs/make_arena.py``."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from mpmfw.report.records import Record, dots_of, read_records

RECORDS = Path(__file__).parent / "arena" / "records"

HEAD = """| method | runs | motion [%] | spin [%] | noise [%] | gap [% of h] | lost [%] | CPU |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"""


def rows(records: Sequence[Record]) -> str:
    """Return a row for each method: medians, and the worst error in brackets."""
    dots: dict[str, list[Any]] = {}
    figures: dict[str, list[dict[str, float]]] = {}
    for dot in dots_of(records):
        dots.setdefault(dot[2], []).append(dot)
    for record in records:
        if record.status == "ok":
            figures.setdefault(record.method, []).append(record.figures)
    base = {dot[:2]: dot[6] for dot in dots["penalty"]}
    lines = [HEAD]
    for method in sorted(dots, key=lambda name: (dots[name][0][3] != "mpmfw", name)):
        own, seen = dots[method], figures[method]
        cells = [method.replace(", ", ",<br>"), str(len(own))]
        for k in (4, 5):
            values = [dot[k] for dot in own if not math.isnan(dot[k])]
            cells.append(f"{statistics.median(values):.3g} ({max(values):.3g})" if values else "–")
        for name, scale in (("force_noise", 1.0), ("gap", 100.0), ("dissipation", 1.0)):
            cells.append(_median(scale * one[name] for one in seen if name in one))
        cells.append(_median(dot[6] / base[dot[:2]] for dot in own if dot[:2] in base))
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _median(values: Iterable[float]) -> str:
    known = [value for value in values if not math.isnan(value)]
    return f"{statistics.median(known):.2f}" if known else "–"


if __name__ == "__main__":
    print(rows(read_records(RECORDS)))
