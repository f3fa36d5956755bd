"""Stage clock: seconds per stage of the step, at the price of one timer read a stage."""

from __future__ import annotations

import time

#: Stages of a step and of a run, in the order of the tables.
STAGES = ("shape", "projection", "force", "contact", "gather", "material", "gap", "output")

#: Stages that count as the cost of the method; ``gap`` (surfaces tracked for the diagnostic alone) and
#: ``output`` do not.
STEP_STAGES = STAGES[:6]

_ALONE = "largest resident memory of a process that did this run alone; NaN where it had done others before"
#: Root attributes of a run that are its costs: name, unit, meaning.
COSTS: tuple[tuple[str, str, str], ...] = (
    ("steps", "1", "time steps"),
    ("material_points", "1", "material points"),
    ("cpu_time", "s", "CPU time of the steps, without compilation, settling, gap diagnostic and output"),
    ("wall_time", "s", "wall time of the steps"),
    ("peak_memory", "B", _ALONE),
    ("settle_time", "s", "CPU time of settling"),
    ("output_time", "s", "CPU time of output"),
    ("gap_time", "s", "CPU time of the gap diagnostic"),
    ("compile_time", "s", "time of compilation or of loading compiled code"),
)


class Clock:
    """Attributes time to the stage that is running.

    Wall time is read at every change of stage. CPU time is read only in :meth:`flush`, once a frame, and
    shared out in proportion to the wall time in between: one CPU-timer read costs as much as a small kernel.
    """

    __slots__ = ("_cpu_mark", "_mark", "_stage", "_wall_frame", "cpu", "wall")
    history = ("cpu", "wall")

    def __init__(self) -> None:
        self._stage = "output"
        self.restart()

    def restart(self) -> None:
        """Forget everything measured so far, so that settling and compilation do not count."""
        self.wall: dict[str, float] = dict.fromkeys(STAGES, 0.0)
        self.cpu: dict[str, float] = dict.fromkeys(STAGES, 0.0)
        self.restored()

    def restored(self) -> None:
        """Go on from the seconds that were saved."""
        self._wall_frame: dict[str, float] = dict.fromkeys(STAGES, 0.0)
        self._mark, self._cpu_mark = time.perf_counter(), time.process_time()

    def __call__(self, stage: str) -> str:
        """Begin ``stage``; return the one that ends."""
        now = time.perf_counter()
        previous = self._stage
        self._wall_frame[previous] += now - self._mark
        self._stage = stage
        self._mark = now
        return previous

    def flush(self) -> None:
        """Add what was measured since the last flush to :attr:`wall` and :attr:`cpu` [s]."""
        self(self._stage)
        cpu_now = time.process_time()
        elapsed = sum(self._wall_frame.values())
        ratio = (cpu_now - self._cpu_mark) / elapsed if elapsed > 0.0 else 0.0
        for stage, seconds in self._wall_frame.items():
            self.wall[stage] += seconds
            self.cpu[stage] += seconds * ratio
            self._wall_frame[stage] = 0.0
        self._cpu_mark = cpu_now

    def exclude(self, wall: float, cpu: float) -> None:
        """Take seconds that are not the method's, such as those of compilation, out of the present stage."""
        self._mark += wall
        self._cpu_mark += cpu
