"""Mutants of scenes: what slips and ill will make of a valid one, each from a number alone."""

import random
import re

from seeds import seeds

#: Numbers at which arithmetic, counting or memory end.
_NUMBERS = (
    "0", "-0.0", "-1", "1", "2", "3", "1e-300", "5e-324", "1e300", "1e308", "-1e308", "1e60", "1e-60", "1e59", "1e-59",  # noqa: E501
    "inf", "-inf", "nan", "1e16", "1e-16", "1e9", "1e-9", "1000", "400", "0.001", "1e-6", "1e6", "1e20", "1e-12",  # noqa: E501
    "9223372036854775808", "1" + "0" * 400, "true", "false", "0x10", "1_000.5", "1979-05-27", "07:32:00",
)  # fmt: skip

#: Texts that are read as something, or that break what reads them.
_TEXTS = (
    '""', '" "', '"1 m"', '"1 mm"', '"1 s"', '"((((1"', '"1/0 m"', '"1 m / 0"', '"1 m^99"', '"1e400 m"', '"nan m"', '"5 %"',  # noqa: E501
    '"1 MPa"', '"0.5 cells"', '"1e300 cells"', '"0 cells"', '"-1 cells"', '"1 2 m"', '"__import__(\'os\').abort()"',  # noqa: E501
    '"{0.__class__}"', '"${HOME}"', '"$(touch pwned)"', '"../../pwned"', '"/etc/passwd"', '"\\u0000"', '"a\\u0000b"',  # noqa: E501
    '"<script>alert(1)</script>"', '"\\u202e"', '"é"', '"free"', '"auto"', '"penalty"', '"cpdi2"', '"none"', '"x"',  # noqa: E501
    '"pwned:X"', '"nodes+pwned:X"', '"pwned:X(a = 1)"', '"antigravity:X"',
    '"a/b"', '"time"', "'''\n'''", '"' + "9" * 3000 + '"', '"' + "x" * 100_000 + '"',
)  # fmt: skip

_TABLES = (
    "[]", "[[]]", "{}", "{ type = 'disc' }", "{ type = 'mesh', path = '../../pwned' }", "{ type = 'mesh', path = '/dev/zero' }",  # noqa: E501
    "{ type = 'mesh', path = '/etc/passwd' }", "{ type = 'mesh', path = \"a\\u0000b\" }",
    "{ type = 'box', lower = [0, 0, 0], upper = [1, 1, 1] "
    "}", "{ type = 'disc', centre = [0.5, 0.5], radius = 1e-3 }",
    "{ type = 'polygon', points = [[0, 0], [1, 1], [1, 0], [0, 1]] }",
    "{ type = 'pwned:X' }", "{ method = 'pwned:X' }", "{ model = 'pwned:X' }",
    "[1]", "[1, 2]", "[1, 2, 3]", "[1, 2, 3, 4]",
    "[0.3, 0.2]", "[[0, 0, 0], [0, 0, 0]]", "[true, 'free']", "[nan, inf]", "[1e300, -1e300]", "['x', 'x']", "['1 m', '1 s']",  # noqa: E501
    "[{ side = 'left', fixed = true }, { side = 'right', velocity = [1e5, 'free'] }]",
    "[{ side = 'left', fixed = true }, { side = 'left', velocity = [1, 0] "
    "}]", "[" * 60 + "]" * 60, "[" * 500 + "]" * 500,
    "{ a = " * 50 + "1" + " }" * 50,
)  # fmt: skip

_KEYS = (
    *("a", "lower", "upper", "velocity", "size", "method", '""', '"a b"', '"\\u0000"', "options"),
    *("__class__", "a.b.c"),
)

_VALUE = re.compile(
    r"(?<== )(?:\"[^\"\n]*\"|[^\s,\[\]{}]+)|(?<=[\[ ])(?:\"[^\"\n]*\"|-?[0-9][0-9.e+-]*)(?=[,\]])"
)
_LINE = re.compile(r"(?m)^(\w+) = (.*)$")
_KEY = re.compile(r"\b\w+(?= = )")


def mutant(number):
    """The mutant of that number, always the same one."""
    # The sequence of random.Random does not depend on the platform or the version of Python
    draw = random.Random(f"mpmfw mutant {number}")
    _, text = draw.choice(seeds())
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        text = draw.choice(_MUTATIONS)(draw, text)
    return text


def _replace(draw, text, pattern, new, group=0):
    """Put what ``new`` draws in the place of one match of a pattern, or of a group of it."""
    found = draw.choice(list(pattern.finditer(text)) or [None])
    return text if found is None else text[: found.start(group)] + new() + text[found.end(group) :]


def _replace_value(draw, text):
    """Put another value in the place of one."""
    pools = (_NUMBERS, _NUMBERS, _TEXTS, _TABLES)
    return _replace(draw, text, _VALUE, lambda: draw.choice(draw.choice(pools)))


def _replace_entry(draw, text):
    """Put another value in the place of all that stands right of an equals sign."""
    pools = (_NUMBERS, _TEXTS, _TABLES)
    return _replace(draw, text, _LINE, lambda: draw.choice(draw.choice(pools)), 2)


def _rename_key(draw, text):
    return _replace(draw, text, _KEY, lambda: draw.choice(_KEYS))


def _scale_number(draw, text):
    """Shift the decimal point of a number, as where millimetres were meant, or turn its sign."""
    numbers = [found for found in _VALUE.finditer(text) if re.fullmatch(r"-?[0-9][0-9.e+-]*", found.group())]
    if not numbers:
        return text
    found = draw.choice(numbers)
    try:
        value = float(found.group()) * draw.choice((1e3, 1e-3, 10.0, 0.1, -1.0, 2.0, 0.5, 1.1, 1e6, 1e-6))
    except ValueError:
        return text
    return text[: found.start()] + repr(value) + text[found.end() :]


def _drop_line(draw, text):
    lines = text.splitlines(keepends=True)
    del lines[draw.randrange(len(lines))]
    return "".join(lines)


def _repeat_line(draw, text):
    lines = text.splitlines(keepends=True)
    lines.insert(draw.randrange(len(lines)), draw.choice(lines))
    return "".join(lines)


def _add_line(draw, text):
    lines = text.splitlines(keepends=True)
    value = draw.choice(draw.choice((_NUMBERS, _TEXTS, _TABLES)))
    lines.insert(draw.randrange(len(lines)), f"{draw.choice(_KEYS)} = {value}\n")
    return "".join(lines)


def _cut(draw, text):
    """Break off, as a file does that was cut short."""
    return text[: draw.randrange(len(text))]


def _change_character(draw, text):
    at = draw.randrange(len(text))
    return text[:at] + draw.choice("[]{}\"'=.,#\n\0\x7f\ufeff0-e\\") + text[at + 1 :]


_MUTATIONS = (
    *[_replace_value] * 5,
    *[_scale_number] * 5,
    *[_replace_entry] * 2,
    _drop_line,
    _repeat_line,
    _rename_key,
    _add_line,
    _cut,
    _change_character,
)
