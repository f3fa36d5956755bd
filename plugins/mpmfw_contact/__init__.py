"""Bundled contact strategies."""
