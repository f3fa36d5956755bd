"""Figures of a comparison: motion, forces, gaps and energies; the scenes of [H17] beside their references."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots import style
from mpmfw.plots.histories import Beside, beside_reference, history
from mpmfw.plots.style import at_last, drawn_reference
from mpmfw.results import analysis
from mpmfw.results.analysis import GAP_ROUND_OFF, energy_sums
from mpmfw.results.references import RingsReference, RollingReference, rings_table
from mpmfw.results.stored_scene import cell_size, own_attributes, scene_of_results
from mpmfw.state.fields import FloatArray

#: Bodies that move no further than this part of the largest motion stand still.
_STILL = 1e-2
#: Rows of a figure: the bodies that move farthest, the pairs with the largest forces.
MOST = 6
#: Top of the gap's history, in cells.
LARGEST_GAP = 3.0


def moving_bodies(dataset: xr.Dataset) -> list[str]:
    """Return the bodies that move, the farthest first."""
    centre = dataset["centre_of_mass"]
    away = centre - centre.isel(time=0)
    far = _largest(_size(away, away), "body")
    return [str(name) for name in far["body"].values[far.values > _STILL * far.values.max()]]


def touching_pairs(dataset: xr.Dataset) -> list[str]:
    """Return the pairs with a contact force in any run, largest first."""
    force = _largest(dataset["contact_force"], "pair")
    return [str(name) for name in force["pair"].values[force.values > 0.0]]


def _largest(array: xr.DataArray, dim: str) -> xr.DataArray:
    """Return the largest magnitude for each label, the largest first."""
    size = abs(array).where(np.isfinite(array))
    size = size.max([one for one in size.dims if one != dim]).fillna(0.0)
    return size.isel({dim: np.argsort(-size.values, kind="stable")})


def near_pairs(dataset: xr.Dataset) -> list[str]:
    """Return the pairs that come within so many cells."""
    h, gap = cell_size(at_last(dataset)), at_last(dataset)["min_gap"]
    near = (gap < (LARGEST_GAP * h if h > 0.0 else np.inf)).any([dim for dim in gap.dims if dim != "pair"])
    return [str(name) for name in dataset["pair"].values[near.values]]


def body_motion(dataset: xr.Dataset) -> Figure:
    """Draw displacement and spin of each body that moves."""
    centre = dataset["centre_of_mass"]
    displacement = (centre - centre.isel(time=0)).assign_attrs(units="m")
    shown = dataset.assign(displacement=displacement).sel(body=moving_bodies(dataset)[:MOST])
    return history(shown, ["displacement", *(["angular_velocity"] if "angular_velocity" in dataset else [])])


def pair_forces(dataset: xr.Dataset) -> Figure:
    """Draw the normal and the tangential force of every pair that touches."""
    shown = dataset.sel(pair=touching_pairs(dataset)[:MOST])
    force = shown["contact_force"]
    if "friction_force" not in dataset:
        return history(shown.assign(contact_force_size=_size(force, force)), "contact_force_size")
    along = shown["friction_force"]
    parts = {"normal_force": _size(force - along, force), "tangential_force": _size(along, force)}
    return history(shown.assign(parts), list(parts))


def gap_history(dataset: xr.Dataset) -> Figure:
    """Draw the gap of every pair that comes near."""
    h = cell_size(at_last(dataset))
    known = h > 0.0
    shown = dataset.sel(pair=near_pairs(dataset)[:MOST] or dataset["pair"].values[:1])
    gap = shown["min_gap"] / (h if known else 1.0)
    if known:
        gap = gap.where(~(abs(gap) < GAP_ROUND_OFF), 0.0)  # NaN stays
    gap = gap.assign_attrs(units="cells" if known else "m")
    figure = history(shown.assign(gap=gap), "gap")
    for axes in figure.axes:
        axes.axhline(0.0, color="black", linewidth=0.6)
        if known:  # bodies that have flown apart would hide what happens in contact
            axes.set_ylim(top=min(axes.get_ylim()[1], LARGEST_GAP))
    return figure


def energies(dataset: xr.Dataset) -> Figure:
    """Kinetic, strain and dissipated energy of all bodies over time."""
    unit = dataset["kinetic_energy"].attrs.get("units", "J")
    sums = energy_sums(dataset)
    shown = dataset.assign({name: total.assign_attrs(units=unit) for name, total in sums.items()})
    return history(shown, list(sums))


def _size(force: xr.DataArray, of: xr.DataArray) -> xr.DataArray:
    size = (force**2).sum("axis", skipna=False) ** 0.5
    return size.assign_attrs(units=of.attrs.get("units", "N"))


#: Of the averaged force of the rings [s].
WINDOW = 100e-6


def motion(dataset: xr.Dataset) -> Figure:
    """Draw motion and error of a rolling body, the error where it moves; else a ValueError."""
    reference = drawn_reference(dataset)
    if not isinstance(reference, RollingReference):
        raise ValueError("not a comparison of a rolling body")
    solution, time = reference.solution, dataset["time"].values
    run = dataset.sel(body=reference.body)
    x = run["centre_of_mass"].sel(axis="x")
    moved, velocity = x - x.isel(time=0), run["mean_velocity"].sel(axis="x")
    exact = xr.DataArray(solution.displacement(time), {"time": dataset["time"]})
    moves = abs(moved).max("time") > 0.5 * exact.where(moved.notnull()).max("time")
    series: dict[str, Beside] = {
        "displacement": (moved, "m", time, exact.values),
        "velocity": (velocity, "m s-1", time, solution.velocity(time)),
    }
    if "angular_velocity" in run:
        spin = -run["angular_velocity"].sel(rotation="z")
        series["clockwise spin"] = (spin, "rad s-1", time, -solution.spin(time))
    away = (moved - exact).where(moves)
    series["displacement error"] = (away, "m", time, np.zeros(len(time)))
    return beside_reference(dataset, series, "closed form", title="slip" if solution.slips else "no slip")


def contact_force(dataset: xr.Dataset) -> Figure:
    """Draw force of the rings, its mean and its impulse ([H17] figure 4)."""
    time, table = dataset["time"].values, rings_table("force")
    force = -dataset["contact_force"].isel(pair=0).sel(axis="x")  # on the pair's second body

    def over_time(function: Callable[[FloatArray], FloatArray]) -> xr.DataArray:
        dims = [["time"]]
        found: xr.DataArray = xr.apply_ufunc(
            function, force, input_core_dims=dims, output_core_dims=dims, vectorize=True
        )
        return found.where(force.notnull())

    known = isinstance(drawn_reference(dataset), RingsReference)
    inside = (table["time"] <= time[-1]) & known
    at, impulse = table["time"][inside], table["fine_impulse_Ns_per_m"]
    exact = analysis.averaged(table["time"], impulse, WINDOW)
    mean = over_time(lambda one: analysis.running_average(time, one, WINDOW))
    series: dict[str, Beside] = {
        "contact force": (force, "N m-1", at, table["fine_force_raw_N_per_m"][inside]),
        "mean over 100 µs": (mean, "N m-1", at, exact[inside]),
        "impulse": (over_time(lambda one: analysis.impulse(time, one)), "N s m-1", at, impulse[inside]),
    }
    return beside_reference(dataset, series, "finite elements, 0.5 mm", noisy="contact force")


_DASHED = (0, (3, 3))


@style.journal_style()
def positions(dataset: xr.Dataset) -> Figure:
    """Draw first outlines (dashed) and last ones, one panel for each method, all at one scale.

    Raise ValueError without an outline.
    """
    runs = [one for one in style.combinations(dataset) if np.isfinite(one[2]["outline"].values).any()]
    if not runs:
        raise ValueError("no run of the comparison stored an outline")
    points = np.concatenate([run["outline"].values.reshape(-1, 2) for _, _, run in runs])
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    scene = scene_of_results(own_attributes(style.at_last(dataset)))
    if scene is not None:  # rigid bodies may leave the grid
        low, high = np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)
    margin = 0.04 * (high - low).max()
    low, high = low - margin, high + margin
    height = min(22.0 * style.PANEL * float(np.divide(*(high - low)[::-1])), 110.0) + 17.0
    figure, panels = style.new_panels(len(runs), height)
    figure.set_layout_engine("compressed")
    style.head(figure, dataset)
    moving, turn = moving_bodies(dataset), itertools.cycle(style.CYCLE)
    names = [str(name) for name in dataset["body"].values]
    colours = {name: next(turn) if name in moving else "0.45" for name in names}
    scale, unit = style.length_scale(float((high - low).max()))
    for axes, (contact, name, run) in zip(panels, runs, strict=True):
        for frame, dashes in (("last", "-"), ("first", _DASHED)):
            lines = run["outline"].sel(frame=frame).values
            for body, line in zip(run["outlined_body"].values, lines, strict=True):
                axes.plot(*(scale * line).T, color=colours[str(body)], linestyle=dashes, linewidth=0.9)
        axes.set_aspect("equal")
        axes.set_xlim(scale * low[0], scale * high[0])
        axes.set_ylim(scale * low[1], scale * high[1])
        end = float(run["outline_time"].sel(frame="last"))
        time, of_time = style.time_scale(end)
        last = f"{time * end:.4g} {of_time}"
        style.dress(axes, f"x [{unit}]", f"y [{unit}]", f"{contact}, {name}, {last}")
        axes.grid(False)
    key = [style.entry(name, color=colour, linewidth=2.0) for name, colour in colours.items()]
    style.legend_below(figure, [[*key, style.entry("start", color="0.3", linestyle=_DASHED)]])
    return figure
