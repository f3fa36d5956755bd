"""Report the words and the long sentences of each page: ``python docs/sentences.py``. It decides nothing.

Words are those of the text by hand: without code, formulas, tables, and what is generated."""

from __future__ import annotations

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from check import ROOT, pages

#: Words of the longest sentence that is not counted as long.
LONGEST = 35
GENERATED = re.compile(r"docs/(hooks\.md|auto/|news/|plugin-template|shape-template)|CHANGELOG")
LEFT_OUT = re.compile(
    r"^```.*?^```|^:::.*?^:::|\$\$.*?\$\$.*?$|<!--.*?-->|^\|.*?$|^#.*?$|^!\[.*?\]\(.*?\)", re.S | re.M
)


def text_of(page: Path) -> str:
    """Return the sentences of a page, with a word for each piece of code and each formula."""
    text = page.read_text(encoding="utf-8")
    text = re.sub(r"<!-- mpmfw validate: begin.*?end -->", "", text, flags=re.S)
    text = re.sub(r"`[^`]*`|\$[^$]*\$", "x", LEFT_OUT.sub("\n\n", text))
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"^\s*([-*]|\d+\.) |^: ", "\n\n", text, flags=re.M)


def sentences(text: str) -> list[int]:
    """Return the number of words of each sentence."""
    ends = re.split(r"(?<=[.!?])[)\"*]*\s+(?=[A-Z`\"(*\[x])|\n\s*\n", text)
    return [count for end in ends if (count := len(re.findall(r"[^\W\d_][\w'’-]*", end)))]


def main() -> None:
    """Print a line for each page, the longest first, and the sums."""
    rows = []
    for page in pages():
        name = page.relative_to(ROOT).as_posix()
        if not GENERATED.search(name):
            counts = sentences(text_of(page))
            rows.append((sum(counts), sum(count > LONGEST for count in counts), len(counts), name))
    for words, long, count, name in sorted(rows, reverse=True):
        print(f"{words:6d} words, {long:3d} of {count:4d} sentences above {LONGEST} words: {name}")
    words, long, count = (sum(column) for column in list(zip(*rows, strict=True))[:3])
    print(
        f"{words} words in {len(rows)} pages, {100 * long / count:.1f} % of sentences above {LONGEST} words"
    )


if __name__ == "__main__":
    main()
