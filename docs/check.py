"""Check the documentation: ``python docs/check.py`` from the repository's root, with mpmfw installed.

Every relative link of a Markdown file resolves, headings included, and every ``mpmfw.xxx`` in backticks
exists. The site is built with warnings as errors, which checks links as well (``.ci/docs``); this takes a
second, needs nothing that is not installed with mpmfw, and is the only one that checks names."""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from mpmfw.plugin.discovery import KINDS

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
NAME = re.compile(r"`(mpmfw(?:_\w+)?(?:\.\w+)+)(?:\([^`]*\))?`")
#: Groups of entry points are named as if they were modules.
GROUPS = {f"mpmfw.{kind}" for kind in KINDS}
CODE = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)


def pages() -> list[Path]:
    """The Markdown files of the repository, not those of environments and caches."""
    found = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "validation").rglob("*.md")]
    return sorted(found)


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ +(.*)$", CODE.sub("", page.read_text(encoding="utf-8")), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page: Path) -> Iterator[str]:
    """Relative links that lead nowhere; those of news are read from the change log."""
    folder = ROOT if page.parent.name == "news" else page.parent
    for link in LINK.findall(CODE.sub("", page.read_text(encoding="utf-8"))):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        target = (folder / name).resolve() if name else page
        if not target.is_relative_to(ROOT) or not target.exists():
            yield f"{page.relative_to(ROOT)}: no file {link}"
        elif anchor and target.suffix == ".md" and anchor not in anchors(target):
            yield f"{page.relative_to(ROOT)}: no heading {link}"


def unknown_names(page: Path) -> Iterator[str]:
    """Names of mpmfw in backticks that cannot be imported."""
    for name in dict.fromkeys(NAME.findall(page.read_text(encoding="utf-8"))):
        if name not in GROUPS and not exists(name):
            yield f"{page.relative_to(ROOT)}: no name {name}"


def exists(name: str) -> bool:
    """Return True if a module, or an attribute below one, has this name."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for part in parts[length:]:
            if part in getattr(found, "__annotations__", {}):
                return True
            if not hasattr(found, part):
                return False
            found = getattr(found, part)
        return True
    return False


def main() -> int:
    """Print what is wrong; return how the process ends."""
    checked = pages()
    problems = [line for page in checked for check in (broken_links, unknown_names) for line in check(page)]
    print(*problems, f"{len(checked)} pages, {len(problems)} problems", sep="\n")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
