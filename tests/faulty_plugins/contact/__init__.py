"""Deliberately wrong contact laws: what a conformance kit must catch. Never use them for anything else."""
