"""Show in the gallery what a notebook shows: a figure whose name is the last line of a block."""

from __future__ import annotations

import ast
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst  # type: ignore[import-untyped]


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figure that the block ends with; mpmfw draws without pyplot, so that nobody else knows of it."""
    _, code, _ = block
    body = ast.parse(code).body
    last = body[-1].value if body and isinstance(body[-1], ast.Expr) else None
    shown = block_vars["example_globals"].get(last.id) if isinstance(last, ast.Name) else None
    if not isinstance(shown, Figure):
        return ""
    path = next(block_vars["image_path_iterator"])
    shown.savefig(path)
    made: str = figure_rst([path], gallery_conf["src_dir"])
    return made
