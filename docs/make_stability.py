"""Write docs/stability.md: every hard case by every method; ``python docs/make_stability.py``.

In the plane, methods that must hold or stay bounded run at four places, the others at one; in space all run at four. Takes about
fifteen minutes of one core, of which five in space; with ``MPMFW_FULL_STABILITY=1``, which runs the long cases in full, about an
hour. ``--only plane`` or ``--only space`` makes one half anew and keeps the other.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

PAGE = Path(__file__).with_name("stability.md")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "stability"))

import hard_cases  # noqa: E402
import hard_scenes  # noqa: E402
import known  # noqa: E402
from design import rows  # noqa: E402
from places import PLACES, PLACES_IN_SPACE, rotation_of  # noqa: E402

HEAD = """\
# Hard cases

<!-- Made by docs/make_stability.py: edit that, or tests/stability. -->

Blocks of a few cells in the situations that break contact methods, a few hundred steps each; `tests/stability` describes
them as data and runs them as tests. What must hold: no NaN; linear momentum to 1e-10 where no load acts; energy plus
dissipation at most 1.005 of the start in every step (1.25 in between and 1.05 at the end where the step is at 0.9 of the limit);
penetration of at most 0.1 cells (0.15 where bodies overlap by 0.1 at first, 0.2 in fast spin, 0.5 at sharp corners and at
0.3 c); no surface node more than half a cell farther from its body than at first; bodies at rest within 0.01 cells. A step past
the limit and an overlap must be refused. `bardenhagen` with `gimp` and `cpdi` must stay bounded: the energy itself, without the
dissipation, at most 1.05, and momentum.

Energy is taken with positions and velocities at the same time, Σ m v·v'/2 with the velocities of the steps before and after:
the sum of what a step leaves, as the results' file holds it, swings to either side by up to 2 % at the default step.

**ok**: holds, with the largest energy over the start (of `bardenhagen` with `gimp` and `cpdi` without dissipation).
**refused**: as it must be. A letter: known to fail, for the reason below the table. Methods that must hold or stay bounded ran at
four places (as it stands; shifted by 0.31 and 0.17 cells; turned by 30°; both) and the worst is shown, with n/4 the number of
places that fail; the others ran at one place. `none`, `nairn` and `hamad2017` ran with CPDI alone, since what fails of them is
the contact; `separate` lets bodies pass through each other, and no case is about that. The long cases are {long}.
"""
LENGTHS = {
    True: "100 000 steps at rest and 100 cells of sliding",
    False: "cut to 1000 steps at rest and about 10 cells of sliding; `MPMFW_FULL_STABILITY=1` runs them in full",
}
HEAD_IN_SPACE = """\

{title}

