"""The conformance kit: does a plug-in of one's own keep what its kind must keep?

From pytest (needs the extra ``mpmfw[testing]``)::

    from mpmfw.testing import contact_conformance

    @contact_conformance(MyLaw, expected_failures={"moment-balance": "the map does not keep Σ N_i x_i = x_s"})
    def test_conformance(check):
        check()

From the command line: ``mpmfw check PLUGIN``, and in one line ``mpmfw.check_plugin(MyLaw)``. The names below are imported at
their first use, so that ``import mpmfw.testing`` needs neither pytest nor hypothesis nor numba.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mpmfw.testing.check import Check, Inapplicable, Outcome, Violation
    from mpmfw.testing.contact import contact_checks
    from mpmfw.testing.examination import examine
    from mpmfw.testing.friction import friction_checks
    from mpmfw.testing.geometry import geometry_checks
    from mpmfw.testing.load import load_checks
    from mpmfw.testing.material import material_checks
    from mpmfw.testing.parametrised import (
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
    from mpmfw.testing.searching import ladder, search, try_all
    from mpmfw.testing.shape import shape_checks
    from mpmfw.testing.subject import Subject, subject_of

_MODULES = {
    "Check": "mpmfw.testing.check",
    "Inapplicable": "mpmfw.testing.check",
    "Outcome": "mpmfw.testing.check",
    "Subject": "mpmfw.testing.subject",
    "Violation": "mpmfw.testing.check",
    "check_plugin": "mpmfw.testing.parametrised",
    "contact_checks": "mpmfw.testing.contact",
    "contact_conformance": "mpmfw.testing.parametrised",
    "detection_conformance": "mpmfw.testing.parametrised",
    "law_conformance": "mpmfw.testing.parametrised",
    "examine": "mpmfw.testing.examination",
    "material_checks": "mpmfw.testing.material",
    "material_conformance": "mpmfw.testing.parametrised",
    "load_checks": "mpmfw.testing.load",
    "load_conformance": "mpmfw.testing.parametrised",
    "boundary_conformance": "mpmfw.testing.parametrised",
    "friction_checks": "mpmfw.testing.friction",
    "friction_conformance": "mpmfw.testing.parametrised",
    "output_conformance": "mpmfw.testing.parametrised",
    "geometry_checks": "mpmfw.testing.geometry",
    "geometry_conformance": "mpmfw.testing.parametrised",
    "measure_conformance": "mpmfw.testing.parametrised",
    "reference_conformance": "mpmfw.testing.parametrised",
    "ladder": "mpmfw.testing.searching",
    "search": "mpmfw.testing.searching",
    "shape_checks": "mpmfw.testing.shape",
    "shape_conformance": "mpmfw.testing.parametrised",
    "subject_of": "mpmfw.testing.subject",
    "try_all": "mpmfw.testing.searching",
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
        raise AttributeError(f"module 'mpmfw.testing' has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
