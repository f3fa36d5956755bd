"""Planted faults of friction laws, boundary conditions and outputs: each breaks one property."""
