"""The length of a time step, a fraction of the least stability limit or fixed; the clock of its stages."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from numba.core import event as numba_event

from mpmfw.errors import PastStabilityLimit, PluginError, SceneError, SimulationError
from mpmfw.state.fields import STAGES

if TYPE_CHECKING:
    from mpmfw.plugin.setup import Setup
    from mpmfw.state.structs import Body

# numba's annotations differ between versions.
_event: Any = numba_event

#: numba holds its compiler lock while it compiles a kernel or loads it from the disk cache.
_LOCK = "numba:compiler_lock"

#: Share of the bulk's limit below which a time step is taken for a failure: such a run would never end.
COLLAPSED = 1e-4


def highest_frequency(body: Body, cell_size: float, courant: float, damping: Any) -> float:
    """Return the highest frequency of a body's nodes, 2 c / h [1/s], 2 ``courant`` over the longest step.

    In a body whose width w is less than h it is 2 c / √(h w): a row of nodes into which a part b of the width
    reaches has the mass ρ b² / (2 h) and the stiffness M b² / (w h²). The viscous stress of ``damping`` is τ
    times the rate of the elastic one. It raises ω to ω (ξ + √(1 + ξ²)), ξ = τ ω / 2: its velocity is half a
    step behind (Belytschko, Liu & Moran, Nonlinear finite elements, section 6.2).
    """
    thin = body.width < cell_size * (1.0 - 1e-9)
    frequency = 2.0 * body.wave_speed / (math.sqrt(cell_size * body.width) if thin else cell_size)
    if damping is None:
        return frequency
    bulk, shear = damping.times
    viscosity = bulk * body.bulk_modulus + 4.0 / 3.0 * shear * body.shear_modulus
    ratio = 0.5 * float(viscosity / body.p_wave_modulus / courant) * frequency
    return frequency * (ratio + math.sqrt(1.0 + ratio * ratio))


class TimeStep:
    """Chooses the length of every step.

    ``bulk_limit`` [s] is h / c of the fastest body, √(h w) / c of one thinner than a cell. A step past the
    shape function's share of it is refused."""

    def __init__(self, setup: Setup) -> None:
        self.state, self.contact = setup.state, setup.contact
        self.bulk_limit = 2.0 / setup.bulk_frequency
        thinner = (1.0 - 1e-9) * setup.cell_size
        thin = any(body.width < thinner for body in setup.bodies)
        thin &= all(body.rigid or self.bulk_limit < thinner / body.wave_speed for body in setup.bodies)
        length, courant = "√(h w)" if thin else "h", setup.shape_function.courant
        damped = ", with damping" if setup.plugin("material_damping") is not None else ""
        self._bulk = (self.bulk_limit, f"bulk wave speed ({length} / c){damped}")
        self._courant = courant
        self._safety, self._fixed = setup.scene.time.safety, setup.scene.time.step
        # A share of the least limit of at most that is below all of them.
        may_exceed = self._fixed is not None or self._safety > courant
        self._checked = may_exceed and not setup.allow_unstable

    def next(self, hook: Any) -> float:
        """Return the length of the next step [s].

        Raise SimulationError past a stability limit, and when the limit has collapsed."""
        limits = self.limits(hook)
        limit, owner = min(limits)
        step, refusal = self._choose(limits)
        if refusal:
            advice = "a smaller time.step, or allow_unstable = true"
            raise PastStabilityLimit(refusal, time=self.state.time, advice=advice)
        if limit < COLLAPSED * self.bulk_limit:
            raise SimulationError(
                f"the stable time step fell to {limit:.3g} s, set by {owner}; that of the bulk is "
                f"{self.bulk_limit:.3g} s",
                time=self.state.time,
                advice=self._advice(owner),
            )
        return step

    def _advice(self, owner: str) -> str:
        """Return ways to lengthen the steps that a contact limits."""
        for contact in getattr(self.contact, "contacts", (self.contact,)):
            if contact is None or not owner.startswith(
                (contact.name, getattr(contact, "law_name", contact.name))
            ):
                continue
            softer = f" ({contact.softer_by})" if contact.softer_by else ""
            mapped = contact.needs_surface and "map" in contact.Options.model_fields
            other = f"another contact.{contact.name.split('+')[0]}.map, " if mapped else ""
            return f"a softer contact{softer}, {other}or another shape function"
        return "another shape function"

    def check(self, hook: Any) -> None:
        """Refuse a step past the first limit."""
        if refusal := self._choose(self.limits(hook))[1]:
            key = "time.safety" if self._fixed is None else "time.step"
            raise SceneError(f"{refusal}; expected a smaller {key}, or allow_unstable = true", key=key)

    def limits(self, hook: Any) -> list[tuple[float, str]]:
        """Return the stable time step [s] of every owner, before the safety factor; the bulk's comes first.

        Raise PluginError for NaN, which a minimum would pass over."""
        answers = hook.stable_timestep(state=self.state)
        for answer in answers:
            if not answer[0] > 0.0:
                text = (
                    f"a plug-in answered stable_timestep with {answer!r:.80}; "
                    "expected a time [s] above 0 and its owner"
                )
                raise PluginError(text, step=self.state.steps, time=self.state.time)
        least = {owner: limit for limit, owner in sorted(answers, reverse=True)}
        return [self._bulk, *((limit, owner) for owner, limit in least.items())]

    def _stable(self, limit: float, owner: str) -> tuple[float, str]:
        """Return the share of a ``limit`` [s] that is stable, and its owner."""
        if not owner.startswith("bulk"):
            return limit, owner
        return self._courant * limit, f"{owner}, of which {self._courant:g} is stable"

    def _choose(self, limits: list[tuple[float, str]]) -> tuple[float, str]:
        """Return the step [s], and the reason if it is past a stability limit."""
        step: float = self._safety * min(limits)[0] if self._fixed is None else self._fixed
        if not self._checked:
            return step, ""
        limit, owner = min(self._stable(*limit) for limit in limits)
        if step <= limit * (1.0 + 1e-12):
            return step, ""
        return step, f"a step of {step:.4g} s is past the stability limit {limit:.4g} s of {owner}"


