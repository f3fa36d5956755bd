"""Friction laws: μ and cohesion of every row of contact."""
