"""Conclusions of a study: its rows, and the cheapest combination below an error."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.grid import in_words
from mpmfw.results.selection import points_of


def rows(dataset: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield labels and variables of each combination."""
    names = [name for name in dataset.data_vars if dataset[name].dims == dataset["status"].dims]
    for labels, run in points_of(dataset, dataset["status"].dims):
        yield labels | {str(name): run[name].values.item() for name in names}


def conclusions(dataset: xr.Dataset, under: float | None = None) -> list[str]:
    """Return for each problem of a study the cheapest combination below an error, by default the study's."""
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
            f"{percent(best['error'])} %, has {_of(best, dims)}"
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


def method_rows(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Return a row for each method: the answer, those that meet the target by cost, the others.

    ``pilots`` are errors [%] at falling cell sizes. The other columns are those of the cheapest run that
    meets the target, or of the best.
    """
    found = [_row(method) for _, method in points_of(dataset, ("contact", "shape"))]

    def place(row: Mapping[str, Any]) -> tuple[bool, bool, float]:
        value = row["cost"] if row["verdict"] == "meets" else row["error"]
        return not row["answer"], row["verdict"] != "meets", float(np.nan_to_num(value, nan=np.inf))

    return sorted(found, key=place)


def _row(method: xr.Dataset) -> dict[str, Any]:
    ran = method.isel(cell_size=np.flatnonzero(method["status"].values != "not run"))
    errors, costs = ran["error"].values, ran["cpu_time"].values
    row: dict[str, Any] = {"contact": str(method["contact"].item()), "shape": str(method["shape"].item())}
    row |= {"answer": bool(method["answer"].any()), "verdict": "not run" if not len(errors) else "failed"}
    row["pilots"] = " ".join(percent(error) if np.isfinite(error) else "–" for error in errors)
    row |= dict.fromkeys(("cell_size_needed", "error", "cost"), np.nan)
    row["status"] = str(ran["status"].values[-1]) if len(errors) else "not run"
    if np.isfinite(errors).any():
        able = ran["meets"].values
        best = int(np.nanargmin(np.where(able, costs, np.inf) if able.any() else errors))
        row["verdict"] = "meets" if able.any() else "misses"
        row["status"] = str(ran["status"].values[best])
        row |= {"cell_size_needed": float(ran["cell_size"][best]), "error": float(errors[best])}
        row["cost"] = float(costs[best])
    return row


def advice(dataset: xr.Dataset) -> list[str]:
    """Return the answer, the reference and the cost, one sentence each."""
    target, slack = f"{percent(dataset.attrs['target'])} %", float(dataset.attrs["uncertainty"])
    rows, took = method_rows(dataset), float(dataset["cpu_time"].sum())
    against = f"Error of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}"
    if 0.0 < slack < np.inf:
        against += f", which is uncertain by {percent(slack)} %: this is added to every error"
    cost = f"The runs took {took:.3g} s of CPU time"
    best = rows[0]
    if best["answer"]:
        return [
            f"For {target}: {best['contact']}, {best['shape']}, cell_size {best['cell_size_needed']:.4g} m; "
            f"error {percent(best['error'])} %, {best['cost']:.3g} s of CPU time",
            against,
            f"{cost}, {took / best['cost']:.2g} times that of the answer",
        ]
    return [f"Undecided for {target}: {_nearest(rows)}", against, cost]


def _nearest(rows: list[dict[str, Any]]) -> str:
    known = [row for row in rows if np.isfinite(row["error"])]
    if not known:
        return "no run has an error; the statuses say why"
    one = min(known, key=lambda row: float(row["error"]))
    return (
        f"the nearest is {one['contact']}, {one['shape']} with {percent(one['error'])} % at "
        f"{one['cell_size_needed']:.4g} m; allow finer cells, name other methods, or raise the target"
    )
