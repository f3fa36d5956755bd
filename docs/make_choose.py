"""Write docs/choose-score.md: how ``mpmfw choose`` does on scenes it was not made on, ``python docs/make_choose.py [FOLDER]``.

About ten minutes of CPU time. FOLDER keeps the runs, and a second call goes on from them.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from cheaper_pilots import section

import mpmfw
from mpmfw.campaigns.measures import measure
from mpmfw.errors import ResultsWarning
from mpmfw.plugin.measure import About, Exact, Measured
from mpmfw.scene import Scene, load_scene
from mpmfw.studies.advice import method_rows
from mpmfw.studies.choosing import DIVISORS
from mpmfw.studies.conclusion import percent
from mpmfw.studies.fitting import CostFit, ErrorFit, Interval, Pilot
from mpmfw.studies.verdicts import interval_text
from mpmfw.units import to_si

HERE = Path(__file__).parent
BARS = HERE.parent / "validation" / "equal-bars" / "scene.toml"
#: In hindsight methods are run at finer cells as well, but where their predicted error is above so many times the target.
FAR = 3.0
TARGETS = (0.02, 0.005)


@dataclass(frozen=True)
class Problem:
    """A scene that nothing was fitted to.

    Attributes
    ----------
    name
        In words.
    scene, set
        What runs, and the keys that make it another scene than the shipped one.
    measure
        Whose error it is.
    targets
        Relative errors that are asked for.
    coarsest
        Cells of the first pilots; None is twice the scene's own.
    divisor
        Of the coarsest cells, for the smallest answer: every answer is run, to see whether it meets the target.
    contact
        Contacts to choose among; None are the default ones.
    """

    name: str
    scene: str
    set: Mapping[str, Any]
    measure: str
    targets: tuple[float, ...] = TARGETS
    coarsest: str | None = None
    divisor: int = 4
    contact: tuple[str, ...] | None = None

    @property
    def ladder(self) -> list[float]:
        """Cell sizes that may be the answer [m]."""
        own = 2.0 * float(load_scene(self.scene).grid.cell_size)
        first = own if self.coarsest is None else float(to_si(self.coarsest, "m"))  # type: ignore[arg-type]
        return [first / k for k in DIVISORS if k <= self.divisor]


def _rebound(scene: Scene, about: About) -> Exact | None:  # noqa: ARG001
    """The velocity of the other bar: of one length or longer, it hands it on."""
    if set(scene.bodies) != {"left", "right"}:
        return None
    speed = float((scene.bodies["right"].velocity or (0.0,))[0])
    says = "d'Alembert's solution: the shorter bar leaves with the other's velocity"
    return Exact("closed-form", says, lambda _: np.array([speed]))


@measure("rebound", "m s-1", "number", (), _rebound)
def rebound(run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG001
    """Velocity of the left bar at the end."""
    velocity = run["series"].to_dataset()["mean_velocity"].sel(body="left", axis="x").values
    return Measured(velocity[-1:], np.empty(0))


#: Tilt [°], friction and radius [m] of cylinders that slip, and of some that do not.
CYLINDERS = (
    (45, 0.2, 1.6),
    (45, 0.5, 1.6),
    (30, 0.1, 1.2),
    (30, 0.4, 1.2),
    (50, 0.3, 1.0),
    (20, 0.3, 1.6),
    (70, 0.15, 1.6),
    (40, 0.15, 2.0),
)
#: Those that are asked of a method whose error falls with the cells alone, so that the answer has to be predicted.
PLAIN = (CYLINDERS[0], CYLINDERS[2], CYLINDERS[4])


def cylinder(tilt: float, friction: float, radius: float) -> dict[str, Any]:
    """Keys that make the shipped cylinder another one."""
    return {
        "gravity": {"magnitude": 10, "tilt": f"{tilt} deg"},
        "contact.pairs[0].friction": friction,
        "bodies.cylinder.geometry": {"type": "disc", "centre": [4.0, 0.8 + radius], "radius": radius},
        "time.end": 1.2,
    }


def problems() -> Iterator[Problem]:
    """All of them."""
    for tilt, friction, radius in CYLINDERS:
        name = f"cylinder, {tilt}°, μ {friction}, R {radius} m"
        yield Problem(name, "rolling-cylinder-slip", cylinder(tilt, friction, radius), "end-displacement")
    for tilt, friction, radius in PLAIN:
        name = f"cylinder, {tilt}°, μ {friction}, R {radius} m, plain `bardenhagen` alone"
        keys = cylinder(tilt, friction, radius)
        yield Problem(
            name, "rolling-cylinder-slip", keys, "end-displacement", (0.06, 0.04), contact=("bardenhagen",)
        )
    for tilt, friction, width in (
        (20, 0.1, 0.6),
        (40, 0.4, 0.6),
        (45, 0.6, 0.8),
        (25, 0.2, 0.4),
        (35, 0.5, 0.6),
    ):
        block = {"type": "rectangle", "lower": [0.03, 0.013], "upper": [0.03 + width, 0.313]}
        keys = {
            "gravity": {"magnitude": 10, "tilt": f"{tilt} deg"},
            "contact.friction": friction,
            "bodies.block.geometry": block,
            "time.end": 0.6,
        }
        yield Problem(f"block, {tilt}°, μ {friction}, width {width} m", "sliding-block", keys, "acceleration")
    for pressure, height in (("0.1 MPa", 1.013), ("0.4 MPa", 1.062), ("0.2 MPa", 0.683)):
        keys = {
            "bodies.lower.geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, height]},
            "bodies.upper.geometry": {
                "type": "rectangle",
                "lower": [0.0, height],
                "upper": [1.0, height + 1.0],
            },
            "bodies.upper.sides[2].pressure": pressure,
        }
        yield Problem(
            f"pressed blocks, {pressure}, interface at {height} m", "contact-stress", keys, "interface-stress"
        )
    for left, right, speed, place in (
        (5.0, 5.0, 0.01, 0.05),
        (4.0, 8.0, 0.01, 0.02),
        (6.0, 6.0, 0.02, 0.09),
        (8.0, 8.0, 0.005, 0.0),
    ):
        keys = {
            "bodies.left.geometry": {
                "type": "rectangle",
                "lower": [place - left, 0.0],
                "upper": [place, 0.25],
            },
            "bodies.right.geometry": {
                "type": "rectangle",
                "lower": [place + 0.06, 0.0],
                "upper": [place + 0.06 + right, 0.25],
            },
            "bodies.left.velocity": [speed, 0.0],
            "bodies.right.velocity": [-speed, 0.0],
            "time.end": 0.03 / speed + 2.2 * left,
        }
        yield Problem(
            f"bars, {left:g} and {right:g} m, {speed:g} m/s, end at {place:g} m",
            str(BARS),
            keys,
            "rebound",
        )
    shifted = {
        "grid.lower": ["-121.3 mm", "-80.7 mm"],
        "grid.upper": ["118.7 mm", "79.3 mm"],
        "output.particles": False,
    }
    yield Problem(
        "rings, cells 1.3 and 0.7 mm off the plane of symmetry",
        "colliding-rings",
        shifted,
        "impulse",
        (0.1, 0.05),
        "6 mm",
    )


#: A run by contact, shape function and cell size.
Run = tuple[str, str, float]


@dataclass
class Trial:
    """One problem and target: what was answered, and what runs say of it.

    Attributes
    ----------
    problem, target
        What was asked.
    rows, pilots
        Of the choice; CPU time of its pilots [s].
    runs
        Error and CPU time [s] of all runs that were made.
    """

    problem: Problem
    target: float
    rows: list[dict[str, Any]]
    pilots: float
    runs: dict[Run, tuple[float, float]] = field(default_factory=dict)

    @property
    def answer(self) -> dict[str, Any] | None:
        """The row of the method that was chosen."""
        return next((row for row in self.rows if row["answer"]), None)

    @property
    def measured(self) -> tuple[float, float]:
        """Error and CPU time of the answer, run."""
        row = self.answer
        return (np.nan, np.nan) if row is None else self.runs[run_of(row)]

    @property
    def others(self) -> float:
        """CPU time of the pilots that are not the answer, over the answer's."""
        row, cost = self.answer, self.measured[1]
        own = cost if row is not None and row["verdict"] == "measured" else 0.0
        return max(self.pilots - own, 0.0) / cost

    @property
    def best(self) -> float:
        """CPU time of the cheapest run that meets the target; NaN if none does."""
        able = [cost for error, cost in self.runs.values() if error <= self.target]
        return min(able, default=np.nan)


