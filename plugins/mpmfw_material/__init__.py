"""Bundled materials."""
