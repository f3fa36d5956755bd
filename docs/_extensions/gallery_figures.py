"""Show in the gallery what a notebook shows: a figure, or a film's file, whose name is the last line of a
block.
"""

from __future__ import annotations

import ast
import shutil
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst  # type: ignore[import-untyped]


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figure or film that the block ends with; mpmfw draws without pyplot, so that nobody else knows
    of it.
    """
    _, code, _ = block
    body = ast.parse(code).body
    last = body[-1].value if body and isinstance(body[-1], ast.Expr) else None
    shown = block_vars["example_globals"].get(last.id) if isinstance(last, ast.Name) else None
    film = isinstance(shown, Path) and shown.suffix == ".gif"
    if not film and not isinstance(shown, Figure):
        return ""
    path = Path(next(block_vars["image_path_iterator"]))
    if film:
        path = path.with_suffix(".gif")
        shutil.copyfile(shown, path)
    else:
        shown.savefig(path)
    made: str = figure_rst([str(path)], gallery_conf["src_dir"])
    return made
