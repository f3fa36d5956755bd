"""Runs of one scene: building, stepping, writing frames, restart and limits."""
