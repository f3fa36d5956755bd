"""Pytest of one case: ``pytest validation/hertz [--quick]``; ``mpmfw validate`` runs all."""

pytest_plugins = ["mpmfw.validation.suite"]
