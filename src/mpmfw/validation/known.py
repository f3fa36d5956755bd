"""Gates that are known not to hold, each with its reason: a list that must stay exact."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from pydantic import Field

from mpmfw.campaigns.tables import validated
from mpmfw.scene.base import Table
from mpmfw.scene.sources import read_source
from mpmfw.validation.rows import Row, Verdict


class KnownRed(Table):
    """One gate, and why it does not hold."""

    case: str
    method: str
    quantity: str
    why: str

    def is_of(self, row: Row) -> bool:
        """Whether a row is this gate."""
        return (self.case, self.method, self.quantity) == (row.case, row.method, row.quantity)


class KnownTables(Table):
    """The file of such a list: a table ``[[red]]`` for each gate."""

    red: list[KnownRed] = Field(default=[])


def read_known_red(path: Path) -> list[KnownRed]:
    """Read the list.

    Raises
    ------
    SceneError
        The file is not there, or one line for each thing that is wrong in it.
    """
    return validated(KnownTables, read_source(path, "list of known red gates", {}), lambda _: ()).red


def departures(rows: Iterable[Row], known: Iterable[KnownRed], *, quick: bool = False) -> list[str]:
    """What differs from the list, a sentence each: gates that are red and not on it, gates on it that hold.

    A gate on the list must be among the rows of its case, unless the case did not run or ran in its ``quick`` version,
    which leaves gates out.
    """
    rows, known, text = list(rows), list(known), []
    ran = set() if quick else {row.case for row in rows}
    for gate in known:
        if gate.case in ran and not any(gate.is_of(row) for row in rows):
            text.append(
                f"{gate.case}: {gate.method}, {gate.quantity}: known as red, and there is no such gate"
            )
    for row in rows:
        listed = any(gate.is_of(row) for gate in known)
        name = f"{row.case}: {row.method}, {row.quantity}"
        if row.verdict is Verdict.RED and not listed:
            text.append(f"{name}: red, and not known to be")
        elif listed and row.verdict is Verdict.HOLDS:
            text.append(f"{name}: known as red, and it holds now; take it off the list")
    return text
