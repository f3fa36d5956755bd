"""One self-contained page of a run or a comparison: what differs most, in sentences, pictures and tables."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment
from markupsafe import Markup
from matplotlib.figure import Figure

from mpmfw.errors import SceneError, is_complete
from mpmfw.plots import figures_of
from mpmfw.plots.style import at_last, drawn_reference, journal_style
from mpmfw.report.pictures import field_differences, slides
from mpmfw.report.table import CHOICES, COLUMNS, COSTS, column_of, meaning_of, method_dims, shown, table
from mpmfw.results.analysis import GAP_ROUND_OFF, ROUND_OFF, energy_sums, without_round_off
from mpmfw.results.references import described
from mpmfw.results.replacing import replace_bytes
from mpmfw.results.selection import Results, opened, points_of, series_of
from mpmfw.results.stored_scene import cell_size
from mpmfw.state.fields import FloatArray


@dataclass(frozen=True)
class Difference:
    """A quantity at the end of the runs."""

    quantity: str  #: with its body or pair
    unit: str
    values: FloatArray  #: (contact, shape); NaN for a run that did not end
    scale: float  #: reference size of a difference, in the same unit
    against: str  #: name of the scale

    @property
    def spread(self) -> float:
        """Largest minus smallest value, over the scale."""
        known = self.values[np.isfinite(self.values)]
        return float(np.ptp(known) / self.scale) if len(known) > 1 and self.scale > 0.0 else 0.0


def differences(dataset: xr.Dataset) -> list[Difference]:
    """Return final quantities, those in which methods differ most first."""
    last = at_last(without_round_off(dataset))
    return sorted(_quantities(last), key=lambda one: -one.spread)


def _unit(whole: str, array: xr.DataArray) -> str:
    """Return the unit, per metre if that of the ``array`` is."""
    return f"{whole}/m" if array.attrs.get("units", "").endswith(" m-1") else whole


def _quantities(runs: xr.Dataset) -> Iterator[Difference]:
    if "centre_of_mass" in runs:
        centre, velocity = runs["centre_of_mass"], runs["mean_velocity"]
        moved = centre - centre.isel(time=0)
        yield from _each("displacement", "m", moved, moved.isel(time=-1), "largest displacement of any body")
        yield from _each("velocity", "m/s", velocity, velocity.isel(time=-1), "largest velocity of any body")
        if "angular_velocity" in runs:
            spin = runs["angular_velocity"]
            yield from _each("spin", "rad/s", spin, spin.isel(time=-1), "largest spin of any body")
    if "kinetic_energy" in runs and "strain_energy" in runs:
        yield from _energies(runs, _unit("J", runs["kinetic_energy"]))
    if "contact_force" in runs:
        steps = xr.DataArray(np.diff(runs["time"], prepend=runs["time"][:1]), {"time": runs["time"]})
        impulse = (runs["contact_force"].fillna(0.0) * steps).sum("time")
        end = impulse.where(_ended(runs))
        yield from _each(
            "impulse", _unit("N s", runs["contact_force"]), impulse, end, "largest impulse of any pair"
        )
    if "min_gap" in runs:
        h, depth = cell_size(runs), (-runs["min_gap"]).clip(min=0.0).fillna(0.0).max("time")
        depth = depth.where(depth >= GAP_ROUND_OFF * h, 0.0).where(_ended(runs) & ~_of_codes(runs))
        yield from _each("largest penetration", "m", h, depth, "a cell")


def _each(
    what: str, unit: str, scale: xr.DataArray | float, end: xr.DataArray, against: str
) -> Iterator[Difference]:
    """Yield a quantity at the end of the runs; its scale is a number or the largest of the values
    ``scale``."""
    size = scale if isinstance(scale, float) else _largest(scale)
    dims = [dim for dim in end.dims if dim not in ("contact", "shape")]
    for labels, one in points_of(end.to_dataset(name="end"), dims):
        owner, *axis = labels.values()
        values = one["end"].transpose("contact", "shape").values.astype(float)
        yield Difference(", ".join([f"{owner}: {what}", *axis]), unit, values, size, against)


def _energies(runs: xr.Dataset, unit: str) -> Iterator[Difference]:
    own, sums = ~_of_codes(runs), energy_sums(runs)
    scale = _largest(sums["kinetic_energy"] + sums["strain_energy"])
    for name, energy in sums.items():
        words = "dissipated by contact" if name == "dissipated_energy" else name.replace("_", " ")
        last = energy.isel(time=-1)
        last = last.where(own) if name == "dissipated_energy" else last
        end = last.transpose("contact", "shape").values
        yield Difference(words, unit, end, scale, "largest kinetic and strain energy")


def _largest(array: xr.DataArray) -> float:
    size = np.abs(array.values[np.isfinite(array.values)])
    return float(size.max(initial=0.0))


def _ended(runs: xr.Dataset) -> xr.DataArray:
    status = runs["status"]
    return status.copy(data=np.vectorize(is_complete, otypes=[bool])(status.values))


def _of_codes(runs: xr.Dataset) -> xr.DataArray:
    """Return True for runs of other codes, which measure neither gaps nor works."""
    return runs["code"] != "" if "code" in runs else xr.zeros_like(runs["status"], dtype=bool)


def summary_of_comparison(
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


def summary_of_run(series: xr.Dataset, attributes: Mapping[Any, Any]) -> list[str]:
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


#: Rows of the table of differences, and the least difference that has one.
_MOST_DIFFERENCES, _LEAST_SPREAD = 15, 1e-3


def write_report(results: Results, path: str | os.PathLike[str]) -> None:
    """Write a run or a comparison as one HTML page that needs no network.

    A SceneError says if the results hold neither.
    """
    with opened(results) as found:
        dataset = series_of(found)
        if isinstance(found, xr.DataTree):
            parts = _run(found, dataset)
        elif "status" in dataset and dataset.attrs.get("kind") not in ("study", "stability"):
            parts = _comparison(dataset)
        elif "status" in dataset or "class" in dataset:
            parts = {"figures": figures_of(dataset)}
        else:
            raise SceneError("report: holds no run, comparison, study or map")
        attributes = dict(found.attrs)
        page = Environment(autoescape=True).from_string(
            files(__package__).joinpath("page.html").read_text("utf-8")
        )
        versions = attributes.get("versions")
        text = page.render(
            title=attributes.get("title") or attributes.get("study") or "Results of mpmfw",
            svg=_svg,
            versions=json.loads(versions) if isinstance(versions, str) and versions.startswith("{") else {},
            commit=attributes.get("commit"),
            processor=attributes.get("processor"),
            timing=attributes.get("timing"),
            scene=attributes.get("scene"),
            **parts,
        )
    replace_bytes(text.encode("utf-8", "replace"), path)


def _run(tree: xr.DataTree, series: xr.Dataset) -> Mapping[str, Any]:
    notes = json.loads(tree.attrs.get("notes", "[]"))
    return {
        "summary": summary_of_run(series, tree.attrs),
        **slides(tree),
        "figures": figures_of(series),
        "notes": {"run": notes} if notes else {},
    }


def _comparison(dataset: xr.Dataset) -> Mapping[str, Any]:
    rows = table(dataset)
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = [name for name in names if name.endswith("_error") and name not in COLUMNS]
    columns += [name for name in COLUMNS if name in names]
    labels = [str(dim) for dim in method_dims(dataset)]
    methods = [f"{a}, {b}" for a in dataset["contact"].values for b in dataset["shape"].values]
    found, force = differences(dataset), dataset.get("contact_force")
    return {
        "summary": summary_of_comparison(rows, labels, methods, found),
        **slides(dataset),
        "reference": described(dataset),
        "compared": True,
        "untouched": force is not None and not np.nan_to_num(force.values).any(),
        "rows": rows,
        "labels": labels + [name for name in CHOICES if name in names and name not in labels],
        "columns": columns,
        "accuracy": [name for name in columns if name not in COSTS],
        "costs": COSTS,
        "column_of": column_of,
        "meaning_of": meaning_of,
        "judged": drawn_reference(dataset),
        "shown": shown,
        "nan": np.nan,
        "methods": methods,
        "differences": [one for one in found if one.spread >= _LEAST_SPREAD],
        "equal": [one.quantity for one in found if one.spread == 0.0 and len(methods) > 1],
        "most": _MOST_DIFFERENCES,
        "notes": json.loads(dataset.attrs.get("notes", "{}")),
        "figures": figures_of(dataset) | field_differences(dataset),
    }


def _svg(figure: Figure) -> Markup:
    buffer = io.StringIO()
    with journal_style():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :])
