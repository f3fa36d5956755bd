"""The directive ``commands``: every command with its arguments and options, read from the program itself."""

from __future__ import annotations

import html
import subprocess
import sys

from docutils import nodes  # type: ignore[import-untyped]
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def reference() -> str:
    """Markdown, a section for each command, as typer writes it from the commands' own declarations."""
    command = [sys.executable, "-m", "typer", "mpmfw.cli.app", "utils", "docs", "--name", "mpmfw"]
    made = subprocess.run(command, check=True, capture_output=True, text=True, encoding="utf-8")
    _, start, sections = html.unescape(made.stdout).partition("\n## ")
    return f"{start}{sections}"


class Commands(SphinxDirective):
    """Sections of the page, one for each command."""

    def run(self) -> list[nodes.Node]:
        """Parse the sections as the page itself is."""
        return self.parse_text_to_nodes(reference(), allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True}