def run_of(row: Mapping[str, Any]) -> Run:
    """The run that an answer is."""
    return row["contact"], row["shape"], row["cell_size_needed"]


def tried(problem: Problem, target: float, folder: Path) -> Trial:
    """Ask for a choice, run the answer, and what may be better in hindsight."""
    ladder = problem.ladder
    dataset = mpmfw.choose(
        problem.scene,
        target,
        measure=problem.measure,
        contact=problem.contact,
        coarsest=ladder[0],
        finest=ladder[-1],
        set=problem.set,
        store=folder,
    )
    trial = Trial(problem, target, method_rows(dataset), float(dataset["cpu_time"].sum()))
    pilots: dict[tuple[str, str], list[Pilot]] = {}
    for row in trial.rows:
        method = (row["contact"], row["shape"])
        one = dataset.sel(contact=method[0], shape=method[1])
        for cell, error, cost in zip(ladder, one["error"].values, one["cpu_time"].values, strict=False):
            if np.isfinite(error):
                trial.runs[(*method, cell)] = float(error), float(cost)
                # Steps and points grow as they do in every scene here
                points = 1.0 / cell**2
                pilots.setdefault(method, []).append(
                    Pilot(cell, float(error), float(cost), 1.0 / cell, points)
                )
    if trial.answer is not None:
        _run(trial, run_of(trial.answer), folder)
    _look_back(trial, pilots, ladder, folder)
    return trial


