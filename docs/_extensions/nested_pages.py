"""Add lists of subpages, links to the gallery, and widths of figures to the site."""

from __future__ import annotations

import re

from docutils import nodes
from PIL import Image
from sphinx.application import Sphinx

#: Pages below a page, as a pattern from the page's own folder.
BELOW = {"validation/README": "*/README", "validation/hard/README": "*/README"}

#: Largest width of a figure of one panel [px].
COLUMN = 700

#: A link to an example's script, or to the gallery's list, leads to what was built of it.
SCRIPT = re.compile(r"\]\(((?:\.\./)?)gallery/(\w+)\.(?:py|txt)\)")


def adapt(_app: Sphinx, page: str, source: list[str]) -> None:
    """Turn links to the gallery's sources to its pages; add a hidden toctree to a page that others stand
    below.
    """
    source[0] = SCRIPT.sub(_to_built_page, source[0])
    if page in BELOW:
        source[0] += f"\n\n```{{toctree}}\n:hidden:\n:glob:\n\n{BELOW[page]}\n```\n"


def _to_built_page(link: re.Match[str]) -> str:
    up, name = link.groups()
    return f"]({up}auto/gallery/{'index' if name == 'README' else name}.rst)"


def mark_widths(app: Sphinx, document: nodes.document) -> None:
    """Give figures the class ``column`` or ``wide``, by which the style sheet sets their widths."""
    for figure in document.findall(nodes.image):
        path = app.srcdir / figure["uri"]
        if path.suffix == ".png" and path.is_file():
            figure["classes"].append("wide" if Image.open(path).width > COLUMN else "column")


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to pages as they are read."""
    app.connect("source-read", adapt)
    app.connect("doctree-read", mark_widths)
    return {"parallel_read_safe": True}
