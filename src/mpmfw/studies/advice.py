"""What a choice says: its rows, the answer in a sentence, and what it took."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.studies.conclusion import percent
from mpmfw.studies.fitting import Interval
from mpmfw.studies.verdicts import interval_text

#: Verdicts, the best ones first.
_ORDER = ("measured", "predicted", "unsure", "out of reach", "not run", "failed")


def method_rows(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """One mapping for each method, the answer first, then what meets the target by cost, then the others by error."""
    names = [name for name in dataset.data_vars if dataset[name].dims == dataset["answer"].dims]
    found = [
        {"contact": str(one["contact"].item()), "shape": str(one["shape"].item())}
        | {str(name): one[name].values.item() for name in names}
        | {"pilots": " ".join(_pilots(one))}
        for one in _methods(dataset)
    ]

    def place(row: dict[str, Any]) -> tuple[Any, ...]:
        meets = row["verdict"] in _ORDER[:2]
        value = np.nan_to_num(row["cost"] if meets else row["predicted_error"], nan=np.inf)
        return not row["answer"], not meets, _ORDER.index(row["verdict"]) if not meets else 0, value

    return sorted(found, key=place)


def _methods(dataset: xr.Dataset) -> Iterator[xr.Dataset]:
    for i, j in itertools.product(range(dataset.sizes["contact"]), range(dataset.sizes["shape"])):
        yield dataset.isel(contact=i, shape=j)


def _pilots(one: xr.Dataset) -> Iterator[str]:
    """The errors of a method's runs in per cent, at falling cell sizes."""
    for k in range(one.sizes["cell_size"]):
        run = one.isel(cell_size=k)
        if run["status"].item() != "not run":
            error = run["error"].item()
            yield percent(error) if np.isfinite(error) else "–"


def advice(dataset: xr.Dataset) -> list[str]:
    """The answer, what errors are against, and what the pilots took, a sentence each."""
    target = f"{percent(dataset.attrs['target'])} %"
    rows, pilots = method_rows(dataset), float(dataset["cpu_time"].sum())
    best = next((row for row in rows if row["answer"]), None)
    took = f"The runs took {pilots:.3g} s of CPU time"
    if best is None:
        return [f"No method is certain to meet {target}: {_nearest(rows)}", *_against(dataset), took]
    measured = best["verdict"] == "measured"
    how = "measured, by a pilot" if measured else "predicted"
    others = (pilots - best["cost"] if measured else pilots) / best["cost"]
    share = f", those that are not the answer {max(others, 0.0):.2g} of what the answer costs"
    return [
        f"For {target}: {best['contact']}, {best['shape']}, cell_size {best['cell_size_needed']:.4g} m; error {_error(best)}, "
        f"{best['cost']:.3g} s of CPU time ({how})",
        *_against(dataset),
        took + share,
    ]


def _nearest(rows: list[dict[str, Any]]) -> str:
    known = [row for row in rows if np.isfinite(row["predicted_error"])]
    if not known:
        return "no run has an error"
    one = min(known, key=lambda row: float(row["predicted_error"]))
    return (
        f"the nearest is {one['contact']}, {one['shape']} with {_error(one)} at {one['cell_size_needed']:.4g} m; "
        "allow finer cells, name other methods, or ask for less"
    )


def _against(dataset: xr.Dataset) -> list[str]:
    slack = float(dataset.attrs["slack"])
    text = f"Error of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}"
    if slack > 0.0:
        text += f", which is itself off by about {percent(slack)} %: this is added to all bounds"
    return [text]


def _error(row: dict[str, Any]) -> str:
    return interval_text(Interval(row["predicted_error"], row["lower"], row["upper"]))
