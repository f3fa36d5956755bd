"""Tables for other programs."""

from __future__ import annotations

import csv
import io
import json
import warnings

import pytest
from typer.testing import CliRunner

from mpmfw.cli.app import app
from mpmfw.errors import ResultsWarning

SCENE = "rolling-cylinder-slip"
SHORT = ["--set", "time.end=0.02", "--set", "time.output_interval=0.01", "--set", "settle.max_time=0.01"]


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Standard output of one comparison in both formats; the second takes the runs of the first."""
    path = tmp_path_factory.mktemp("compared") / "c.nc"
    found = {}
    for form in ("csv", "json"):
        asked = ["compare", SCENE, "--contact", "none,penalty", "--repeats", "1", "--force", *SHORT]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResultsWarning)  # the settling is cut short
            done = CliRunner().invoke(app, [*asked, "-o", str(path), "--format", form])
        assert done.exit_code == 0, done.output
        assert "all series and costs" in done.stderr
        found[form] = done.stdout
    return found


def test_csv_and_json_are_tables_of_the_same_rows(compared: dict[str, str]) -> None:
    rows = json.loads(compared["json"])
    lines = list(csv.DictReader(io.StringIO(compared["csv"])))
    assert [row["contact"] for row in rows] == [line["contact"] for line in lines] == ["none", "penalty"]
    assert all(row["status"] == "ok" and row["cpu_time"] > 0.0 for row in rows)
    for row, line in zip(rows, lines, strict=True):
        for key, value in row.items():
            assert line[key] == ("" if value is None else str(value))


def test_an_unknown_format_is_refused() -> None:
    done = CliRunner().invoke(app, ["compare", SCENE, "--format", "xml"])
    assert done.exit_code == 2
    assert "'xml' is not one of" in done.output
