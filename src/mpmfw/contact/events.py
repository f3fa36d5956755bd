"""How well the steps resolve the springs: steps per contact, and the deepest penetration."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.kernels import kernel
from mpmfw.kernels.contact import Rows, acts
from mpmfw.kernels.types import Floats, Ints
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field
from mpmfw.state.history import NotSaved
from mpmfw.state.structs import State

if TYPE_CHECKING:
    from mpmfw.contact.law import ContactLaw

#: Fewest steps of a contact without a warning: a free impact then gains up to 24 % of its energy, of two
#: steps 55 %.
FEWEST_STEPS = 3

_STEPS = "fewest steps that a contact of a place lasted, of those that ended since the last output"
_DEPTH = "deepest penetration since the last output, over the cell size"
STEPS_PER_CONTACT = Field("steps_per_contact", ("pair",), "1", _STEPS, "series", output=True, missing=True)
PENETRATION = Field("penetration", ("pair",), "1", _DEPTH, "series", output=True, missing=True)


@kernel
def follow_contacts(
    rows: Rows, count: int, age: Floats, old_pair: Ints, old_age: Floats, fewest: Floats, deepest: Floats
) -> None:
    """Count the steps of every place's contact; note the least at its end, and the largest −g_n, by pair.

    ``age`` and ``old_age`` are the steps that contacts lasted, of this step's rows and the last one's, which
    is used up; the first row of an identity has it. ``old_pair`` are the last rows' pairs.
    """
    last = -1
    for c in range(count):
        age[c] = 0.0
        if rows.identity[c] != last and acts(c, rows):
            p, last = rows.pair[c], rows.identity[c]
            deepest[p] = max(deepest[p], -rows.gap[c])
            age[c] = 1.0
            if rows.previous[c] >= 0:
                age[c] += old_age[rows.previous[c]]
                old_age[rows.previous[c]] = 0.0
    for o in range(len(old_pair)):
        if old_age[o] > 0.0:
            fewest[old_pair[o]] = min(fewest[old_pair[o]], old_age[o])


class ContactEvents:
    """Follows the contacts of the rows of laws of forces, if the scene requests it."""

    name = "contact_events"
    stage = "output"
    history = ("old_age", "old_pair", "fewest", "deepest", "fewest_ever")

    def __init__(self, *laws: ContactLaw) -> None:
        self.laws = laws

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [STEPS_PER_CONTACT, PENETRATION]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        self.state, self.cell_size = setup.state, setup.cell_size
        #: of the last rows, by the law's name
        self.old_age = {law.name: np.zeros(0) for law in self.laws}
        self.old_pair = {law.name: np.zeros(0, dtype=np.int64) for law in self.laws}
        self.fewest = self.fewest_ever = self.deepest = np.zeros(0)
        self.add_pairs(setup.state)

    @hookimpl
    def add_pairs(self, state: State) -> None:
        none = np.zeros(len(state.pairs) - len(self.fewest))
        self.fewest = np.append(self.fewest, none + np.inf)
        self.fewest_ever = np.append(self.fewest_ever, none + np.inf)
        self.deepest = np.append(self.deepest, none)

    @hookimpl
    def end_step(self) -> None:
        for law in self.laws:
            rows, of_last = law.last_rows, (self.old_pair[law.name], self.old_age[law.name])
            age = np.zeros(rows.count)
            follow_contacts(rows, rows.count, age, *of_last, self.fewest, self.deepest)
            self.old_age[law.name], self.old_pair[law.name] = age, rows.pair[: rows.count].copy()

    def restored(self) -> None:
        """Refuse ages of other rows than those of the last step by ``NotSaved``."""
        for law in self.laws:
            pairs = law.last_rows.pair[: law.last_rows.count]
            if len(self.old_age[law.name]) != len(pairs) or (self.old_pair[law.name] != pairs).any():
                raise NotSaved("the ages of contacts are not those of the rows")

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """The series, NaN where other contacts act; contacts of the settling do not count."""
        followed = np.any([law.detection.acting(state) for law in self.laws], axis=0)
        fewest = np.where(np.isfinite(self.fewest), self.fewest, np.nan)
        series = {
            "steps_per_contact": fewest,
            "penetration": np.where(followed, self.deepest / self.cell_size, np.nan),
        }
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
            f"{pair.label}: a contact lasted {steps:.0f} steps, fewer than {FEWEST_STEPS}, and gains energy; "
            f"try a smaller {' or '.join(filter(None, ('time.safety', law.softer_by)))}"
            for law in self.laws
            for pair, steps, own in zip(
                self.state.pairs, self.fewest_ever, law.detection.acting(self.state), strict=True
            )
            if own and steps < FEWEST_STEPS
        ]
