"""The command line: ``mpmfw COMMAND --help`` says what each command takes."""

from mpmfw.cli.app import app, main

__all__ = ["app", "main"]
