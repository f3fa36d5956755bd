"""What pilot runs say of every method: the cheapest cell at which its error is below a target, and why others lose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpmfw.studies.conclusion import percent
from mpmfw.studies.fitting import CostFit, ErrorFit, Interval, Pilot

#: An error of which nothing is known.
UNKNOWN = Interval(np.nan, np.nan, np.nan)

#: A method: indices of its contact and its shape function.
Method = tuple[int, int]


@dataclass(frozen=True)
class Task:
    """What is asked of all methods.

    Attributes
    ----------
    target
        Relative error.
    ladder
        Cell sizes that may be the answer, falling [m].
    signed
        Whether errors have signs.
    dim
        Of the scene.
    slack
        Relative error of what errors are against.
    """

    target: float
    ladder: Sequence[float]
    signed: bool
    dim: int
    slack: float = 0.0

    def with_slack(self, slack: float) -> Task:
        """The same against something that is off by a slack."""
        return replace(self, slack=slack)


@dataclass(frozen=True)
class Verdict:
    """What is known of a method.

    Attributes
    ----------
    kind
        ``measured`` or ``predicted``: the target is met, by a pilot or by prediction; ``unsure``: it may be met;
        ``out of reach``; ``failed``: no pilot has an error; ``not run``: dearer than the answer at any cell, or not worth a run.
    cell_size
        The cheapest cell that meets the target; else the finest of the ladder [m].
    error
        There, as a size.
    cost
        CPU time there [s].
    limit, order
        Size of e0, and expected p.
    why
        In words, from where the answer is known.
    """

    kind: str
    cell_size: float = np.nan
    error: Interval = UNKNOWN
    cost: float = np.nan
    limit: Interval = UNKNOWN
    order: float = np.nan
    why: str = ""

    @property
    def meets(self) -> bool:
        """Whether the target is met, with the confidence of the interval."""
        return self.kind in ("measured", "predicted")


@dataclass(frozen=True)
class Chance:
    """A run that may be made.

    Attributes
    ----------
    cost
        Predicted CPU time [s].
    of_target
        Probability that its error is below the target.
    """

    cost: float
    of_target: float

    @property
    def price(self) -> float:
        """Expected CPU time until the target is met, if all runs were like this one [s]: cheap and likely ones come first."""
        return self.cost / max(self.of_target, 1e-9)

    def saves(self, cost: float) -> bool:
        """Whether it is expected to save more at the next use, against what meets the target at a cost [s], than it takes."""
        return self.of_target * (cost - self.cost) > self.cost


def verdict(pilots: Sequence[Pilot], task: Task) -> Verdict:
    """Judge a method by its runs, at falling cell sizes."""
    if not pilots:
        return Verdict("failed")
    errors, costs = ErrorFit(pilots, task.signed), CostFit(pilots, task.dim)
    limit, order = errors.level(), errors.expected_order
    for pilot in pilots:
        error = _with_slack(Interval(*3 * (abs(pilot.error),)), task.slack)
        if error.high <= task.target:
            return Verdict("measured", pilot.cell_size, error, pilot.cost, limit, order)
    finest, possible = pilots[-1].cell_size, False
    for cell in task.ladder:
        if cell >= finest * (1.0 - 1e-9):
            continue
        error = _with_slack(errors.at(cell), task.slack)
        possible |= error.low <= task.target
        if error.high <= task.target:
            return Verdict("predicted", cell, error, costs.at(cell), limit, order)
    last = min(task.ladder[-1], finest)
    at_last = errors.at(last) if last < finest else Interval(*3 * (abs(pilots[-1].error),))
    kind = "unsure" if possible else "out of reach"
    return Verdict(kind, last, _with_slack(at_last, task.slack), costs.at(last), limit, order)


def _with_slack(error: Interval, slack: float) -> Interval:
    """The bounds of an error against what is itself off by a slack."""
    return Interval(error.median, max(error.low - slack, 0.0), error.high + slack)


def best_of(verdicts: Mapping[Method, Verdict]) -> Method | None:
    """The method that meets the target at the least cost; None if none does."""
    able = [name for name, one in verdicts.items() if one.meets]
    return min(able, key=lambda name: verdicts[name].cost, default=None)


def with_reasons(
    verdicts: Mapping[Method, Verdict],
    failures: Mapping[Method, str],
    pruned: Mapping[Method, Chance],
    task: Task,
) -> dict[Method, Verdict]:
    """The verdicts with why each is, or is not, the answer.

    Parameters
    ----------
    verdicts
        Of all methods.
    failures
        Status of the last run of those that have no error.
    pruned
        Methods that were not run at all cells, with what the next run would have cost at least, and its chance.
    task
        What was asked.
    """
    best = best_of(verdicts)
    cost = np.nan if best is None else verdicts[best].cost
    words = {}
    for method, one in verdicts.items():
        if method == best:
            words[method] = "the answer: " + ("a pilot run has it" if one.kind == "measured" else "predicted")
        elif one.kind == "not run":
            words[method] = f"predicted to take {_at_what_cost(pruned[method], cost)}"
        elif one.kind == "failed":
            words[method] = failures.get(method, "no run has an error")
        elif one.meets:
            words[method] = (
                f"meets it at {one.cell_size:.4g} m, at {one.cost / cost:.2g} times the cost of the answer"
            )
        elif method in pruned:
            words[method] = f"its finer cells take at least {_at_what_cost(pruned[method], cost)}"
        else:
            words[method] = _falls_short(one, task)
    return {method: replace(one, why=words[method]) for method, one in verdicts.items()}


def _at_what_cost(run: Chance, cost: float) -> str:
    """What a run takes against the answer, and where that is less, how likely it would have been one."""
    likely = (
        ""
        if run.cost >= cost
        else f", and to meet the target with a probability of {percent(run.of_target)} %"
    )
    return f"{run.cost / cost:.2g} times the cost of the answer{likely}"


def _falls_short(one: Verdict, task: Task) -> str:
    """How far a method stays off the target."""
    begin = "may meet it, but" if one.kind == "unsure" else "does not meet it:"
    level = f"; levels off at {interval_text(one.limit)}" if one.limit.low > task.target else ""
    return f"{begin} {interval_text(one.error)} at {one.cell_size:.4g} m{level}"


def interval_text(error: Interval) -> str:
    """An error in per cent with its bounds, where it has any."""
    median = f"{percent(error.median)} %"
    if error.low == error.high:
        return median
    return f"{median} ({percent(error.low)} to {percent(error.high)} %)"
