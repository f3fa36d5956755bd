"""Outcomes kept in the output folder, a file each, so that cases run one by one make one page."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from mpmfw.validation.rows import Row
from mpmfw.validation.suite import Outcome


def save(outcome: Outcome, output: Path, quick: bool) -> None:
    """Write what came of a case to ``<case>.json``; infinite limits and NaN as Python's JSON writes them."""
    path = output / f"{outcome.folder.name}.json"
    kept = {
        "quick": quick,
        "rows": [asdict(row) for row in outcome.rows],
        "figures": [figure.name for figure in outcome.figures],
        "error": outcome.error,
        "seconds": outcome.seconds,
    }
    temporary = path.with_suffix(".tmp")
    temporary.write_text(json.dumps(kept, indent=1, ensure_ascii=False), encoding="utf-8")
    os.replace(temporary, path)


def kept(cases: Iterable[Path], output: Path, quick: bool) -> list[Outcome]:
    """Outcomes of earlier runs of these cases in the same version, reduced or full, in the order of ``cases``."""
    found = []
    for folder in cases:
        path = output / f"{folder.name}.json"
        if path.exists():
            read = json.loads(path.read_text(encoding="utf-8"))
            if read["quick"] == quick:
                rows = tuple(Row(**row) for row in read["rows"])
                figures = tuple(output / name for name in read["figures"])
                found.append(Outcome(folder, rows, figures, read["error"], read["seconds"]))
    return found
