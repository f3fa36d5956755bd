"""What cannot be sent to another process, or arrives as something else."""

from __future__ import annotations

from typing import Any


class Sealed:
    """Holds a function that was made on the way."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.made = lambda: self


class Forgetful:
    """Is sent without what its constructor worked out."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.worked_out = 3.0

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "worked_out": 0.0}
