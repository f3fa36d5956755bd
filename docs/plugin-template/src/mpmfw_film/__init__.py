# src/mpmfw_film/__init__.py
"""Coulomb friction beside a viscous film between the bodies: a contact law, a plug-in of mpmfw."""

from mpmfw_film.law import Film, FilmOptions

__all__ = ["Film", "FilmOptions"]
