"""Lines of keys in TOML documents: written ones, and random nested ones."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.scene.override import parse_path
from mpmfw.scene.problem import Locator, dotted
from mpmfw.scene.toml_text import toml_text

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
    assert Locator("a = 1\r\n\r\n[b]\r\nc = 2\r\n").line(("b", "c")) == 4


def test_a_header_is_the_line_of_its_table_although_a_part_stands_before():
    locator = Locator("[a.b]\nc = 1\n\n[a]\nd = 2\n")
    assert [locator.line(path) for path in [("a", "b"), ("a",), ("a", "d")]] == [1, 4, 5]


def test_nesting_beyond_the_stack_leaves_the_lines_before_it():
    locator = Locator("a = 1\nb = " + 5000 * "[" + 5000 * "]" + "\n")
    assert [locator.line(path) for path in [("a",), ("b",)]] == [1, 1]


KEYS = st.text("ab_-1 .'é#=", min_size=1, max_size=4)
SCALARS = st.one_of(st.none(), st.booleans(), st.text("a\"\\[]{}#=,\n'", max_size=6))
LISTS = st.recursive(SCALARS, lambda inner: st.lists(inner | st.dictionaries(KEYS, SCALARS), max_size=3))
DOCUMENTS = st.recursive(
    st.dictionaries(KEYS, LISTS, max_size=3),
    lambda inner: st.dictionaries(KEYS, inner | LISTS, max_size=3),
    max_leaves=8,
)


def numbered(value, path, numbers):
    """The same with a number of its own for each None, which is noted with its place."""
    if isinstance(value, dict):
        return {key: numbered(each, (*path, key), numbers) for key, each in value.items()}
    if isinstance(value, list):
        return [numbered(each, (*path, k), numbers) for k, each in enumerate(value)]
    return value if value is not None else numbers.setdefault(path, 10**6 + len(numbers))


@settings(max_examples=150)
@given(document=DOCUMENTS, spread=st.booleans())
def test_every_key_of_a_random_document_is_on_its_line(document, spread):
    """Lists over many lines where ``spread``."""
    numbers = {}
    document = numbered(document, (), numbers)
    text = toml_text(document)
    if spread:
        text = text.replace(" = [1000", " = [ # ]\n\n1000")
    assert tomllib.loads(text) == document
    lines = {path: text[: text.index(str(number))].count("\n") + 1 for path, number in numbers.items()}
    locator = Locator(text)
    assert {path: locator.line(path) for path in lines} == lines


@given(st.lists(KEYS, min_size=1, max_size=3), st.integers(0, 99))
def test_dotted_paths_are_read_back(keys, index):
    path = (keys[0], index, *keys[1:])
    assert parse_path(dotted(path)) == path
