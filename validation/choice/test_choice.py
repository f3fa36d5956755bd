"""Answers of ``mpmfw.choose`` to thirty questions without a closed form, against finer runs."""
# cost: 1600

import itertools
from typing import NamedTuple

import common
import numpy as np
import pytest
from common import disc, elastic, fixed, rectangle

import mpmfw
from mpmfw.studies.choosing import CONTACTS, SHAPES
from mpmfw.validation import full

#: Cell size of the scenes [m]; discs have a radius of 1 m. Waves run at about 10 m/s.
CELL = 0.25
SPEED = 0.2  # m/s, of what approaches


class Question(NamedTuple):
    """An error that is asked for: relative ``target`` of a measure of a body, a pair or all bodies."""

    scene: str
    measure: str
    about: dict[str, str]
    target: float

    def __str__(self):
        named = " ".join(self.about.values())
        return f"{self.scene}: {self.measure} {named}".rstrip() + f" within {self.target:.0%}"


def scene(friction, end, bodies, **tables):
    """Return a scene of two materials, one four times as stiff as the other."""
    soft, stiff = (elastic(1000.0, young, 0.3, "neo_hookean") for young in (1.0e5, 4.0e5))
    usual = {"particles": {"layout": "fitted", "size": "0.5 cells"}, "velocity": [0.0, 0.0]}
    bodies = {name: {**usual, **body} for name, body in bodies.items()}
    tables |= {"contact": {"friction": friction}, "materials": {"stiff": stiff}}
    tables |= {"output": {"particles": False, "surface": False}}
    return common.scene(CELL, [-6.0, -4.0], [6.0, 5.0], end, end / 60, soft, bodies, **tables)


FLOOR = rectangle(-4.03, -1.52, 4.03, 0.01, sides=fixed(bottom="xy"))

#: Every scene with the body and the pair that its questions are about.
SCENES = {
    "equal discs": (
        scene(0.0, 2.0, {
            "left": disc(-1.07, 0.03, velocity=[SPEED, 0.0]),
            "right": disc(1.02, 0.03, velocity=[-SPEED, 0.0]),
        }), "left", "left-right",
    ),
    "discs that pass obliquely": (
        scene(0.3, 2.0, {
            "left": disc(-0.93, -0.52, velocity=[SPEED, 0.0]),
            "right": disc(0.91, 0.49, velocity=[-SPEED, 0.0]),
        }), "right", "left-right",
    ),
    "a small stiff disc": (
        scene(0.0, 2.0, {
            "large": disc(-1.3, 0.0, 1.25, velocity=[SPEED, 0.0]),
            "small": disc(0.77, 0.11, 0.75, material="stiff"),
        }), "small", "large-small",
    ),
    "a disc thrown on a floor": (
        scene(0.4, 2.0, {"disc": disc(-0.6, 1.06, velocity=[SPEED, -SPEED]), "floor": FLOOR}),
        "disc", "disc-floor",
    ),
    "a ring on a floor": (
        scene(0.2, 3.0, {
            "ring": {
                "geometry": {"type": "ring", "centre": [0.0, 1.06], "inner_radius": 0.5, "outer_radius": 1.0},
                "velocity": [0.0, -SPEED],
            },
            "floor": FLOOR,
        }), "ring", "ring-floor",
    ),
    "a box flat on a floor": (
        scene(0.0, 1.5, {"box": rectangle(-1.0, 0.06, 1.0, 1.56, velocity=[0.0, -SPEED]), "floor": FLOOR}),
        "box", "box-floor",
    ),
    "a box on its corner": (
        scene(0.3, 2.0, {
            "box": rectangle(-0.9, 0.43, 0.9, 2.03, 0.35, velocity=[0.0, -SPEED]), "floor": FLOOR,
        }), "box", "box-floor",
    ),
    "a row of discs": (
        scene(0.0, 3.0, {
            "first": disc(-2.13, 0.0, velocity=[2 * SPEED, 0.0]),
            "second": disc(-0.05, 0.0),
            "third": disc(1.98, 0.0),
        }), "third", "second-third",
    ),
    "a disc in a groove": (
        scene(0.2, 2.0, {
            "disc": disc(0.05, 1.46, velocity=[0.0, -SPEED]),
            "left": rectangle(-2.9, -1.0, -0.4, 1.0, -0.785, sides=fixed(bottom="xy")),
            "right": rectangle(0.4, -1.0, 2.9, 1.0, 0.785, sides=fixed(bottom="xy")),
        }), "disc", "disc-right",
    ),
    "a stack under its weight": (
        scene(0.3, 2.0, {
            "upper": rectangle(-0.8, 1.51, 0.8, 2.51),
            "lower": rectangle(-1.2, 0.01, 1.2, 1.51, material="stiff"),
            "floor": FLOOR,
        }, gravity={"vector": [0.0, -2.0]}), "upper", "upper-lower",
    ),
}  # fmt: skip


