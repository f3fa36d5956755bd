"""The conformance kit: tests if a plug-in has the properties of its kind.

From pytest (needs the extra ``mpmfw[testing]``)::

    from mpmfw_testing import contact_conformance

    @contact_conformance(MyLaw, expected_failures={"moment-balance": "the map does not keep Σ N_i x_i = x_s"})
    def test_conformance(check):
        check()

From the command line: ``mpmfw check PLUGIN``, and in one line ``mpmfw.check_plugin(MyLaw)``. Names that need
numba are imported at their first use, since ``mpmfw new`` needs none of them.
"""

# ruff: noqa: F403, F405
import importlib
from typing import TYPE_CHECKING, Any

from mpmfw_testing.check import Check, Inapplicable, Outcome, Violation
from mpmfw_testing.searching import ladder, search, try_all

if TYPE_CHECKING:
    from mpmfw_testing.examination import examine
    from mpmfw_testing.parametrised import *
    from mpmfw_testing.subject import Subject, subject_of

__all__ = [
    "Check", "Inapplicable", "Outcome", "Subject", "Violation", "boundary_conformance", "check_plugin",
    "checks_of", "contact_conformance", "detection_conformance", "examine", "friction_conformance",
    "geometry_conformance", "ladder", "law_conformance", "load_conformance", "material_conformance",
    "measure_conformance", "output_conformance", "reference_conformance", "search", "shape_conformance",
    "subject_of", "try_all",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name not in __all__:
        raise AttributeError(f"module 'mpmfw_testing' has no attribute {name!r}")
    where = {"examine": "examination", "Subject": "subject", "subject_of": "subject"}
    return getattr(importlib.import_module(f"mpmfw_testing.{where.get(name, 'parametrised')}"), name)
