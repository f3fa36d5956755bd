"""Plug-ins: base classes, hook specifications, bound hooks, setup and discovery."""
