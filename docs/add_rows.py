"""Put cases that ran after the rest of the suite into the page of validation and its tables:
``mpmfw validate CASE -o FOLDER && python docs/add_rows.py FOLDER/validation.csv``.

Rows of these cases replace earlier ones, all others stay; the page says which cases ran later."""

from __future__ import annotations

import csv
import re
import sys
from pathlib import Path

import pandas as pd

from mpmfw.validation import page

PAGE = Path(__file__).parent / "validation.md"


def read(path: Path) -> dict[str, list[dict[str, object]]]:
    """Return the rows of each case in a table of the suite."""
    cases: dict[str, list[dict[str, object]]] = {}
    with path.open(newline="", encoding="utf-8") as file:
        for one in csv.DictReader(file):
            numbers = {name: float(one[name] or "nan") for name in ("value", "least", "most", "seconds")}
            cases.setdefault(one["case"], []).append({**one, **numbers})
    return cases


def main() -> None:
    """Replace the rows of the cases in the given tables; write the page anew."""
    folder = PAGE.with_suffix("")
    rows = read(folder / "rows.csv")
    later = {case: own for path in sys.argv[1:] for case, own in read(Path(path)).items()}
    rows |= later
    text = PAGE.read_text(encoding="utf-8")
    command = re.search(r"^Written by (.*?), Python ", text, re.M)[1]
    before, _, earlier = command.partition("; later `mpmfw validate ")
    cases = sorted({*earlier.rstrip("`").split(), *later})
    command = f"{before}; later `mpmfw validate {' '.join(cases)}`" if cases else before
    page.write_page([row for case in sorted(rows) for row in rows[case]], PAGE, command)
    gates = pd.read_csv(folder / "gates.csv", keep_default_na=False, dtype=str)
    softer = {tuple(one[:3]): one[3:6] for one in gates.to_numpy().tolist()}  # with κ = 1
    new = [
        (*(key := (row["case"], row["method"], row["quantity"])), *softer.get(key, ("", "", "")),
         f"{row['least']:g} … {row['most']:g}", f"{row['value']:.4g} {row['unit']}".rstrip(), row["verdict"])
        for own in later.values() for row in own if row["verdict"] in page.GATES
    ]  # fmt: skip
    gates = pd.concat([gates[~gates["case"].isin(later)], pd.DataFrame(new, columns=gates.columns)])
    gates.sort_values("case", kind="stable").to_csv(folder / "gates.csv", index=False)


if __name__ == "__main__":
    main()
