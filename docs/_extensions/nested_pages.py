"""What the site needs, and pages do not carry where the repository is browsed: lists of pages below, the
built gallery.
"""

from __future__ import annotations

import re

from sphinx.application import Sphinx

#: Pages below a page, as a pattern from the page's own folder.
BELOW = {"validation/README": "*/README", "validation/hard/README": "*/README"}

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


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to pages as they are read."""
    app.connect("source-read", adapt)
    return {"parallel_read_safe": True}
