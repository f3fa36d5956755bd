"""Lines of kernels that go past the end of an array (``NUMBA_BOUNDSCHECK=1``)."""

from __future__ import annotations

from typing import Any


def say_lines() -> None:
    """Let kernels of this process raise an index out of bounds from its line.

    Compiled code raises a bare ``IndexError``. The kernel is then run once more as Python, which raises it
    from the line; where Python cannot run it, the first error stands.
    """
    from numba.core import dispatcher

    kind: Any = dispatcher.Dispatcher
    compiled = kind.__call__

    def call(self: Any, *arguments: Any) -> Any:
        try:
            return compiled(self, *arguments)
        except IndexError as error:
            try:
                self.py_func(*arguments)
            except IndexError as located:
                raise located from None
            except Exception:
                raise error from None
            raise

    kind.__call__ = call
