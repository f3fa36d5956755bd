"""The conformance kit: does a plug-in of one's own keep what its kind must keep?

From pytest (needs the extra ``mpmfw[testing]``)::

    from mpmfw_testing import contact_conformance

    @contact_conformance(MyLaw, expected_failures={"moment-balance": "the map does not keep Σ N_i x_i = x_s"})
    def test_conformance(check):
        check()

From the command line: ``mpmfw check PLUGIN``, and in one line ``mpmfw.check_plugin(MyLaw)``. The names below are imported at
their first use, so that ``import mpmfw_testing`` needs neither pytest nor hypothesis nor numba.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mpmfw_testing.check import Check, Inapplicable, Outcome, Violation
    from mpmfw_testing.contact import contact_checks
    from mpmfw_testing.examination import examine
    from mpmfw_testing.friction import friction_checks
    from mpmfw_testing.geometry import geometry_checks
    from mpmfw_testing.load import load_checks
    from mpmfw_testing.material import material_checks
    from mpmfw_testing.parametrised import (
        boundary_conformance,
        check_plugin,
        contact_conformance,
        detection_conformance,
        friction_conformance,
        geometry_conformance,
        law_conformance,
        load_conformance,
        material_conformance,
        measure_conformance,
        output_conformance,
        reference_conformance,
        shape_conformance,
    )
    from mpmfw_testing.searching import ladder, search, try_all
    from mpmfw_testing.shape import shape_checks
    from mpmfw_testing.subject import Subject, subject_of

_MODULES = {
    "Check": "mpmfw_testing.check",
    "Inapplicable": "mpmfw_testing.check",
    "Outcome": "mpmfw_testing.check",
    "Subject": "mpmfw_testing.subject",
    "Violation": "mpmfw_testing.check",
    "check_plugin": "mpmfw_testing.parametrised",
    "contact_checks": "mpmfw_testing.contact",
    "contact_conformance": "mpmfw_testing.parametrised",
    "detection_conformance": "mpmfw_testing.parametrised",
    "law_conformance": "mpmfw_testing.parametrised",
    "examine": "mpmfw_testing.examination",
    "material_checks": "mpmfw_testing.material",
    "material_conformance": "mpmfw_testing.parametrised",
    "load_checks": "mpmfw_testing.load",
    "load_conformance": "mpmfw_testing.parametrised",
    "boundary_conformance": "mpmfw_testing.parametrised",
    "friction_checks": "mpmfw_testing.friction",
    "friction_conformance": "mpmfw_testing.parametrised",
    "output_conformance": "mpmfw_testing.parametrised",
    "geometry_checks": "mpmfw_testing.geometry",
    "geometry_conformance": "mpmfw_testing.parametrised",
    "measure_conformance": "mpmfw_testing.parametrised",
    "reference_conformance": "mpmfw_testing.parametrised",
    "ladder": "mpmfw_testing.searching",
    "search": "mpmfw_testing.searching",
    "shape_checks": "mpmfw_testing.shape",
    "shape_conformance": "mpmfw_testing.parametrised",
    "subject_of": "mpmfw_testing.subject",
    "try_all": "mpmfw_testing.searching",
}

__all__ = [
    "Check",
    "Inapplicable",
    "Outcome",
    "Subject",
    "Violation",
    "boundary_conformance",
    "check_plugin",
    "contact_checks",
    "contact_conformance",
    "detection_conformance",
    "examine",
    "friction_checks",
    "friction_conformance",
    "geometry_checks",
    "geometry_conformance",
    "ladder",
    "law_conformance",
    "load_checks",
    "load_conformance",
    "material_checks",
    "material_conformance",
    "measure_conformance",
    "output_conformance",
    "reference_conformance",
    "search",
    "shape_checks",
    "shape_conformance",
    "subject_of",
    "try_all",
]


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name not in _MODULES:
        raise AttributeError(f"module 'mpmfw_testing' has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