def _look_back(
    trial: Trial, pilots: Mapping[tuple[str, str], Sequence[Pilot]], ladder: Sequence[float], folder: Path
) -> None:
    """Run what may meet the target at less cost, the cheapest first; at the coarsest cell every method."""
    others, known = [], dict(pilots)
    for method in ((row["contact"], row["shape"]) for row in trial.rows if row["verdict"] == "not run"):
        _run(trial, (*method, ladder[0]), folder)
        error, cost = trial.runs[(*method, ladder[0])]
        if np.isfinite(error):
            known[method] = [Pilot(ladder[0], error, cost, 1.0 / ladder[0], ladder[0] ** -2)]
    for method, found in known.items():
        costs, errors = CostFit(found, 2), ErrorFit(found, signed=False)
        for cell in ladder:
            near = cell > found[-1].cell_size or errors.at(cell).median <= FAR * trial.target
            if (*method, cell) not in trial.runs and near:
                others.append((costs.at(cell), (*method, cell)))
    for cost, one in sorted(others):
        if not trial.best <= cost:  # none is NaN
            _run(trial, one, folder)


def _run(trial: Trial, one: Run, folder: Path) -> None:
    """Error and cost of one run."""
    if one not in trial.runs:
        trial.runs[one] = run_alone(trial.problem, one, 1.0, folder)


def run_alone(problem: Problem, one: Run, time: float, folder: Path) -> tuple[float, float]:
    """Error and cost of one run of a problem, over its own duration times a factor."""
    contact, shape, cell = one
    outputs = dict.fromkeys(["output.surface", "output.gap", "output.ledger"], False)
    duration = {} if time == 1.0 else {"time.end": time * problem.set["time.end"]}
    dataset = mpmfw.campaign(
        problem.scene,
        {"contact": [contact], "shape": [shape], "cell_size": [cell]},
        measures=[problem.measure],
        set={
            **problem.set,
            **duration,
            **outputs,
            "output.particles": problem.measure == "interface-stress",
        },
        store=folder,
        repeats=1,
    ).squeeze()
    error = dataset[f"{problem.measure.replace('-', '_')}_error"].item()
    cost = float(dataset["cpu_time"]) + float(dataset["settle_time"].fillna(0.0))
    return (float(error) if np.isfinite(error) else np.inf), cost


def pilots_of(trials: Sequence[Trial]) -> Iterator[tuple[Problem, dict[Run, tuple[float, float]]]]:
    """Every problem whose methods are the default ones, with its runs at the coarsest cell."""
    known: dict[str, tuple[Problem, dict[Run, tuple[float, float]]]] = {}
    for trial in trials:
        coarsest = {run: found for run, found in trial.runs.items() if run[2] == trial.problem.ladder[0]}
        known.setdefault(trial.problem.name, (trial.problem, {}))[1].update(coarsest)
    return (one for one in known.values() if one[0].contact is None)


