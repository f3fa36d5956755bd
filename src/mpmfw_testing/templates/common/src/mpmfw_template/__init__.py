"""A KIND, a plug-in of mpmfw."""

from mpmfw_template.KIND import Template

__all__ = ["Template"]
