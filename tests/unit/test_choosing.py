"""docs/guide/choosing.md says what the tables of docs/studies.md and docs/validation.md say, sentence by sentence."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"

#: How far a cost may be from the one stated: costs are measured, and a rerun moves them.
COST = 0.25


def text(page: str) -> str:
    return (DOCS / page).read_text(encoding="utf-8")


class Run(NamedTuple):
    """A row of a table of docs/studies.md."""

    study: str
    scene: str
    contact: str
    shape: str
    fineness: int  # 0 is the coarsest
    error: float  # [%]
    cpu: float  # [s]
    front: bool


def cells_of(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("| \n").split("|")]


def runs_of(page: str) -> list[Run]:
    """All runs that have an error."""
    found = []
    for part in page.split("\n## ")[1:]:
        study = re.search(r"mpmfw study ([\w-]+)", part)
        if study is None:  # who wins over all studies
            continue
        table = [line for line in part.splitlines() if line.startswith("| ")]
        head = cells_of(table[0])
        rows = [dict(zip(head, [*cells_of(line), ""], strict=False)) for line in table[2:]]
        sizes = list(dict.fromkeys(row["cell_size"] for row in rows))
        found += [
            Run(
                study[1], row.get("scene", ""), row["contact"], row["shape"], sizes.index(row["cell_size"]),
                float(row["error [%]"]), float(row["CPU [s]"]), row["front"] == "●",
            )
            for row in rows
            if not row["error [%]"].startswith("failed")
        ]  # fmt: skip
    return found


RUNS = runs_of(text("studies.md"))
SOFT = ("gimp", "cpdi", "cpdi2", "bspline")  # all but the linear functions


def pick(**labels: object) -> list[Run]:
    """Runs with these labels; a tuple means any of its values."""
    chosen = [
        run
        for run in RUNS
        if all(
            getattr(run, key) in (value if isinstance(value, tuple) else (value,))
            for key, value in labels.items()
        )
    ]
    assert chosen, labels
    return chosen


def span(values: Iterable[float]) -> tuple[float, float]:
    known = list(values)
    return min(known), max(known)


def errors(**labels: object) -> tuple[float, float]:
    """Least and largest error [%]."""
    return span(run.error for run in pick(**labels))


def error(**labels: object) -> tuple[float, ...]:
    """The error of every run [%], in the order of the table."""
    return tuple(run.error for run in pick(**labels))


def pairs(change: dict[str, object], **labels: object) -> list[tuple[Run, Run]]:
    """Runs with these labels, and the same ones with some labels changed, where both have ended."""
    known = {run[:5]: run for run in RUNS}
    others = {run: run._replace(**change)[:5] for run in pick(**labels)}  # type: ignore[arg-type]
    return [(run, known[other]) for run, other in others.items() if other in known]


def cost(change: dict[str, object], **labels: object) -> tuple[float, float]:
    """Least and largest CPU time, as a share of that of the same runs with some labels changed."""
    return span(run.cpu / other.cpu for run, other in pairs(change, **labels))


def front_with_slip() -> tuple[float, ...]:
    """Errors of the two last runs of the front [%], GIMP's and CPDI's with the strongest classical form at coarse cells."""
    last = sorted(pick(**SLIP, front=True), key=lambda run: run.cpu)[-2:]
    named = [(run.contact, run.shape, run.fineness) for run in last] == [
        (STRONG, "gimp", 0),
        (STRONG, "cpdi", 0),
    ]
    return tuple(run.error for run in last) if named else (math.nan,) * 2


def front_without_slip() -> tuple[float, ...]:
    """Error and cost of the first and the last B-splines of the front; not numbers where it ends with others."""
    front = sorted((run for run in pick(**NO_SLIP, contact="penalty") if run.front), key=lambda run: run.cpu)
    splines = [run for run in front if run.shape == "bspline"]
    if front[-1] is not splines[-1]:
        return (math.nan,) * 4
    return splines[0].error, splines[0].cpu, splines[-1].error, splines[-1].cpu


def departure(method: str) -> float:
    """Largest departure from the pressure that docs/validation.md gives for a method [%]."""
    row = re.search(
        rf"^\| {method} \| largest departure, at [^|]*\| 0 % \| ([\d.]+) %", text("validation.md"), re.M
    )
    assert row, method
    return float(row[1])


ROLLING = {"study": "rolling-cylinder"}
SLIP = {**ROLLING, "scene": "slip"}
NO_SLIP = {**ROLLING, "scene": "no slip"}
BLOCK = {"study": "sliding-block"}
STRESS = {"study": "contact-stress"}
RINGS = {"study": "rings", "scene": "16 points a cell"}
FEWER = {"study": "rings", "scene": "4 points a cell"}
OWN = ("cpdi", "cpdi2")
OTHERS = ("linear", "gimp", "bspline")
STRONG = "bardenhagen(criterion=position, normal=master)"
GIVEN = "bardenhagen(direction=[0.0, 1.0], normal=specified)"
CENTRES = ("gimp", "cpdi", "cpdi2")
HATS = ("linear", "gimp", "cpdi", "cpdi2")


def turned(scene: str, *measured: tuple[str, str], layout: str | None = None) -> tuple[float, ...]:
    """The worst error of all orientations and layouts, or of one layout, for each contact and quantity."""
    found = json.loads(text("turned.json"))[scene]
    worst = []
    for contact, quantity in measured:
        rows = [row for row in found[contact] if layout in (None, row["layout"])]
        worst.append(max(abs(row[quantity]) for row in rows))
    return tuple(worst)


SOFT_SPRINGS = "penalty(kappa=1)"
ROLLS = ("slip", "no-slip")

#: Sentences with their numbers, what the tables have for each, and how they are compared: e errors, in the last digit
#: that is stated; c costs, within ``COST``; m at most what is stated, and no less than a quarter of it.
CLAIMS = [
    ("an error of {} to {} % wherever", errors(study=("rolling-cylinder", "sliding-block"), contact="none"), "ee"),
    ("(rolling: {} to {} %", errors(**SLIP, contact="penalty"), "ee"),
    ("and {} to {} %, B-splines apart; the block within {} %)",
     (*errors(**SLIP, contact=STRONG, shape=HATS), *errors(**BLOCK, contact=(STRONG, "penalty"), shape=HATS)[1:]), "eem"),
    ("`penalty` has {} to {} % with all but linear", errors(**NO_SLIP, contact="penalty", shape=SOFT), "ee"),
    ("the strongest classical form {} to {} % with GIMP", errors(**NO_SLIP, contact=STRONG, shape=CENTRES), "ee"),
    ("impulse curve {} to {} % and {} to {} %, the plain form {} to {} %",
     (*errors(**RINGS, contact="penalty"), *errors(**RINGS, contact=STRONG), *errors(**RINGS, contact="bardenhagen")), "eeeeee"),
    ("CPDI and CPDI2 have {} to {} % at the fine cells in place of {} %, in {} of the time, linear functions {} to {} %",
     (*errors(**FEWER, contact="penalty", shape=OWN, fineness=1), errors(**RINGS, contact="penalty", shape=OWN, fineness=1)[1],
      cost({"scene": "16 points a cell"}, **FEWER, contact="penalty", shape=OWN, fineness=1)[1],
      *errors(**FEWER, contact="penalty", shape="linear")), "eeecee"),
    ("{} % of a uniform pressure", errors(**STRESS, contact="penalty", shape=OWN)[1:], "e"),
    ("other shape functions {} to {} %, `bardenhagen` {} to {} %",
     (*errors(**STRESS, contact="penalty", shape=OTHERS), *errors(**STRESS, contact="bardenhagen")), "eeee"),
    ("interface's normal given {} to {} %", errors(**STRESS, contact=GIVEN), "ee"),
    ("rings take {} to {} of the time of `penalty`", cost({"contact": "penalty"}, **RINGS, contact="bardenhagen"), "cc"),
    ("linear functions too slowly by {} to {} %", errors(**BLOCK, contact="bardenhagen", shape="linear"), "ee"),
    ("`penalty` is off by at most {} %, `lcp` by {} %, the strongest classical form by {} %, `nairn` by {} %",
     turned("block", *((c, "acceleration") for c in (SOFT_SPRINGS, "lcp", STRONG, "nairn"))), "eeee"),
    ("strongest form has at most {} %; a lattice", turned("block", (STRONG, "acceleration"), layout="fitted"), "e"),
    ("`penalty` has at most {} and {} %, the strongest classical form {} and {} %, `nairn` {} and {} %",
     tuple(turned(scene, (c, "displacement"))[0] for c in (SOFT_SPRINGS, STRONG, "nairn") for scene in ROLLS), "eeeeee"),
    ("Impulses between surfaces have {} and {} %, `lcp` {} and {} %",
     tuple(turned(scene, (c, "displacement"))[0] for c in ("surfaces+impulse", "lcp") for scene in ROLLS), "eeee"),
    ("displacement with slip, off by at most {} %, but its spin is off by up to {} %; without slip it has up to {} %. `penalty` "
     "has {} and {} %",
     (*turned("slip-fine", (STRONG, "displacement"), (STRONG, "spin")), *turned("no-slip-fine", (STRONG, "displacement")),
      *turned("slip-fine", (SOFT_SPRINGS, "displacement")), *turned("no-slip-fine", (SOFT_SPRINGS, "displacement"))), "eeeee"),
    ("form has at most {} %, `penalty` {} %", turned("rings", (STRONG, "impulse"), (SOFT_SPRINGS, "impulse")), "ee"),
    ("With `penalty` every shape function has {} to {} %", errors(**SLIP, contact="penalty"), "ee"),
    ("classical form has {} to {} % with all but B-splines ({}, {}, {} %)",
     (*errors(**SLIP, contact=STRONG, shape=HATS), *error(**SLIP, contact=STRONG, shape="bspline")), "eeeee"),
    ("GIMP's {} % and CPDI's {} % at the coarsest", front_with_slip(), "ee"),
    ("{} to {} % at h = 0.8 m", errors(**SLIP, contact="bardenhagen", shape=HATS, fineness=0), "ee"),
    ("{} to {} % at 0.4 m", errors(**SLIP, contact="bardenhagen", shape=HATS, fineness=1), "ee"),
    ("{} to {} % at 0.2 m", errors(**SLIP, contact="bardenhagen", shape=HATS, fineness=2), "ee"),
    ("(B-splines {}, {}, {} %: smoother", error(**SLIP, contact="bardenhagen", shape="bspline"), "eee"),
    ("{} to {} times the CPU time of the strongest form at the coarse cells",
     cost({"contact": STRONG}, **ROLLING, contact="penalty", fineness=0), "cc"),
    ("and {} to {} at the fine ones", cost({"contact": STRONG}, **ROLLING, contact="penalty", fineness=2), "cc"),
    ("`penalty` is within {} % with every", errors(**NO_SLIP, contact="penalty", shape=SOFT)[1:], "m"),
    ("but the linear ones ({}, {} and {} %", error(**NO_SLIP, contact="penalty", shape="linear"), "eee"),
    ("that of B-splines: {} % at {} s, {} % at {} s", front_without_slip(), "ecec"),
    ("form has {} to {}, {} and {} to {} %, the plain one {} to {}, {} and {} to {} %, and {}, {}, {} % with B-splines",
     tuple(e for contact in (STRONG, "bardenhagen") for k in range(3)
           for e in errors(**NO_SLIP, contact=contact, shape=CENTRES, fineness=k)[k == 1:])
     + error(**NO_SLIP, contact="bardenhagen", shape="bspline"), "eeeeeeeeeeeee"),
    ("`none` has {} to {} % with CPDI", errors(**STRESS, contact="none", shape=OWN), "ee"),
    ("CPDI2, in {} to {} of the time of `penalty`", cost({"contact": "penalty"}, **STRESS, contact="none", shape=OWN), "cc"),
    ("up to {} times the time of `gimp` with `penalty`", cost({"shape": "gimp"}, contact="penalty", shape="cpdi")[1:], "c"),
    ("`gimp` with `penalty`, up to {} times with other",
     cost({"shape": "gimp"}, contact=("none", "bardenhagen"), shape="cpdi")[1:], "c"),
    ("up to {} times the time of `cpdi` with `penalty`", cost({"shape": "cpdi"}, contact="penalty", shape="cpdi2")[1:], "c"),
    ("`cpdi` with `penalty`, up to {} times with other",
     cost({"shape": "cpdi"}, contact=("none", "bardenhagen"), shape="cpdi2")[1:], "c"),
    ("off by up to {} % beside walls", (departure("penalty, gimp"),), "e"),
    ("a point; {} to {} % root mean square), {} % with `map",
     (*errors(**STRESS, contact="penalty", shape="gimp"), departure("penalty, gimp, plain map")), "eee"),
    ("contact stress is off by up to {} % (largest departure of a point; {} to {} %",
     (departure("penalty, bspline"), *errors(**STRESS, contact="penalty", shape="bspline")), "eee"),
    ("without slip has {} % at cells a fourth", error(**NO_SLIP, contact="penalty", shape="linear", fineness=2), "e"),
    ("where others have at most {} %", errors(**NO_SLIP, contact="penalty", shape=SOFT, fineness=0)[1:], "m"),
]  # fmt: skip


def numbers_in(page: str, sentence: str) -> list[str]:
    """The numbers that stand at the ``{}`` of a sentence; none if the page does not have it."""
    found = re.search(re.escape(sentence).replace(r"\{\}", r"(\d+(?:\.\d+)?)"), page)
    return list(found.groups()) if found else []


def agrees(stated: str, value: float, how: str) -> bool:
    """Whether a number of the guide is that of a table."""
    if how == "c":
        return abs(float(stated) / value - 1.0) <= COST
    if how == "m":
        return 0.25 * float(stated) <= value <= float(stated)
    return abs(float(stated) - value) <= 1.0001 * 10.0 ** -len(stated.partition(".")[2])


GUIDE = " ".join(text("guide/choosing.md").split())


@pytest.mark.parametrize(("sentence", "values", "how"), CLAIMS, ids=[claim[0] for claim in CLAIMS])
def test_a_sentence_of_the_guide_agrees_with_the_tables(sentence, values, how):
    stated = numbers_in(GUIDE, sentence)
    assert stated, f"docs/guide/choosing.md has no sentence '{sentence}': is it another now?"
    told = [f"{value:.3g}" for value in values]
    agree = [agrees(*one) for one in zip(stated, values, how, strict=True)]
    assert all(agree), f"choosing.md, '{sentence}': says {stated}, the tables have {told}"


def test_no_share_of_the_guide_is_left_unchecked():
    rest = GUIDE
    for sentence, _, _ in CLAIMS:
        found = re.search(re.escape(sentence).replace(r"\{\}", r"(\d+(?:\.\d+)?)"), GUIDE)
        if found:
            rest = rest.replace(found[0], " ")
    assert re.findall(r"\S+ \S+ [\d.]+ %", rest) == []


def test_what_the_guide_says_in_words():
    """B-splines are the best without slip and in the rings of 16 points a cell; a block locks under all but linear functions."""
    for labels in (NO_SLIP, RINGS):
        for fineness in {run.fineness for run in pick(**labels)}:
            same = pick(**labels, contact="penalty", fineness=fineness)
            least = min(run.error for run in same)
            assert next(run.error for run in same if run.shape == "bspline") < 1.2 * least
    assert errors(**BLOCK, contact="bardenhagen", shape=SOFT)[0] > 99.0
    assert errors(**STRESS, contact="penalty", shape=OWN)[1] <= errors(**STRESS, contact="none", shape=OWN)[1]


@pytest.mark.parametrize(
    ("stated", "value", "how", "agree"),
    [
        ("55", 55.5, "e", True),
        ("0.4", 0.437, "e", True),
        ("1.15", 1.17, "e", False),
        ("1.3", 1.53, "c", True),
        ("1.3", 1.76, "c", False),
        ("0.4", 0.437, "m", False),
        ("0.5", 0.437, "m", True),
        ("0.5", 0.12, "m", False),
        ("1.15", math.nan, "e", False),
    ],
)
def test_numbers_are_compared_as_they_are_stated(stated, value, how, agree):
    assert agrees(stated, value, how) is agree


def test_a_number_that_the_tables_no_longer_have_is_found():
    before, contact_stress = text("studies.md").split("mpmfw study contact-stress", 1)
    row = r"(\| bardenhagen \| bspline \| 0\.2 \| (?:[a-z]+ \| [a-z]+ \| )?)[\d.]+"  # scheme and transfer in between
    changed = re.sub(row, r"\g<1>91", contact_stress)
    moved = f"{before}mpmfw study contact-stress{changed}"
    runs = [run for run in runs_of(moved) if (run.study, run.contact) == ("contact-stress", "bardenhagen")]
    stated = numbers_in(GUIDE, "functions {} to {} %, `bardenhagen` {} to {} %")[3]
    assert not agrees(stated, max(run.error for run in runs), "e")
