"""The two sides of every hook that changes nodal momenta, between which the ledger measures impulses."""

from __future__ import annotations

from typing import Any

from mpmfw.effects.ledger import EnergyLedger
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.structs import Grid


class BeforeImpulses:
    """Before all others in each hook: what momenta and forces are."""

    name = "energy_ledger_before"
    stage = "output"

    def __init__(self, ledger: EnergyLedger) -> None:
        self.ledger = self.only_while = ledger

    @hookimpl(tryfirst=True)
    def after_momentum_projection(self, grid: Grid) -> None:
        """Points to grid."""
        self.ledger.project(grid)

    @hookimpl(tryfirst=True)
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """The internal forces."""
        self.ledger.begin_forces(grid, dt)

    @hookimpl(tryfirst=True)
    def after_momentum_update(self, grid: Grid) -> None:
        """The momentum is integrated."""
        self.ledger.momentum = grid.momentum.copy()


class BeforeForce:
    """Just before gravity or a load: what came since the last look is contact's.

    Parameters
    ----------
    ledger
        Takes the impulses.
    load
        The plug-in that comes next; its ``ledger_term`` says what its work counts as.
    """

    stage = "output"

    def __init__(self, ledger: EnergyLedger, load: Any) -> None:
        self.ledger = self.only_while = ledger
        self.name, self.term = f"{ledger.name} before {load_name(load)}", "contact"

    @hookimpl
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """Measured where the forces act: a load with a state of its own is called once."""
        self.ledger.exert(grid, self.term, dt)


class AfterForce(BeforeForce):
    """Just after gravity or a load: what came since the last look is its own."""

    def __init__(self, ledger: EnergyLedger, load: Any) -> None:
        super().__init__(ledger, load)
        self.name, self.term = f"{ledger.name} after {load_name(load)}", load.ledger_term[0]


def load_name(load: Any) -> str:
    """What tells a load from others: what the scene calls it, or its own name."""
    return str(getattr(load, "title", load.name))


class AfterImpulses:
    """After all others in each hook: what they did that no load did."""

    name = "energy_ledger_after"
    stage = "output"

    def __init__(self, ledger: EnergyLedger) -> None:
        self.ledger = self.only_while = ledger

    @hookimpl(trylast=True)
    def after_momentum_projection(self, grid: Grid) -> None:
        """Contact that corrects the projected momentum."""
        self.ledger.change(grid, "contact")

    @hookimpl(trylast=True)
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """What is left beside gravity and loads, contact."""
        self.ledger.exert(grid, "contact", dt)
        self.ledger.forced = True

    @hookimpl(trylast=True)
    def after_momentum_update(self, grid: Grid) -> None:
        """Contact that corrects the updated momentum."""
        self.ledger.change(grid, "contact")

    @hookimpl(trylast=True)
    def correct_inertia(self, grid: Grid) -> None:
        """Inertia corrections."""
        self.ledger.change(grid, "inertia")

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid: Grid) -> None:
        """Prescribed sides, and the balance of the grid.

        USF asks before there are forces as well, for the velocity of the strain: an impulse like the others. MUSL asks
        for it once more after the points have moved, which moves nothing.
        """
        if self.ledger.balanced:
            return
        self.ledger.change(grid, "external")
        if self.ledger.forced:
            self.ledger.balance_grid(grid)
