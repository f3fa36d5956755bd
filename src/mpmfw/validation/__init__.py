"""The validation suite: cases that judge methods against closed forms and references, and what came of them.

A case is a folder with ``README.md`` (source, set-up, tolerances), ``check.py`` and what it needs. ``check.py``
defines ``check(case)``, which runs scenes and records rows and figures with the :class:`Case` that it is given.
"""

from mpmfw.validation.case import CLASSICAL, CONTACTS, SHAPES, Case, Method
from mpmfw.validation.rows import Row, Verdict

__all__ = [
    "CLASSICAL",
    "CONTACTS",
    "SHAPES",
    "Case",
    "Method",
    "Row",
    "Verdict",
]
