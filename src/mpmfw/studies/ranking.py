"""Ranking of methods: how many problems each solves to an error, and at what relative cost."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from mpmfw.campaigns.judging import said
from mpmfw.errors import SceneError
from mpmfw.plugin.measure import About
from mpmfw.results import check_results
from mpmfw.results.reading import read
from mpmfw.results.selection import series_of
from mpmfw.studies.conclusion import rows

#: Relative errors that a method may reach; those of other quantities than the error are the same numbers.
LEVELS = (0.10, 0.05, 0.02, 0.01, 0.005)
#: Quantities of a study, with what they mean; all are relative.
QUANTITIES = {
    "error": "error of the study's quantity",
    "noise": "high-frequency share of the contact force",
    "penetration": "deepest penetration, in cells",
    "energy": "error of strain and contact energy, relative to the energy put in",
    "dissipation": "energy put in that is neither kinetic, strain, friction nor plastic work at the end",
    "momentum": "change of total momentum, relative to the bodies' initial momenta",
}


#: Quantities that are not ratios, and the unit of their levels.
UNITS = {"penetration": "cells"}


def rank(
    results: Iterable[str | os.PathLike[str] | xr.Dataset],
    by: str = "contact",
    levels: Sequence[float] = LEVELS,
    about: Mapping[str, str] | None = None,
) -> xr.Dataset:
    """Rank methods by the cost, at their best settings, of bringing a quantity below a level.

    A problem is a scene of a study. A method is a label without its options. Options, shape function and cell
    size are settings; the cheapest settings that reach a level count. For quantities other than the error
    only runs count whose error is below the first level.

    Parameters
    ----------
    results
        Files or datasets of ``mpmfw.study``; several of one study are joined.
    by
        Dimension of the methods.
    levels
        Relative errors, falling.
    about
        ``body``, ``pair`` and ``axis`` that the errors must be of; a study of another one is refused.

    Returns
    -------
    xarray.Dataset
        ``cost`` [s], CPU time of the cheapest run, and ``over_best`` [1], the same over the cheapest
        method's, by (quantity, problem, level, ``by``), NaN where the level is not reached; ``best`` (…) the
        settings of that run; ``ran`` (problem, ``by``). Attributes: ``failures``, runs that do not count;
        ``errors``, the quantity of the errors.

    Raises
    ------
    SceneError
        A file does not hold a study, has no dimension ``by``, or no run has an error and a cost.
    """
    if not levels or min(levels) <= 0.0 or list(levels) != sorted(set(levels), reverse=True):
        text = ", ".join(map(str, levels)) or "none"
        raise SceneError(f"levels {text}: expected relative errors that fall, as 0.1, 0.01")
    studies = [_study(one, by, about or {}) for one in results]
    found = pd.DataFrame([row for one in studies for row in _runs(one, by)])
    judged = found
    if len(found):
        finite = np.isfinite(found[["error", "cpu_time"]].astype(float)).all(axis=1)
        judged = found[finite & (found["status"] == "ok")]
    if judged.empty:
        raise SceneError("nothing to rank: no run has an error and a cost")
    problems, methods = (found[key].unique().tolist() for key in ("problem", by))
    sound = judged[judged["error"] <= levels[0]]
    reached = [
        runs[runs[name].abs() <= level].assign(quantity=name, level=level)
        for name, runs in {name: judged if name == "error" else sound for name in QUANTITIES}.items()
        if name in runs
        for level in levels
    ]
    dims = ["quantity", "problem", "level", by]
    cheapest = pd.concat(reached).sort_values("cpu_time", kind="stable").drop_duplicates(dims)
    table = cheapest.set_index(dims)[["cpu_time", "settings"]].to_xarray()
    coords = {"quantity": list(QUANTITIES), "problem": problems, "level": list(levels), by: methods}
    table = table.reindex(coords).assign_coords(
        unit=("quantity", [UNITS.get(name, "%") for name in QUANTITIES])
    )
    cost, ran = table["cpu_time"], pd.crosstab(found["problem"], found[by]).loc[problems, methods] > 0
    over_best, best = cost / cost.min(by), table["settings"].astype(object).fillna("")
    reaches = "CPU time of the cheapest run that reaches the level"
    has_runs = {"long_name": "whether a study has runs of the method for the problem"}
    ranking = xr.Dataset(
        {
            "cost": cost.assign_attrs(long_name=reaches, units="s"),
            "over_best": over_best.assign_attrs(long_name="the same over the cheapest method's", units="1"),
            "best": best.assign_attrs(long_name="settings of that run"),
            "ran": (("problem", by), ran.values, has_runs),
        }
    )
    failed = found[found["status"] != "ok"].rename(columns={by: "method"})
    failures = failed[["problem", "method", "settings", "status"]].to_dict("records")
    errors = "; ".join(dict.fromkeys(map(_error_of, studies)))
    ranking.attrs = {"kind": "ranking", "by": by, "errors": errors, "failures": json.dumps(failures)}
    return ranking


def _study(given: str | os.PathLike[str] | xr.Dataset, by: str, about: Mapping[str, str]) -> xr.Dataset:
    if isinstance(given, xr.Dataset):
        dataset, file = given, "dataset"
    else:
        check_results(given)
        dataset, file = series_of(read(given)), str(given)
    if dataset.attrs.get("kind") != "study" or "status" not in dataset:
        raise SceneError(f"{file}: expected the results of a study, mpmfw study STUDY -o FILE.nc")
    if by not in dataset["status"].dims:
        varied = ", ".join(map(str, dataset["status"].dims))
        raise SceneError(f"{file}: the study does not vary '{by}'; it varies {varied}")
    known = _about(dataset)
    for key, name in about.items():
        if getattr(known, key) != name:
            raise SceneError(f"{key} {name}: {file} has the error of {_error_of(dataset)}")
    return dataset


def _error_of(dataset: xr.Dataset) -> str:
    return said(dataset.attrs.get("quantity", ""), _about(dataset))


def _about(dataset: xr.Dataset) -> About:
    try:
        return About(**json.loads(dataset.attrs.get("about", "{}")))
    except (TypeError, ValueError):
        return About()


def _runs(dataset: xr.Dataset, by: str) -> Iterator[dict[str, Any]]:
    problem_dims = json.loads(dataset.attrs["problem_dims"])
    settings = [str(dim) for dim in dataset["status"].dims if dim not in (*problem_dims, by)]
    for row in rows(dataset):
        label, _, options = str(row[by]).partition("(")
        where = ", ".join(str(row[dim]) for dim in problem_dims)
        named = [
            f"({options}" if options else "",
            *(f"{dim} {row[dim]:g}" if isinstance(row[dim], float) else str(row[dim]) for dim in settings),
        ]
        yield {
            **row,
            "problem": ": ".join(part for part in (dataset.attrs["title"], where) if part),
            by: label,
            "settings": " ".join(part for part in named if part),
        }


def summary(ranking: xr.Dataset, quantity: str) -> list[dict[str, Any]]:
    """Return one row a method, the largest share first; ``over best`` is a median, ``cheapest`` how often."""
    by, one = ranking.attrs["by"], ranking.sel(quantity=quantity)
    unit, scale = UNITS.get(quantity, "%"), 1.0 if quantity in UNITS else 100.0
    labels = {level: f"{scale * level:g} {unit}" for level in one["level"].values.tolist()}
    table = []
    for name in one[by].values.tolist():
        ratio = one["over_best"].sel({by: name})
        known = ratio.values[np.isfinite(ratio.values)]
        row = {"method": name, "problems": int(ranking["ran"].sel({by: name}).sum())}
        for level, label in labels.items():
            row[label] = int(ratio.sel(level=level).notnull().sum())
        row["over best"] = float(np.median(known)) if len(known) else np.nan
        table.append(row | {"cheapest": int((known <= 1.0).sum())})

    def place(row: dict[str, Any]) -> tuple[float, float]:
        share = sum(row[label] for label in labels.values()) / max(row["problems"], 1)
        return -share, float(np.nan_to_num(row["over best"], nan=np.inf))

    return sorted(table, key=place)
