"""How well the steps resolve the springs: steps per contact, and the deepest penetration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.api import AnyArray, Field, FloatArray, IntArray, Setup, State, hookimpl
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats, Ints
from mpmfw_contact.penalty.pair_table import pair_index

if TYPE_CHECKING:
    from mpmfw_contact.penalty.strategy import SurfaceSprings

#: Steps per contact below which a free impact gains 18 % of its energy (in the worst phase).
FEWEST_STEPS = 3

STEPS_PER_CONTACT = Field(
    "steps_per_contact",
    ("pair",),
    "1",
    "fewest steps that a contact of a surface node lasted, of those that ended since the last output",
    "series",
    output=True,
    missing=True,
)
PENETRATION = Field(
    "penetration",
    ("pair",),
    "1",
    "deepest penetration of a surface node since the last output, over the cell size",
    "series",
    output=True,
)
AGE = Field("age", ("surface_node",), "1", "steps that the node's contact has lasted", "surface", "i8")
PARTNER = Field("partner", ("surface_node",), "1", "pair of that contact", "surface", "i8")


@kernel
def follow_contacts(
    slots: int,
    master: Ints,
    gap: Floats,
    body: Ints,
    pair_of: Ints,
    age: Ints,
    partner: Ints,
    fewest: Floats,
    deepest: Floats,
) -> None:
    """Count the steps of every node's contact; at its end note the least, and the largest −g_n, of each pair.

    ``master`` (n_s, slots) is −1 without contact; ``fewest`` and ``deepest`` are (pair,).
    """
    for s in range(len(body)):
        touched = -1
        for j in range(slots):
            if master[s, j] >= 0:
                touched = pair_index(pair_of, body[s], master[s, j])
                deepest[touched] = max(deepest[touched], -gap[s, j])
        if touched >= 0:
            age[s] += 1
            partner[s] = touched
        elif age[s] > 0:
            fewest[partner[s]] = min(fewest[partner[s]], float(age[s]))
            age[s] = 0


class ContactEvents:
    """Follows the contacts of a strategy's surface nodes, if the scene asks for it."""

    name = "contact_events"
    stage = "output"

    def __init__(self, contact: SurfaceSprings) -> None:
        self.contact = contact

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The two series."""
        return [STEPS_PER_CONTACT, PENETRATION]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Ages of the nodes' contacts."""
        self.state, self.cell_size = setup.state, setup.cell_size
        self.age: IntArray = setup.allocate(self.name, AGE)
        self.partner: IntArray = setup.allocate(self.name, PARTNER)
        self.fewest: FloatArray = np.full(len(setup.pairs), np.inf)
        self.deepest: FloatArray = np.zeros(len(setup.pairs))
        self.fewest_ever = self.fewest.copy()

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Nothing has happened yet between bodies that have come near."""
        more = len(state.pairs) - len(self.fewest)
        self.fewest, self.fewest_ever = (
            np.append(a, np.full(more, np.inf)) for a in (self.fewest, self.fewest_ever)
        )
        self.deepest = np.append(self.deepest, np.zeros(more))

    @hookimpl(tryfirst=True)
    def end_step(self, state: State) -> None:
        """Follow the contacts of this step, before the law makes them the history of the next."""
        if state.surface is None:
            return
        c = self.contact.candidates
        follow_contacts(
            c.slots,
            c.master,
            c.gap,
            state.surface.body,
            self.contact.laws.pair_of,
            self.age,
            self.partner,
            self.fewest,
            self.deepest,
        )

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """The series; contacts of the settling do not count."""
        fewest = np.where(np.isfinite(self.fewest), self.fewest, np.nan)
        series = {"steps_per_contact": fewest, "penetration": self.deepest / self.cell_size}
        if interval == 0.0:
            series["steps_per_contact"] = np.full_like(fewest, np.nan)
        else:
            self.fewest_ever = np.fmin(self.fewest_ever, self.fewest)
        self.fewest.fill(np.inf)
        self.deepest.fill(0.0)
        return series

    @hookimpl
    def concerns(self) -> list[str]:
        """Contacts that the steps do not resolve."""
        return [
            f"{pair.label}: a contact lasted {steps:.0f} steps, fewer than {FEWEST_STEPS}, and gains energy; try a smaller "
            f"time.safety or contact.{self.contact.name}.kappa"
            for pair, steps in zip(self.state.pairs, self.fewest_ever, strict=True)
            if steps < FEWEST_STEPS
        ]


def monitors(contact: SurfaceSprings) -> list[Any]:
    """What a scene with ``output.stability`` registers beside the contact."""
    return [ContactEvents(contact)]