HEAD = """\
# How well `mpmfw choose` chooses

<!-- Made by docs/make_choose.py, which runs all that it quotes. -->

`python docs/make_choose.py` asks [`mpmfw choose`](guide/choose.md) for a method and a cell size on {scenes} problems with a
closed form or a reference, at two errors each, then runs the answer, and whatever else might have met the target for less.
What `choose` believes beforehand was set on the cylinder's table in [the shipped studies](studies.md), where {in_sample}.
Of these scenes it has seen the bars, whose pilots were looked at when the rule for third runs was written, and the order of the
pilots was tried on all of them, so that for *other runs* they are no test. Methods are the
default ones but where the table says others. Here: {processor}, {timing}; CPU times of short runs scatter by tens of
per cent.

{summary}

A **measured** answer is a pilot that met the target: nothing is left to run. A **predicted** one is a run that nobody had made.
*Over best* is the CPU time of the answer over that of the cheapest run that met the target, among all methods and
the cell sizes that could have been the answer (but those with a predicted error above {far:g} times the target were not run).
*Other runs* is the CPU time of all pilots that are not the answer, over the answer's.

{verdict}

| scene | target | answer | cell [m] | error said | error run | met | over best | other runs |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""

#: What the table comes to.
VERDICT = """\
An answer meets its target, and costs little more than the best in hindsight. Where the first method meets the target nothing
else has run. Where it does not, what has run in vain at the coarsest cell is several times the answer, which is a coarse run
too: a fifth of the answer, which was aimed at, is less than any other run takes. Errors that are known say which method
comes next ([decision](decisions/0057-next-pilot.md)). What is above the best in hindsight is the price list's doing: for the
block it puts GIMP below CPDI, which takes two thirds; for the rings it is one disturbed run, which takes less than half of that
when it is repeated. The one answer that had to be predicted is wrong: an error that fell from 2.5 to 0.6 % did not fall any
further (bars of 4 and 8 m). One case says little; the bounds hold what they promise, as the last sentence above says.
"""


def line(trial: Trial) -> str:
    """A row of the table."""
    cells = [trial.problem.name, f"{percent(trial.target)} %"]
    row = trial.answer
    if row is None:
        reachable = "" if np.isfinite(trial.best) else "; none does in hindsight"
        cells += [f"none is certain{reachable}", "", "", "", "", "", ""]
        return f"| {' | '.join(cells)} |"
    error, cost = trial.measured
    said = interval_text(Interval(row["predicted_error"], row["lower"], row["upper"]))
    over = f"{cost / trial.best:.2f}" if np.isfinite(trial.best) else "–"
    cells += [
        f"`{row['contact']}`, {row['shape']}",
        f"{row['cell_size_needed']:.4g}",
        f"{said}, {row['verdict']}",
        f"{percent(error)} %",
        "yes" if error <= trial.target else "**no**",
        over,
        f"{trial.others:.2g}",
    ]
    return f"| {' | '.join(cells)} |"


def summary(trials: Sequence[Trial]) -> str:
    """The score against what was aimed at."""
    answered = [one for one in trials if one.answer is not None]
    lines = [
        "| answers | asked | answered | target met (aim 95 %) | over best, median (aim 1.3) | other runs, median (aim 0.2) |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for kind in ("all", "measured", "predicted"):
        chosen = [one for one in answered if kind in ("all", one.answer["verdict"])]  # type: ignore[index]
        met = sum(one.measured[0] <= one.target for one in chosen)
        over = [one.measured[1] / one.best for one in chosen if np.isfinite(one.best)]
        share = [one.others for one in chosen]
        asked = str(len(trials)) if kind == "all" else ""
        lines.append(
            f"| {kind} | {asked} | {len(chosen)} | {met} of {len(chosen)} | {_median(over)} | {_median(share)} |"
        )
    silent = [one for one in trials if one.answer is None]
    possible = sum(np.isfinite(one.best) for one in silent)
    predicted = [one for one in answered if one.answer["verdict"] == "predicted"]  # type: ignore[index]
    alone = sum(one.others == 0.0 for one in answered)
    vain, mean = (
        [one.others for one in answered if one.others > 0.0],
        np.mean([one.others for one in answered]),
    )
    inside = [one.answer["lower"] <= one.measured[0] <= one.answer["upper"] for one in predicted]  # type: ignore[index]
    return "\n".join(lines) + (
        f"\n\nIn {len(silent)} cases the answer was that no method is certain; in {possible} of these some run met the "
        f"target all the same. In {alone} of {len(answered)} nothing but the answer had run; in the others\n"
        f"{_median(vain)} times the answer's CPU time (median), in the mean of all {mean:.2f} times. Of the predicted "
        "answers the error that was run lay within the bounds of 90 % in\n"
        f"{sum(inside)} of {len(predicted)}. {fit(trials)}"
    )


def fit(trials: Sequence[Trial]) -> str:
    """How the errors of all finer runs lie in the bounds that the two coarsest runs of their method give."""
    inside = above = total = 0
    known: dict[str, tuple[list[float], dict[Run, tuple[float, float]]]] = {}
    for trial in trials:
        known.setdefault(trial.problem.name, (trial.problem.ladder[:2], {}))[1].update(trial.runs)
    for coarse, made in known.values():
        for (contact, shape, cell), (error, _) in made.items():
            runs = [(h, made.get((contact, shape, h), (np.inf, 0.0))) for h in coarse]
            if cell >= coarse[1] or not np.isfinite([error, *(run[0] for _, run in runs)]).all():
                continue
            pilots = [Pilot(h, size, cost, 1.0 / h, 1.0 / h**2) for h, (size, cost) in runs]
            bounds = ErrorFit(pilots, signed=False).at(cell)
            total += 1
            inside += bounds.low <= error <= bounds.high
            above += error > bounds.high
    return (
        f"Of all {total} runs that were made at finer cells than the first two, to look back, the error lay within\nthe bounds "
        f"that these two give (of sizes, without signs) in {inside}, and above them in {above}."
    )


def _median(values: Sequence[float]) -> str:
    return f"{np.median(values):.2f}" if len(values) else "–"


def in_sample() -> str:
    """How the third cell of the shipped cylinder's table lies in the bounds that the two coarser ones give."""
    found: dict[tuple[str, ...], dict[float, tuple[float, float, float]]] = {}
    for row in (HERE / "studies.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in row.strip("| ").split("|")]
        if cells[0] in ("slip", "no slip") and cells[1] != "none" and not cells[6].startswith("failed"):
            error, cost, steps = (float(cells[k]) for k in (6, 7, 9))
            found.setdefault(tuple(cells[:3]), {})[float(cells[3])] = error, cost, steps
    above = below = 0
    whole = [runs for runs in found.values() if len(runs) == 3]  # at all three cells
    for runs in whole:
        pilots = [Pilot(h, runs[h][0] / 100.0, runs[h][1], runs[h][2], 1.0 / h**2) for h in (0.8, 0.4)]
        bounds = ErrorFit(pilots, signed=False).at(0.2)
        above += runs[0.2][0] / 100.0 > bounds.high
        below += runs[0.2][0] / 100.0 < bounds.low
    return f"of {len(whole)} methods the third cell's error is above the bounds of 90 % in {above} and below them in {below}"


def main() -> None:
    """Ask, run, write."""
    warnings.simplefilter("ignore", ResultsWarning)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        trials = []
        for problem in problems():
            for target in problem.targets:
                trials.append(tried(problem, target, folder))
                print(line(trials[-1]), flush=True)
        cheaper = section(pilots_of(trials), partial(run_alone, folder=folder))
        scene = load_scene("sliding-block")
        conditions = mpmfw.choose(scene, "1 %", contact=["penalty"], shape=["cpdi"], store=folder).attrs
    page = HEAD.format(
        scenes=len({one.problem.name for one in trials}),
        processor=conditions["processor"],
        timing=conditions["timing"],
        summary=summary(trials),
        in_sample=in_sample(),
        verdict=VERDICT.strip(),
        far=FAR,
    )
    lines = "\n".join(map(line, trials))
    (HERE / "choose-score.md").write_text(f"{page}{lines}\n\n{cheaper}", encoding="utf-8")


if __name__ == "__main__":
    main()
