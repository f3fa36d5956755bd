"""A plug-in that cannot be sent to another process."""

from __future__ import annotations

from typing import Any


class Sealed:
    """Holds a function that was made on the way."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.made = lambda: self
