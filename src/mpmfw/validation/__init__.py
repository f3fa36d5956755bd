"""Validation cases in Python: closed forms and references for contact methods, run by pytest.

A case is a folder with a ``test_*.py`` that names scenes, methods and gates, and a ``README.md``.
"""

from mpmfw.validation.case import *  # noqa: F403
from mpmfw.validation.case import __all__ as __all__