Boxes of three cells in each direction, with surfaces of triangles, by the same bounds (`python docs/make_stability.py --only
space`). All methods ran at four places: as the scene stands; shifted by 0.31, 0.17 and 0.77 cells; turned by 20°, 35° and 50°
about x, y and z; both. CPDI2 has no layout in space.
"""
IN_SPACE = "## In space"
Key = tuple[str, str, str]
Found = dict[Key, list[tuple[Any, list[str]]]]


def tasks_in_plane() -> list[tuple[Any, ...]]:
    """Case, method and place of every run in the plane."""
    one = {row[:3]: row[3:] for row in rows(full=True)}
    strict = hard_cases.MUST_HOLD + hard_cases.MUST_STAY_BOUNDED
    tasks: list[tuple[Any, ...]] = []
    for case in hard_cases.CASES:
        for method in hard_cases.METHODS:
            if hard_cases.applies(case, method[0]):
                key = (case, *method)
                tasks += [(*key, *place) for place in (PLACES if method in strict else [one[key]])]
    return tasks


def tasks_in_space() -> list[tuple[Any, ...]]:
    """Those in space."""
    keys = itertools.product(hard_cases.IN_SPACE, hard_cases.METHODS_IN_SPACE, PLACES_IN_SPACE)
    return [(case, *method, *place) for case, method, place in keys]


def runs(workers: int, tasks: list[tuple[Any, ...]]) -> Found:
    """Outcomes and complaints by case and method, from so many processes."""
    found: Found = {}
    with ProcessPoolExecutor(workers) as pool:
        for task, outcome in zip(tasks, pool.map(run, tasks), strict=True):
            case, contact, shape = task[:3]
            said = hard_cases.complaints(case, contact, shape, outcome)
            found.setdefault((case, contact, shape), []).append((outcome, said))
            print(*task, outcome.status, *said, flush=True)
    return found


def run(task: tuple[Any, ...]) -> Any:
    """Outcome of a case by a method at a place."""
    return hard_cases.outcome(*task)


def cell(key: tuple[str, str, str], found: list[tuple[Any, list[str]]], reasons: list[str]) -> str:
    """What stands in the table."""
    failed = [said for _, said in found if said]
    if failed:
        why = known.reason(*key) or known.placed_reason(*key) or "not explained: " + _plain(failed[0][0])
        if why not in reasons:
            reasons.append(why)
        worst = max((o.energy for o, _ in found if o.energy == o.energy), default=float("nan"))
        share = f" {len(failed)}/{len(found)}" if len(found) > 1 else ""
        amount = f" {worst:.3f}" if len(found) > 1 else ""
        return f"**{chr(65 + reasons.index(why))}**{share}{amount}"
    if all(o.status == "refused" for o, _ in found):
        return "refused"
    bounded = key[1:] in hard_cases.MUST_STAY_BOUNDED
    return f"ok {max(o.stored if bounded else o.energy for o, _ in found):.3f}"


def _plain(message: str) -> str:
    return re.sub(r": at time.*", "", message)


def in_plane(found: Found) -> str:
    """The page without what is in space."""
    methods = hard_cases.MUST_HOLD + hard_cases.MUST_STAY_BOUNDED
    text = [HEAD.format(long=LENGTHS[hard_scenes.FULL]), *_table(found, hard_cases.CASES, hard_cases.METHODS)]
    text += ["", "## The answer's change", "", *_changes(found, hard_cases.CASES, methods, PLACES)]
    return "\n".join(text) + "\n"


def in_space(found: Found) -> str:
    """The section of the page that is in space."""
    methods, cases = hard_cases.METHODS_IN_SPACE, hard_cases.IN_SPACE
    text = [HEAD_IN_SPACE.format(title=IN_SPACE), *_table(found, cases, methods)]
    text += ["", "The answer's change:", "", *_changes(found, cases, methods, PLACES_IN_SPACE)]
    return "\n".join(text) + "\n"


def _table(found: Found, cases: dict[str, Any], methods: list[tuple[str, str]]) -> list[str]:
    reasons: list[str] = []
    lines = _header(methods)
    for case, asked in cases.items():
        cells = [cell((case, *m), found[case, *m], reasons) if (case, *m) in found else "–" for m in methods]
        lines.append(f"| {asked.said} | " + " | ".join(cells) + " |")
    if reasons:
        lines += ["", "Known to fail, and why:", ""]
    return lines + [f"- **{chr(65 + k)}**: {why}." for k, why in enumerate(reasons)]


def _header(methods: list[tuple[str, str]]) -> list[str]:
    return [
        "| case | " + " | ".join(f"{c} {s}" for c, s in methods) + " |",
        "| --- |" + " --- |" * len(methods),
    ]


def change(found: list[tuple[Any, list[str]]], place: int, turn: Any) -> float:
    """Largest difference of a body's displacement from that of the scene as it stands [cells], turned back."""
    first, other = found[0][0], found[place][0]
    if first.status != "ok" or other.status != "ok":
        return float("nan")
    turned = other.travel @ rotation_of(turn) * (first.time / other.time)
    return float(np.linalg.norm(turned - first.travel, axis=1).max())


def _changes(found: Found, cases: dict[str, Any], methods: list[tuple[str, str]], places: Any) -> list[str]:
    lines = [
        "Largest difference of a body's displacement at the end from that of the scene as it stands, in cells: shifted / turned.",
        "Where steps have other lengths the displacement is scaled to the same time.",
        "",
        *_header(methods),
    ]
    for case, asked in cases.items():
        if asked.refusal is None:
            cells = []
            for method in methods:
                both = found.get((case, *method))
                cells.append(
                    "–"
                    if both is None
                    else " / ".join(f"{change(both, k, places[k][1]):.2g}" for k in (1, 2))
                )
            lines.append(f"| {asked.said} | " + " | ".join(cells) + " |")
    return lines


def write_table(path: Path, found: Found) -> None:
    """Every run as a row of comma-separated values."""
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(
            [
                "case",
                "contact",
                "shape",
                "run",
                "status",
                "energy",
                "energy_end",
                "stored",
                "momentum",
                "penetration",
            ]
        )
        for key, outcomes in found.items():
            for k, (o, _) in enumerate(outcomes):
                table.writerow(
                    [*key, k, o.status, o.energy, o.energy_end, o.stored, o.momentum, o.penetration]
                )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--table", type=Path, help="write every run to this file too")
    parser.add_argument("--workers", type=int, default=1, help="processes that run the cases")
    parser.add_argument("--only", choices=("plane", "space"), help="make this half anew")
    asked = parser.parse_args()
    plane, space = (asked.only in (None, half) for half in ("plane", "space"))
    all_runs = runs(asked.workers, (tasks_in_plane() if plane else []) + (tasks_in_space() if space else []))
    before, _, after = PAGE.read_text(encoding="utf-8").partition(f"\n{IN_SPACE}\n")
    first = in_plane(all_runs) if plane else before
    PAGE.write_text(first + (in_space(all_runs) if space else f"\n{IN_SPACE}\n{after}"), encoding="utf-8")
    if asked.table is not None:
        write_table(asked.table, all_runs)
