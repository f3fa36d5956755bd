"""Gates that are known not to hold, each with its reason: a list that must stay exact."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from mpmfw.errors import SceneError
from mpmfw.validation.rows import Row, Verdict


class KnownRed(BaseModel):
    """One gate, and why it does not hold."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    case: str
    method: str
    quantity: str
    why: str

    def is_of(self, row: Row) -> bool:
        """Whether a row is this gate."""
        return (self.case, self.method, self.quantity) == (row.case, row.method, row.quantity)


def read_known_red(path: Path) -> list[KnownRed]:
    """Read the tables ``[[red]]`` of a TOML file.

    Raises
    ------
    SceneError
        The file is not there, or not such a list.
    """
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8")).get("red", [])
        return [KnownRed.model_validate(table) for table in tables]
    except (OSError, tomllib.TOMLDecodeError, ValidationError) as error:
        raise SceneError(f"--known-red {path}: {error}") from error


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
