"""Settling to static equilibrium before time zero, by local non-viscous damping (Cundall 1982).

At every node a share of the unbalanced force's magnitude is taken against the direction of motion. Every mode
is damped alike, and the damping vanishes with the unbalanced force: nothing of it stays in the stresses."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.errors import ResultsWarning
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Nodes
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.structs import Body, Grid, State

if TYPE_CHECKING:
    from mpmfw.scene import Scene
    from mpmfw.scene.tables import Settle

#: Share of the unbalanced force.
DAMPING = 0.8

#: Share of FLIP while settling: the rest filters motion within a cell, which the grid does not damp.
FLIP_SHARE = 0.9

#: Kinetic over strain energy of a scene that is not at rest: 3 % of the static displacement.
MOTION_LEFT = 1e-3

#: Crossings of the longest body by its elastic wave after which settling gives up by default.
CROSSINGS = 100

#: The residual is the mean over so many steps: a moment of balance in an oscillation does not count.
STEPS_OF_MEAN = 50


@kernel
def damp_locally(share: float, grid: Nodes, spacing: tuple[float, ...]) -> float:
    """(m v)_i −= share |Δ(m v)_i| sign(v_i); return Σ |Δ(m v)_i| before."""
    momentum, total = grid.momentum, 0.0
    for i in range(len(momentum)):
        for d in range(len(spacing)):
            change = momentum[i, d] - grid.mass[i] * grid.start_velocity[i, d]
            total += abs(change)
            if momentum[i, d] > 0.0:
                momentum[i, d] -= share * abs(change)
            elif momentum[i, d] < 0.0:
                momentum[i, d] += share * abs(change)
    return total


def from_setup(setup: Setup) -> Acts:
    """Return why the scene settles; the damping is registered only meanwhile."""
    asked = setup.scene.settle
    assert asked is not None
    longest = f"{CROSSINGS} crossings" if asked.max_time is None else f"{asked.max_time:g} s"
    return Acts(f"[settle]: to {asked.tolerance:g} of the internal forces, for {longest} at most")


def is_settled_for_good(scene: Scene) -> bool:
    """Return whether the scene should stay at rest."""
    constant = scene.gravity is None or scene.gravity.is_constant
    bodies = scene.bodies.values()
    return (
        scene.settle is not None
        and (scene.settle.gravity is None and constant and not scene.loads)
        and all(body.velocity is None and body.angular_velocity is None for body in bodies)
        and all(side.is_constant for body in bodies for side in body.sides)
        and all(getattr(body, "rigid", True) is True for body in bodies)
    )


def concern(settled: Mapping[str, float]) -> list[str]:
    """Return a sentence if the scene moved after settling."""
    if (share := settled.get("settle_motion", 0.0)) <= MOTION_LEFT:
        return []
    return [
        f"the scene still moved at the first output after settling, with {100 * share:.2g} % of the strain "
        "energy as kinetic energy; try a smaller settle.tolerance, or a longer settle.max_time"
    ]


def longest_settling(asked: Settle, bodies: Iterable[Body]) -> float:
    """Return the simulated time after which settling gives up [s]."""
    if asked.max_time is not None:
        return float(asked.max_time)
    return CROSSINGS * max(float(np.subtract(b.upper, b.lower).max()) / b.wave_speed for b in bodies)


class Settling:
    """Dynamic relaxation of a scene under its loads before time zero; moving sides stand still.

    The object is a plug-in that damps until :meth:`finish` returns. It calls ``while_settling`` of other
    plug-ins with the table ``[settle]`` at the start, and with None at the end."""

    name = "settling"
    history = ("ratios", "residual", "elapsed", "impulse", "_integrated")

    def __init__(self, setup: Setup) -> None:
        asked = setup.scene.settle
        assert asked is not None
        self.limit, self.tolerance = longest_settling(asked, setup.bodies), asked.tolerance
        self.transfer = replace(setup.exchange, flip=min(setup.flip, FLIP_SHARE))  #: while settling
        self.others = [plugin for plugin in setup.plugins if hasattr(plugin, "while_settling")]
        for plugin in self.others:
            plugin.while_settling(asked)
        self.residual, self.elapsed = 1.0, 0.0
        self.ratios = np.ones(STEPS_OF_MEAN)  #: residual over internal forces in the last steps
        self.impulse = 0.0  #: Σ |Δ(m v)_i| of the last step [N s/m]
        self.internal = 0.0  #: Σ |f_i| of the internal forces of the last step [N/m]
        self._integrated = False

    @hookimpl(tryfirst=True)
    def add_nodal_force(self, grid: Grid) -> None:
        """Sum the internal forces before any other is added."""
        self.internal = float(np.abs(grid.force).sum())

    @hookimpl
    def after_momentum_update(self) -> None:
        """The next boundary condition is that of the forces."""
        self._integrated = True

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid: Grid) -> None:
        """Damp once a step, after the boundary conditions, so that reactions balance."""
        if self._integrated:
            self._integrated = False
            self.impulse = damp_locally(DAMPING, grid, grid.spacing)

    def finish(
        self, state: State, step: Callable[[], None], after_step: Callable[[], None] | None = None
    ) -> dict[str, float]:
        """Step until the residual force is below the tolerance times the internal forces, or time is up.

        Both are sums of magnitudes over all nodes and axes. ``step`` takes a time step with the damping;
        ``after_step`` is called after each. Return attributes for the results."""
        while self.residual > self.tolerance and self.elapsed < self.limit:
            state.time = 0.0  # loads that change in time stand still at their start
            step()
            self.elapsed += state.dt
            force, internal = self.impulse / state.dt, self.internal
            ratio = min(1.0, force / internal) if internal > 0.0 else float(force > 0.0)
            self.ratios[state.steps % STEPS_OF_MEAN] = ratio
            self.residual = float(self.ratios.mean())
            if after_step is not None:
                after_step()
        if self.residual > self.tolerance:
            warnings.warn(
                f"settling stopped after {self.elapsed:.3g} s with a residual force of {self.residual:.2g} "
                f"of the internal forces (tolerance {self.tolerance:.2g})",
                ResultsWarning,
                stacklevel=3,
            )
        return {
            "settle_residual": self.residual,
            "settle_steps": state.steps,
            "settle_simulated_time": self.elapsed,
        }

    def end(self, state: State) -> None:
        """Stop all motion; loads and sides are the scene's own again."""
        p = state.particles
        for array in (p.velocity, p.affine, p.moment):
            if array is not None:
                array.fill(0.0)
        for plugin in self.others:
            plugin.while_settling(None)