class Clock(_event.Listener):  # type: ignore[misc]
    """Attributes time to the stage that is running, without that of compilation.

    Wall time is read at every change of stage. CPU time is read once a frame, in :meth:`flush`, and shared
    out in proportion: reading it costs as much as a small kernel.
    """

    history = ("cpu", "wall", "compile_time")

    def __init__(self) -> None:
        self._stage, self._depth = "output", 0
        self.compile_time = 0.0  #: of kernels, and of loading them [s]
        self.restart()

    def restart(self) -> None:
        """Forget the stages so far, so that settling does not count."""
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
        """Add what was measured since the last flush to the totals [s]."""
        self(self._stage)
        cpu_now = time.process_time()
        elapsed = sum(self._wall_frame.values())
        ratio = (cpu_now - self._cpu_mark) / elapsed if elapsed > 0.0 else 0.0
        for stage, seconds in self._wall_frame.items():
            self.wall[stage] += seconds
            self.cpu[stage] += seconds * ratio
            self._wall_frame[stage] = 0.0
        self._cpu_mark = cpu_now

    @contextmanager
    def watching_compilation(self) -> Iterator[None]:
        """Context in which compilation counts as ``compile_time`` and as no stage's; totals are up to date
        at its end."""
        _event.register(_LOCK, self)
        try:
            yield
        finally:
            self.flush()
            _event.unregister(_LOCK, self)

    def on_start(self, event: Any) -> None:  # noqa: ARG002
        """The lock is taken; inner kernels take it again."""
        if self._depth == 0:
            self._lock_marks = time.perf_counter(), time.process_time()
        self._depth += 1

    def on_end(self, event: Any) -> None:  # noqa: ARG002
        """The lock is given back."""
        self._depth -= 1
        if self._depth == 0:
            wall, cpu = time.perf_counter() - self._lock_marks[0], time.process_time() - self._lock_marks[1]
            self.compile_time += wall
            self._mark += wall
            self._cpu_mark += cpu
