"""The two sides of every hook that changes nodal momenta, between which the ledger measures impulses."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from mpmfw.effects.ledger import EnergyLedger
from mpmfw.hookspecs import hookimpl
from mpmfw.state import Grid, State


class BeforeImpulses:
    """Before all others in each hook: what momenta and forces are."""

    name = "energy_ledger_before"
    stage = "output"

    def __init__(self, ledger: EnergyLedger) -> None:
        self.ledger = ledger

    @hookimpl(tryfirst=True)
    def after_momentum_projection(self, grid: Grid) -> None:
        """Points to grid."""
        if self.ledger.running:
            self.ledger.project(grid)

    @hookimpl(tryfirst=True)
    def add_nodal_force(self, grid: Grid) -> None:
        """The internal forces."""
        if self.ledger.running:
            self.ledger.internal_force = grid.force.copy()

    @hookimpl(tryfirst=True)
    def after_momentum_update(self, grid: Grid) -> None:
        """The momentum is integrated."""
        if self.ledger.running:
            self.ledger.momentum = grid.momentum.copy()


class AfterImpulses:
    """After all others in each hook: what they did.

    Parameters
    ----------
    ledger
        Takes the impulses.
    gravity, loads
        The plug-ins of these names, or None.
    """

    name = "energy_ledger_after"
    stage = "output"

    def __init__(self, ledger: EnergyLedger, gravity: Any, loads: Any) -> None:
        self.ledger, self.gravity, self.loads = ledger, gravity, loads

    @hookimpl(trylast=True)
    def after_momentum_projection(self, grid: Grid) -> None:
        """Contact that corrects the projected momentum."""
        if self.ledger.running:
            self.ledger.change(grid, "contact")

    @hookimpl(trylast=True)
    def add_nodal_force(self, grid: Grid, state: State, dt: float) -> None:
        """Gravity, loads on sides, and what is left, contact."""
        ledger = self.ledger
        if not ledger.running:
            return
        rest = grid.force - ledger.internal_force
        if self.gravity is not None:
            gravity = grid.mass[:, None] * self.gravity.at(state.time)
            ledger.add("gravity", dt * gravity)
            rest -= gravity
        if self.loads is not None:
            loads = np.zeros_like(rest)
            self.loads.add_nodal_force(grid=SimpleNamespace(force=loads), state=state)
            ledger.add("external", dt * loads)
            rest -= loads
        ledger.add("contact", dt * rest)
        ledger.forced = True

    @hookimpl(trylast=True)
    def after_momentum_update(self, grid: Grid) -> None:
        """Contact that corrects the updated momentum."""
        if self.ledger.running:
            self.ledger.change(grid, "contact")

    @hookimpl(trylast=True)
    def correct_inertia(self, grid: Grid) -> None:
        """Inertia corrections."""
        if self.ledger.running:
            self.ledger.change(grid, "inertia")

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid: Grid) -> None:
        """Prescribed sides, and the balance of the grid.

        USF asks before there are forces as well, for the velocity of the strain: an impulse like the others. MUSL asks
        for it once more after the points have moved, which moves nothing.
        """
        if not self.ledger.running or self.ledger.balanced:
            return
        self.ledger.change(grid, "external")
        if self.ledger.forced:
            self.ledger.balance_grid(grid)
