"""What pilots of ``mpmfw choose`` would cost and say if they were coarser or shorter: a section of docs/choose-score.md."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from mpmfw.errors import SceneError

#: A run by contact, shape function and cell size, and its error and CPU time [s].
Run = tuple[str, str, float]
Found = tuple[float, float]
#: Target that a cheaper run is to foretell, and the error above which, in targets, it hides a method that meets it.
TARGET, HIDDEN = 0.02, 3.0


@dataclass
class Kind:
    """Runs that are cheaper than pilots in one way.

    Attributes
    ----------
    name
        In words.
    cells, time
        Cell size and duration over those of the pilot.
    """

    name: str
    cells: float
    time: float
    costs: list[float] = field(default_factory=list)
    sums: list[float] = field(default_factory=list)
    pairs: list[tuple[float, float]] = field(default_factory=list)

    def add(self, pilots: Mapping[Run, Found], run: Callable[[Run, float], Found]) -> None:
        """Make the cheaper runs of a problem's pilots."""
        total = 0.0
        for (contact, shape, cell), (error, cost) in pilots.items():
            try:
                cheap = run((contact, shape, self.cells * cell), self.time)
            except SceneError:  # the grid is too small for the shape function in cells of this size
                continue
            total += cheap[1]
            self.costs.append(cheap[1] / cost)
            self.pairs.append((error, cheap[0]))
        self.sums.append(total / min(cost for _, cost in pilots.values()))

    def line(self) -> str:
        """A row of the table."""
        able = [cheap for error, cheap in self.pairs if error <= TARGET]
        unable = [cheap for error, cheap in self.pairs if not error <= TARGET]
        hidden = sum(not cheap <= HIDDEN * TARGET for cheap in able)
        promised = sum(cheap <= TARGET for cheap in unable)
        return (
            f"| {self.name} | {len(self.pairs)} | {np.median(self.costs):.2f} | {min(self.sums):.1f} to {max(self.sums):.1f} "
            f"| {hidden} of {len(able)} | {promised} of {len(unable)} |"
        )


HEAD = """\
## Cheaper pilots

Could other runs say beforehand which method to begin with? At half the resolution of the pilots, or over a quarter of
their time (cylinder and block, whose closed forms hold at any time), all methods of a problem. *Share* is the CPU time over the
pilot's (median), *all* that of all methods over the cheapest pilot. *Hidden* are methods whose pilot meets {target:g} % and whose
cheaper run is above {hidden:g} %, *promised* those whose pilot does not and whose cheaper run does.

| cheaper by | runs | share | all | hidden | promised |
| --- | --- | --- | --- | --- | --- |
"""

#: What the table comes to.
FOUND = """
Neither is a fifth of a run, and both lead astray. Runs of a few hundred points cost their steps, however few the points are,
and most of a cylinder's pilot is settling, which a shorter motion does not shorten. All methods together, run so, take several
times what the answer takes. At half the resolution the cylinder is one to two and a half cells wide, and the contact that is
the best one at the pilots' cells misses all of the motion. What is left to save is which method comes first
([decision](decisions/0057-next-pilot.md)).
"""


def section(problems: Iterable[tuple[Any, Mapping[Run, Found]]], run: Callable[..., Found]) -> str:
    """The section, of problems with their pilots.

    Parameters
    ----------
    problems
        And error and CPU time of all methods at the coarsest cell.
    run
        Makes a run of a problem: takes it, the run, and the duration over the problem's.
    """
    kinds = [Kind("half the resolution", 2.0, 1.0), Kind("a quarter of the time", 1.0, 0.25)]
    for problem, pilots in problems:
        for kind in kinds:
            if kind.time == 1.0 or problem.measure in ("end-displacement", "acceleration"):
                kind.add(pilots, partial(run, problem))
    head = HEAD.format(target=100.0 * TARGET, hidden=100.0 * HIDDEN * TARGET)
    return head + "\n".join(kind.line() for kind in kinds) + "\n" + FOUND
