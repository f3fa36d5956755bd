"""Lines of kernels that go past the end of an array (``NUMBA_BOUNDSCHECK=1``)."""

from __future__ import annotations

from typing import Any


def say_lines() -> None:
    """Let kernels that meet an index out of bounds raise it from the line in question, in this process from
    now on.

    Compiled code raises a bare ``IndexError``. The kernel is then run once more as Python, with the arrays as
    they are, which raises it from the line; where that cannot be, as of what only compiled code can call, the
    first error stands.
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
