"""Tables lose no text at 80 columns, and the texts of options become values."""

import pytest

from mpmfw.cli.arguments import variations
from mpmfw.cli.tables import formatted, print_table
from mpmfw.errors import SceneError


@pytest.mark.parametrize("columns", [40, 80, 200])
@pytest.mark.parametrize("count", [3, 12])
def test_every_number_survives_every_width(capsys, monkeypatch, columns, count):
    monkeypatch.setenv("COLUMNS", str(columns))
    row = {"contact": "bardenhagen", **{f"quantity_{k}": -1.2345678e-5 * (k + 1) for k in range(count)}}
    rows = [
        row,
        {**row, "contact": "none", "status": "failed: " + "a long reason " * 8, "empty": float("nan")},
    ]
    print_table(rows, labels=("contact",), words=("status",))
    printed = capsys.readouterr().out
    assert all(printed.count(formatted(row[f"quantity_{k}"])) == 2 for k in range(count))
    assert "…" not in printed
    assert "empty" not in printed
    assert max(map(len, printed.splitlines())) <= columns
    assert printed.count("reason") == 8


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("grid.cell_size=0.4,0.2", [0.4, 0.2]),
        ("grid.cell_size=2 mm, 1 mm", ["2 mm", "1 mm"]),
        ("bodies.a.velocity=[1,0],[2,0]", [[1, 0], [2, 0]]),
        ("stepping.scheme=usl,musl", ["usl", "musl"]),
        ("output.gap=true,false", [True, False]),
    ],
)
def test_varied_values(text, values):
    assert list(variations([text]).values()) == [values]


@pytest.mark.parametrize("text", ["grid.cell_size=", "grid.cell_size=1,,2", "=1"])
def test_empty_values_are_refused(text):
    with pytest.raises(SceneError, match="--vary"):
        variations([text])
