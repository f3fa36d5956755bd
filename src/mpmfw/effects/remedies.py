"""Advice for a run that fails, computed from the methods that it runs with."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mpmfw.runs.build import Build


def remedies(made: Build) -> dict[str, str]:
    """Return what may help, by the part of the run that it changes: ``step``, ``scheme``, ``contact`` and
    ``shape``.

    A part is left out where nothing else can be recommended: ``contact`` without a contact, ``scheme`` under
    USL and under linear shape functions, which need MUSL."""
    contact = made.contact
    found = {"step": f"a smaller {'time.safety' if made.scene.time.step is None else 'time.step'}"}
    if made.scheme != "usl" and made.shape.name != "linear":
        found["scheme"] = "scheme 'usl'"
    if contact is not None:
        softer_by = getattr(contact, "softer_by", None)
        found["contact"] = "another contact" if softer_by is None else f"a softer contact ({softer_by})"
    return {**found, "shape": f"another shape than '{made.shape.name}'"}
