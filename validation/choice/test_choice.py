"""Answers of ``mpmfw.choose`` to thirty questions without a closed form, against finer runs."""
# cost: 1600

import itertools
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
import xarray as xr
from impacts import CELL, SCENES, Question, questions

import mpmfw
from mpmfw.studies.choosing import CONTACTS, SHAPES
from mpmfw.validation import Case, full

SIZES = [2.0 * CELL, CELL, CELL / 2.0, CELL / 4.0]
FINER = SIZES[-1] / 2.0
LAWS = ["penalty", "lcp"]
WRONG, RIGHT, UNDECIDED = "wrong", "right", "undecided"


class Answer(NamedTuple):
    """Verdict; error of the answer and uncertainty of the truth [%]; costs of the choice, and with hindsight
    of two laws at two sizes, over the cheapest right run."""

    verdict: str
    error: float
    truth: float
    cost: float
    hindsight: float


@full
@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
def test_answers_are_right(case: Case, tmp_path: Any) -> None:
    answers = [answer(question, tmp_path) for question in questions()]
    for question, one in zip(questions(), answers, strict=True):
        for name, value, unit in (
            ("error of the answer", one.error, "%"),
            ("distance of the two finer laws from their mean", one.truth, "%"),
            ("cost over the cheapest right run", one.cost, ""),
        ):
            if np.isfinite(value):
                case.show(f"{question}, {one.verdict}: {name}", value, unit=unit)
    verdicts = [one.verdict for one in answers]
    decided = len(answers) - verdicts.count(UNDECIDED)
    case.gate("questions undecided", verdicts.count(UNDECIDED), "", (0.0, 8.0))
    case.gate("answers that are right", 100.0 * verdicts.count(RIGHT) / decided, "", (90.0, 100.0), "%")
    for name in ("cost", "hindsight"):
        median = float(np.nanmedian([getattr(one, name) for one in answers]))
        case.show(f"{name} over the cheapest right run, median", median)


def answer(question: Question, store: Any) -> Answer:
    """Return the answer to a question, judged by the mean of two laws at half of the finest cells."""
    scene, folder = SCENES[question.scene][0], store / question.scene
    choice = mpmfw.choose(scene, question.target, measure=question.measure, **question.about, store=folder)
    truth, of_truth = finer(question, folder)
    sizes = {"grid.cell_size": SIZES}
    every = mpmfw.compare(scene, CONTACTS, SHAPES, sizes, store=folder, repeats=1)
    every = every.transpose("contact", "shape", "cell_size", ...)
    errors = relative(values(every, question), truth).where(every["status"] == "ok")
    right, costs = errors <= question.target, every["cpu_time"]
    cheapest = float(costs.where(right).min())
    cost = float(choice["cpu_time"].where(choice["status"] != "not run").sum()) / cheapest
    hindsight = min(two_laws_at_two_sizes(costs.values, right.values), default=np.nan) / cheapest
    if not bool(choice["answer"].any()):
        return Answer(UNDECIDED, np.nan, 100.0 * of_truth, cost, hindsight)
    chosen = choice["answer"].transpose("contact", "shape", "cell_size").values
    error = float(errors.where(chosen).max())
    verdict = RIGHT if error <= question.target else WRONG
    return Answer(verdict, 100.0 * error, 100.0 * of_truth, cost, hindsight)


def two_laws_at_two_sizes(costs: Any, right: Any) -> Iterator[float]:
    """Yield the cost of two laws at two neighbouring sizes, one of which is right."""
    contacts, shapes, sizes = costs.shape
    law = [contact.partition("(")[0] for contact in CONTACTS]
    methods = list(itertools.product(range(contacts), range(shapes)))
    for k, (a, b) in itertools.product(range(1, sizes), itertools.combinations(methods, 2)):
        runs = [(*method, size) for method in (a, b) for size in (k - 1, k)]
        if law[a[0]] != law[b[0]] and any(right[run] for run in runs):
            yield sum(costs[run] for run in runs)


def finer(question: Question, store: Any) -> tuple[xr.DataArray, float]:
    """Return the mean of two laws at finer cells, and their distance from it over it."""
    sizes = {"grid.cell_size": [FINER]}
    runs = mpmfw.compare(SCENES[question.scene][0], LAWS, ["cpdi"], sizes, store=store, repeats=1)
    found = values(runs, question).isel(shape=0, cell_size=0)
    mean = found.mean("contact")
    return mean, float(relative(found, mean).max())


def values(runs: xr.Dataset, question: Question) -> xr.DataArray:
    """Return the displacement at the end, or the impulse over time, of every run."""
    if question.measure == "end-displacement":
        moved = runs["centre_of_mass"].sel(question.about)
        return along((moved - moved.isel(time=0)).isel(time=-1, drop=True))
    force = runs["contact_force"].sel(question.about)
    return along(-force.cumsum("time") * float(runs["time"][1]))


def along(vector: xr.DataArray) -> xr.DataArray:
    """Return the component that is largest in most runs."""
    other = [dim for dim in vector.dims if dim != "axis"]
    return vector.isel(axis=int(abs(vector).median(other).argmax()), drop=True)


def relative(found: xr.DataArray, truth: xr.DataArray) -> xr.DataArray:
    """Return the largest departure over time, over the largest true value."""
    away, size = abs(found - truth), abs(truth)
    return away.max("time") / size.max("time") if "time" in away.dims else away / size
