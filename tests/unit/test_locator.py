"""Lines of keys in TOML documents: written ones, and random nested ones."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.scene.locator import Locator, dotted
from mpmfw.scene.override import parse_path

DOCUMENT = '''\
title = "a [b] = { c # no comment"   # [no.table]
text = """
[not.a.table]
x = 1 \\"""
"""
literal = \'\'\'
y = 2\'\'\'

[grid]
cell_size = 0.4
lower = [
  0.0,   # ]
  -1.0,
]

[[contact.pairs]]
bodies = ["a", "b"]

[[contact.pairs]]
bodies = ["a", "c"]
friction = 0.1

[bodies.a]
geometry = { type = "disc", centre = [0, 0], nested = { deep = 1 } }
sides = [
  { side = "left", fixed = true },
  { side = "right", pressure = 1e5 },
]
particles.size = 1979-05-27T07:32:00Z
"odd key".'x.y' = "}"
'''


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("title",), 1),
        (("text",), 2),
        (("literal",), 6),
        (("grid", "lower", 1), 13),
        (("grid", "missing"), 9),
        (("contact", "pairs", 1, "friction"), 21),
        (("bodies", "a", "geometry", "nested", "deep"), 24),
        (("bodies", "a", "sides", 0, "fixed"), 26),
        (("bodies", "a", "odd key", "x.y"), 30),
    ],
)
def test_lines_of_a_written_document(path, line):
    tomllib.loads(DOCUMENT)
    assert Locator(DOCUMENT).line(path) == line


def test_windows_line_ends_count_once():
    assert Locator("a = 1\r\n\r\n[b]\r\nc = 2\r\n").lines["b", "c"] == 4


KEYS = st.text("ab_-1 .'é#=", min_size=1, max_size=4)
SCALARS = st.one_of(
    st.integers(-9, 9),
    st.booleans(),
    st.floats(allow_nan=False, allow_infinity=False),
    st.text("a\"\\[]{}#=,\n'", max_size=6),
)


class Rendering:
    """Renders nested values as TOML and notes the line of every key as it goes."""

    def __init__(self, spread):
        self.text, self.lines, self.spread = "", {}, spread

    @property
    def line(self):
        return self.text.count("\n") + 1

    def table(self, path, mapping):
        values = {k: v for k, v in mapping.items() if not isinstance(v, dict)}
        for key, value in values.items():
            self.lines[(*path, key)] = self.line
            self.text += f"  {dotted((key,))}  =  "
            self.value((*path, key), value)
            self.text += "  # [comment] = {\n"
        for key, value in mapping.items():
            if isinstance(value, dict):
                self.text += "\n"
                self.lines[(*path, key)] = self.line
                header = (*(part for part in path if isinstance(part, str)), key)
                self.text += f"[{dotted(header)}]\n"
                self.table((*path, key), value)

    def value(self, path, value):
        if isinstance(value, bool):
            self.text += str(value).lower()
        elif isinstance(value, str):
            self.text += f'"{value.translate(ESCAPES)}"'
        elif isinstance(value, list):
            self.entries(path, "[", "]", enumerate(value), "\n" if self.spread else " ")
        elif isinstance(value, dict):
            self.entries(path, "{", "}", value.items(), " ")
        else:
            self.text += repr(value)

    def entries(self, path, opening, closing, entries, gap):
        self.text += opening
        for k, (key, item) in enumerate(entries):
            self.text += (", " if k else "") + gap
            self.lines[(*path, key)] = self.line
            self.text += f"{dotted((key,))} = " if isinstance(key, str) else ""
            self.value((*path, key), item)
        self.text += gap + closing


ESCAPES = str.maketrans({'"': '\\"', "\\": "\\\\", "\n": "\\n"})
LISTS = st.recursive(
    SCALARS, lambda inner: st.lists(inner | st.dictionaries(KEYS, SCALARS, max_size=2), max_size=3)
)
DOCUMENTS = st.recursive(
    st.dictionaries(KEYS, LISTS, max_size=3),
    lambda inner: st.dictionaries(KEYS, inner | LISTS, max_size=3),
    max_leaves=8,
)


@settings(max_examples=150)
@given(document=DOCUMENTS, spread=st.booleans())
def test_every_key_of_a_random_document_is_on_its_line(document, spread):
    rendering = Rendering(spread)
    rendering.table((), document)
    assert tomllib.loads(rendering.text) == document
    assert Locator(rendering.text).lines == rendering.lines


@given(st.lists(KEYS, min_size=1, max_size=3), st.integers(0, 99))
def test_dotted_paths_are_read_back(keys, index):
    path = (keys[0], index, *keys[1:])
    assert parse_path(dotted(path)) == path
