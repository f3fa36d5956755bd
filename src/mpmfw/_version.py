"""The version of mpmfw, in one place."""

__version__ = "0.1.0"