def questions():
    """Yield three questions about each scene."""
    for name, (_, body, pair) in SCENES.items():
        yield Question(name, "end-displacement", {"body": body}, 0.05)
        yield Question(name, "end-displacement", {"body": body}, 0.02)
        yield Question(name, "impulse", {"pair": pair}, 0.05)


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
def test_answers_are_right(case, tmp_path):
    answers = [answer(question, tmp_path) for question in questions()]
    for question, one in zip(questions(), answers, strict=True):
        for name, value, unit in (
            ("error of the answer", one.error, "%"),
            ("distance of the two finer laws from their mean", one.truth, "%"),
            ("cost over the cheapest right run", one.cost, ""),
        ):
            if np.isfinite(value):
                case.gate(f"{question}, {one.verdict}: {name}", value, unit=unit)
    verdicts = [one.verdict for one in answers]
    decided = len(answers) - verdicts.count(UNDECIDED)
    case.gate("questions undecided", verdicts.count(UNDECIDED), "", (0.0, 8.0))
    case.gate("answers that are right", 100.0 * verdicts.count(RIGHT) / decided, "", (90.0, 100.0), "%")
    for name in ("cost", "hindsight"):
        median = float(np.nanmedian([getattr(one, name) for one in answers]))
        case.gate(f"{name} over the cheapest right run, median", median)


def answer(question, store):
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


def two_laws_at_two_sizes(costs, right):
    """Yield the cost of two laws at two neighbouring sizes, one of which is right."""
    contacts, shapes, sizes = costs.shape
    law = [contact.partition("(")[0] for contact in CONTACTS]
    methods = list(itertools.product(range(contacts), range(shapes)))
    for k, (a, b) in itertools.product(range(1, sizes), itertools.combinations(methods, 2)):
        runs = [(*method, size) for method in (a, b) for size in (k - 1, k)]
        if law[a[0]] != law[b[0]] and any(right[run] for run in runs):
            yield sum(costs[run] for run in runs)


def finer(question, store):
    """Return the mean of two laws at finer cells, and their distance from it over it."""
    sizes = {"grid.cell_size": [FINER]}
    runs = mpmfw.compare(SCENES[question.scene][0], LAWS, ["cpdi"], sizes, store=store, repeats=1)
    found = values(runs, question).isel(shape=0, cell_size=0)
    mean = found.mean("contact")
    return mean, float(relative(found, mean).max())


def values(runs, question):
    """Return the displacement at the end, or the impulse over time, of every run."""
    if question.measure == "end-displacement":
        moved = runs["centre_of_mass"].sel(question.about)
        return along((moved - moved.isel(time=0)).isel(time=-1, drop=True))
    force = runs["contact_force"].sel(question.about)
    return along(-force.cumsum("time") * float(runs["time"][1]))


def along(vector):
    """Return the component that is largest in most runs."""
    other = [dim for dim in vector.dims if dim != "axis"]
    return vector.isel(axis=int(abs(vector).median(other).argmax()), drop=True)


def relative(found, truth):
    """Return the largest departure over time, over the largest true value."""
    away, size = abs(found - truth), abs(truth)
    return away.max("time") / size.max("time") if "time" in away.dims else away / size
