"""The validation suite: cases that judge methods against closed forms and references, and what came of them.

A case is a folder with ``README.md`` (source, set-up, tolerances) and ``case.toml``: scenes, what of them varies, the
quantities that are read off each run, and their gates. Where a table cannot say it, ``check.py`` defines ``check(case)``
instead, which runs scenes and records rows and figures with the :class:`Case` that it is given.
"""

from mpmfw.validation.case import CLASSICAL, CONTACTS, SHAPES, Case, Method
from mpmfw.validation.measuring import CaseRun
from mpmfw.validation.rows import Row, Verdict

__all__ = [
    "CLASSICAL",
    "CONTACTS",
    "SHAPES",
    "Case",
    "CaseRun",
    "Method",
    "Row",
    "Verdict",
]
