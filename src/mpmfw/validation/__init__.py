"""Validation cases in Python: closed forms and references that tell contact methods apart, run by pytest.

A case is a folder with a ``test_*.py`` that names scenes, methods and gates, and a ``README.md`` with
its sources.
"""

from mpmfw.validation.case import (
    CLASSICAL,
    CONTACTS,
    RECOMMENDED,
    SHAPES,
    CaseRun,
    Method,
    Place,
    Runs,
    RunSet,
    Version,
    each,
    full,
    known_red,
    methods,
    quick,
    together,
)
from mpmfw.validation.rows import Case, Row, Verdict

__all__ = [
    "CLASSICAL",
    "CONTACTS",
    "RECOMMENDED",
    "SHAPES",
    "Case",
    "CaseRun",
    "Method",
    "Place",
    "Row",
    "RunSet",
    "Runs",
    "Verdict",
    "Version",
    "each",
    "full",
    "known_red",
    "methods",
    "quick",
    "together",
]
