"""The entry point of detection between surfaces."""

from mpmfw.contact.surfaces import Surfaces

__all__ = ["Surfaces"]
