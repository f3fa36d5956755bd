"""Bundled shape functions."""
