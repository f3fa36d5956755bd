"""One self-contained page of a comparison, with the differences between its methods, the largest first."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
import xarray as xr
from jinja2 import Environment
from markupsafe import Markup
from matplotlib.figure import Figure

from mpmfw.errors import is_complete
from mpmfw.plots import figures_of
from mpmfw.plots.style import at_last, journal_style
from mpmfw.report.table import CHOICES, COLUMNS, COSTS, column_of, method_dims, shown, table
from mpmfw.results.analysis import energy_sums, without_round_off
from mpmfw.results.references import cell_size, described
from mpmfw.results.replacing import replace_bytes
from mpmfw.results.selection import points_of
from mpmfw.state.fields import FloatArray


@dataclass(frozen=True)
class Difference:
    """A quantity at the end of the runs."""

    quantity: str  #: with its body or pair
    unit: str
    values: FloatArray  #: (contact, shape); NaN of a run that did not end
    scale: float  #: that a difference is measured against, in the same unit
    against: str  #: name of the scale

    @property
    def spread(self) -> float:
        """Largest less least value, over the scale."""
        known = self.values[np.isfinite(self.values)]
        return float(np.ptp(known) / self.scale) if len(known) > 1 and self.scale > 0.0 else 0.0


def differences(dataset: xr.Dataset) -> list[Difference]:
    """Return quantities by how far methods differ in them, at last values."""
    last = at_last(without_round_off(dataset))
    return sorted(_quantities(last), key=lambda one: -one.spread)


def _quantities(runs: xr.Dataset) -> Iterator[Difference]:
    if "centre_of_mass" in runs:
        centre, velocity = runs["centre_of_mass"], runs["mean_velocity"]
        moved = centre - centre.isel(time=0)
        yield from _each("displacement", "m", moved, moved.isel(time=-1), "largest displacement of any body")
        yield from _each("velocity", "m/s", velocity, velocity.isel(time=-1), "largest velocity of any body")
        if "angular_velocity" in runs:
            spin = runs["angular_velocity"]
            yield from _each("spin", "rad/s", spin, spin.isel(time=-1), "largest spin of any body")
    per_metre = "/m" if runs.sizes.get("axis") == 2 else ""
    if "kinetic_energy" in runs and "strain_energy" in runs:
        yield from _energies(runs, f"J{per_metre}")
    if "contact_force" in runs:
        steps = xr.DataArray(np.diff(runs["time"], prepend=runs["time"][:1]), {"time": runs["time"]})
        impulse = (runs["contact_force"].fillna(0.0) * steps).sum("time")
        end = impulse.where(_ended(runs))
        yield from _each("impulse", f"N s{per_metre}", impulse, end, "largest impulse of any pair")
    if "min_gap" in runs:
        depth = (
            (-runs["min_gap"]).clip(min=0.0).fillna(0.0).max("time").where(_ended(runs) & ~_of_codes(runs))
        )
        yield from _each("largest penetration", "m", cell_size(runs), depth, "a cell")


def _each(
    what: str, unit: str, scale: xr.DataArray | float, end: xr.DataArray, against: str
) -> Iterator[Difference]:
    """Yield a quantity at the end of the runs, over a number or the largest of the values ``scale``."""
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


#: Rows of the table of differences, and the least difference that has one.
_MOST_DIFFERENCES, _LEAST_SPREAD = 15, 1e-3


def write_report(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a comparison as one HTML page that needs no network."""
    attributes, rows = dataset.attrs, table(dataset)
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = [name for name in names if name.endswith("_error") and name not in COLUMNS]
    columns += [name for name in COLUMNS if name in names]
    labels = [str(dim) for dim in method_dims(dataset)]
    force = dataset.get("contact_force")
    versions = attributes.get("versions")
    page = Environment(autoescape=True).from_string(
        files(__package__).joinpath("page.html").read_text("utf-8")
    )
    text = page.render(
        title=attributes.get("title", "Comparison of contact methods"),
        reference=described(dataset),
        untouched=force is not None and not np.nan_to_num(force.values).any(),
        rows=rows,
        labels=labels + [name for name in CHOICES if name in names and name not in labels],
        columns=columns,
        accuracy=[name for name in columns if name not in COSTS],
        costs=COSTS,
        column_of=column_of,
        shown=shown,
        nan=np.nan,
        methods=[f"{a}, {b}" for a in dataset["contact"].values for b in dataset["shape"].values],
        differences=[one for one in differences(dataset) if one.spread >= _LEAST_SPREAD],
        most=_MOST_DIFFERENCES,
        notes=json.loads(attributes.get("notes", "{}")),
        figures=figures_of(dataset),
        svg=_svg,
        versions=json.loads(versions) if isinstance(versions, str) and versions.startswith("{") else {},
        commit=attributes.get("commit"),
        processor=attributes.get("processor"),
        timing=attributes.get("timing"),
        scene=attributes.get("scene"),
    )
    replace_bytes(text.encode("utf-8", "replace"), path)


def _svg(figure: Figure) -> Markup:
    buffer = io.StringIO()
    with journal_style():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :])
