"""What came of one run of a campaign, and what it took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mpmfw.state.clock import COSTS as RUN_COSTS

#: Root attributes of a run that are its costs: name, unit, meaning.
COSTS: tuple[tuple[str, str, str], ...] = (*RUN_COSTS, ("settle_steps", "1", "time steps of settling"))


@dataclass(frozen=True)
class Cost:
    """What one repeat of a run took.

    Attributes
    ----------
    timing
        ``exclusive`` if nothing else of the campaign ran at the same time, else ``shared cores``.
    values
        Root attributes of the run, by the names of :data:`COSTS`.
    stages
        CPU time of the steps by stage [s].
    settling
        CPU time of settling by stage [s]; 0 where the scene does not settle.
    others
        Cores that other processes of the machine kept busy meanwhile, in the mean; NaN where it is not known.
    machine
        Model of the processor.
    """

    timing: str
    values: dict[str, float]
    stages: dict[str, float]
    settling: dict[str, float]
    others: float = field(default=float("nan"), compare=False)
    machine: str = ""


@dataclass(frozen=True)
class Outcome:
    """How a run went.

    Attributes
    ----------
    key
        Of :func:`mpmfw.runs.identity.key_of`.
    status
        ``ok``, ``suspect: …``, or why there is no complete result.
    name, scene
        What ran, for a reader of the store: in words, and the scene's text.
    digest
        Of the series, which every repeat must give again; empty without results.
    notes
        What the run's reader must know.
    costs
        One for each repeat.
    values
        What was read off the run at once, where it writes no results.
    code
        Hashes of the packages and versions of the libraries that it ran with, by name.
    lasting
        Whether running it again would end in the same way.
    """

    key: str
    status: str
    name: str = ""
    scene: str = ""
    digest: str = ""
    notes: tuple[str, ...] = ()
    costs: tuple[Cost, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)
    code: Mapping[str, str] = field(default_factory=dict)
    lasting: bool = field(default=True, compare=False)


@dataclass(frozen=True)
class Finished:
    """What came of a task: its outcome, and the file that it wrote, if any."""

    outcome: Outcome
    results: bytes | None = None
