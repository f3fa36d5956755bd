"""Loads that break one property each."""
