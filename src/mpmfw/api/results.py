"""Base classes of measures and references, which read results and scenes alone."""

from __future__ import annotations

from mpmfw.plugin.measure import About, Exact, Measure, Measured, Reference

__all__ = ["About", "Exact", "Measure", "Measured", "Reference"]
