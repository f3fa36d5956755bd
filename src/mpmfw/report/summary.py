"""Summarize a result in a few plain sentences."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.errors import is_complete
from mpmfw.report.differences import Difference
from mpmfw.report.table import column_of, shown
from mpmfw.results.analysis import ROUND_OFF


def of_comparison(
    rows: list[dict[str, Any]], labels: list[str], methods: list[str], found: list[Difference]
) -> list[str]:
    """Return sentences on the runs, the largest difference, and the errors.

    ``rows`` are those of :func:`mpmfw.report.table`, ``labels`` its columns of methods, ``methods`` the names
    of the values in ``found``.
    """
    failed = [row for row in rows if not is_complete(row["status"])]
    count = f"{len(rows)} runs" if len(rows) > 1 else "One run"
    sentences = [f"{count}; {len(failed)} did not reach the end." if failed else f"{count}, all complete."]
    if found and found[0].spread > ROUND_OFF:
        first = found[0]
        values = first.values.ravel()
        low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
        sentences.append(
            f"The methods differ most in “{first.quantity}”: from {values[low]:.3g} ({methods[low]}) to "
            f"{values[high]:.3g} {first.unit} ({methods[high]}). That is {100 * first.spread:.3g} % "
            f"of the {first.against}."
        )
    elif len(rows) > 1:
        sentences.append("The methods do not differ: all differences are within round-off.")
    names = [name for name in rows[0] if name.endswith("_error")]
    for name in names[:3]:
        known = [row for row in rows if np.isfinite(row.get(name, np.nan))]
        if known:
            known.sort(key=lambda row: abs(row[name]))
            ends = [f"{shown(row[name], column_of(name))} % ({_method(row, labels)})" for row in known]
            text = ends[0] if len(known) == 1 else f"least {ends[0]}, largest {ends[-1]}"
            sentences.append(f"{column_of(name).heading}: {text}.")
    return sentences


def of_run(series: xr.Dataset, attributes: Mapping[Any, Any]) -> list[str]:
    """Return sentences on the end, the motion and the contact of one run."""
    cost = f" It took {float(attributes['cpu_time']):.3g} s of CPU time." if "cpu_time" in attributes else ""
    methods = ", ".join(str(attributes[name]) for name in ("contact", "shape") if attributes.get(name))
    sentences = [f"{methods}: the run ended with the status {attributes.get('status', 'unknown')}.{cost}"]
    if "centre_of_mass" in series:
        moved = series["centre_of_mass"] - series["centre_of_mass"].isel(time=0)
        size = ((moved**2).sum("axis", skipna=False) ** 0.5).max("time")
        if np.isfinite(size).any():
            body = size.idxmax("body").item()
            sentences.append(f"The body {body} moved farthest, by {float(size.max()):.3g} m.")
    if "contact_force" in series and series.sizes.get("pair"):
        force = (series["contact_force"].fillna(0.0) ** 2).sum("axis") ** 0.5
        unit = str(series["contact_force"].attrs.get("units", "N")).replace(" m-1", "/m")
        pair, most = force.max("time").idxmax("pair").item(), float(force.max())
        time = float(force.sel(pair=pair).idxmax("time"))
        text = f"The largest contact force is {most:.3g} {unit}, of {pair} at {time:.3g} s."
        sentences.append(text if most > 0.0 else "There was no contact force.")
    return sentences


def _method(row: dict[str, Any], labels: list[str]) -> str:
    return ", ".join(str(row[label]) for label in labels)
