"""What a study says: its rows, and the cheapest combination below an error."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.grid import in_words


def rows(dataset: xr.Dataset) -> Iterator[dict[str, Any]]:
    """One mapping for each combination: its labels, and every variable over the dimensions of the grid."""
    dims = list(dataset["status"].dims)
    names = [name for name in dataset.data_vars if dataset[name].dims == dataset["status"].dims]
    for labels in itertools.product(*(dataset[dim].values.tolist() for dim in dims)):
        one = dataset.sel(dict(zip(dims, labels, strict=True)))
        yield {
            **{str(dim): label for dim, label in zip(dims, labels, strict=True)},
            **{str(name): one[name].values.item() for name in names},
        }


def conclusions(dataset: xr.Dataset, under: float | None = None) -> list[str]:
    """One sentence for each problem of a study: the cheapest combination below an error.

    Parameters
    ----------
    dataset
        Of ``mpmfw.study``.
    under
        Relative error; the study's own by default.
    """
    limit = float(dataset.attrs["under"]) if under is None else under
    problems = json.loads(dataset.attrs["problem_dims"])
    text: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in rows(dataset):
        text.setdefault(tuple(row[dim] for dim in problems), []).append(row)
    return [
        _sentence(in_words(dict(zip(problems, problem, strict=True))), problems, found, limit)
        for problem, found in text.items()
    ]


def _sentence(problem: str, problems: list[str], found: list[dict[str, Any]], limit: float) -> str:
    begin = f"{problem}: the" if problem else "The"
    known = [row for row in found if row["status"] == "ok"]
    known = [row for row in known if np.isfinite(row["error"]) and np.isfinite(row["cpu_time"])]
    below = [row for row in known if row["error"] < limit]
    if not known:
        return f"{begin} error of no combination is known"
    dims = [dim for dim in known[0] if dim not in problems]
    if not below:
        best = min(known, key=lambda row: row["error"])
        return (
            f"{begin} error of no combination is under {percent(limit)} %; the least, "
            f"{percent(best['error'])} %, "
            f"has {_of(best, dims)}"
        )
    cheapest = min(below, key=lambda row: row["cpu_time"])
    spread = cheapest["cpu_time_spread"]
    noise = f" ± {spread:.2g} s" if np.isfinite(spread) else ""
    return (
        f"{begin} cheapest combination under {percent(limit)} % error is {_of(cheapest, dims)}, "
        f"{cheapest['cpu_time']:.3g} s{noise} of CPU time ({cheapest['timing']}; "
        f"error {percent(cheapest['error'])} %)"
    )


def percent(error: float) -> str:
    """A relative error in per cent, three digits."""
    return f"{100.0 * error:.3g}"


def _of(row: dict[str, Any], dims: list[str]) -> str:
    labels = itertools.takewhile(lambda dim: dim != "error", dims)
    return in_words({dim: row[dim] for dim in labels}) or "the only one"
