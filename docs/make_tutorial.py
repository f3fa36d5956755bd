"""Run the tutorial as its reader does, and draw its figures: ``python docs/make_tutorial.py``.

Blocks of the page are taken in their order: ``sh`` blocks are commands of mpmfw, ``toml`` blocks are files
named by their first line, ``python`` blocks are executed. A ``text`` block quotes the output of the block
before it; ``…`` at the end of a quoted line stands for what differs between computers. Only the installation
is not run."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mpmfw.cli.app import app

PAGE = Path(__file__).parent / "tutorial" / "ten-minutes.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FIGURE = re.compile(r"!\[[^\]]*\]\(([\w-]+\.png)\)")
#: What a reader types before mpmfw is there.
INSTALLATION = ("git clone ", "cd mpmfw", "python3 -m venv ", ". .venv/bin/activate", "pip install ")


def run_page(folder: Path) -> list[tuple[str, str]]:
    """Run all blocks in ``folder``; return the quoted lines that were not printed, each with what was."""
    missing: list[tuple[str, str]] = []
    printed, names = "", {"__name__": "tutorial"}
    with contextlib.chdir(folder):
        for kind, text in BLOCK.findall(PAGE.read_text(encoding="utf-8")):
            if kind == "text":
                missing += [(line, printed) for line in text.splitlines() if not is_quoted(line, printed)]
            elif kind == "toml":
                Path(text.partition("\n")[0].removeprefix("#").strip()).write_text(text, encoding="utf-8")
            else:
                printed = output_of(kind, text, names)
    return missing


def is_quoted(line: str, printed: str) -> bool:
    """Return True if a quoted line is a printed one, up to spaces and to ``…``."""
    quoted, cut, _ = " ".join(line.split()).partition(" …")
    lines = [" ".join(one.split()) for one in printed.splitlines()]
    return any(one.startswith(quoted) if cut else one == quoted for one in lines)


def output_of(kind: str, text: str, names: dict[str, Any]) -> str:
    """What a block of commands or of Python prints."""
    caught = io.StringIO()
    with contextlib.redirect_stdout(caught), contextlib.redirect_stderr(caught):
        if kind == "python":
            exec(compile(text, str(PAGE), "exec"), names)
        else:
            for command in commands(text):
                # without standalone mode the exit status is what the call returns
                status = app(command[1:], prog_name="mpmfw", standalone_mode=False)
                assert status in (None, 0), f"exit status {status}: mpmfw {shlex.join(command[1:])}"
    return caught.getvalue()


def commands(text: str) -> Iterator[list[str]]:
    """The commands of a block, as words; those of the installation are left out."""
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if words and not line.startswith(INSTALLATION):
            assert words[0] == "mpmfw", f"expected a command of mpmfw, not: {line}"
            yield words


def main() -> None:
    """Run the page, and put the figures that it shows beside it."""
    os.environ.setdefault("COLUMNS", "120")
    with tempfile.TemporaryDirectory() as folder:
        for line, printed in run_page(Path(folder)):
            print(f"not printed: {line}\n{printed}")
        for name in FIGURE.findall(PAGE.read_text(encoding="utf-8")):
            shutil.copy(Path(folder) / name, PAGE.with_name(name))


if __name__ == "__main__":
    main()
