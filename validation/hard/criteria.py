"""Limits of the hard scenes: penetration, energy, momentum, friction, mirror symmetry."""

import tomllib
from collections.abc import Sequence
from typing import Any

import made
import numpy as np
import xarray as xr

from mpmfw.results.conservation import dissipation, energy_error, momentum_change
from mpmfw.scene import load_scene
from mpmfw.validation import CaseRun


def turned(run: CaseRun) -> bool:
    """Return whether a run is of a scene that is moved."""
    return bool(run.place.make.get("turned"))


def penetration(run: xr.DataTree) -> float:
    """Deepest of all pairs [cells]."""
    return max(0.0, -float(run["series"]["min_gap"].min())) / float(run.attrs["cell_size"])


def energy(run: xr.DataTree) -> float:
    """Largest error in time of strain and contact over the energy put in [%]."""
    return 100.0 * energy_error(run, load_scene(scene_of(run)))


def dissipated(run: xr.DataTree) -> float:
    """Return the share of energy put in that is lost, beside friction and plastic work [%]."""
    return 100.0 * dissipation(run, load_scene(scene_of(run)))


def largest_dissipation(runs: Sequence[CaseRun]) -> float:
    """Return the largest dissipation of the scenes as they stand [%]."""
    stand = [run for run in runs if not turned(run) and "series" in run.results]
    found = [dissipated(run.results) for run in stand]
    return max((lost for lost in found if np.isfinite(lost)), default=float("nan"))


def momentum(run: xr.DataTree) -> float | None:
    """Return the largest change of momentum over what the bodies bring; None where something acts on them."""
    change = momentum_change(run, load_scene(scene_of(run)))
    return None if np.isnan(change) else change


def friction(run: xr.DataTree) -> float | None:
    """Return the largest |T| over μ |N| of a pair; None without friction, or where it bears little."""
    coefficient = float(scene_of(run)["contact"].get("friction", 0.0))
    along = run["series"]["friction_force"].values
    whole = run["series"]["contact_force"].values
    normal = np.linalg.norm(whole - along, axis=-1)
    bears = normal > 1e-3 * normal.max()
    if not coefficient or not bears.any():
        return None
    return float((np.linalg.norm(along, axis=-1)[bears] / normal[bears]).max()) / coefficient


def symmetry(run: xr.DataTree) -> float | None:
    """Largest distance of a body's centre from its mirror image's, about x = 0 [cells].

    None where bodies do not begin so: ``left…`` and ``right…`` are images of each other, others their own.
    """
    centre = run["series"]["centre_of_mass"]
    apart = []
    for name in centre["body"].values:
        image = str(name).replace("left", "\0").replace("right", "left").replace("\0", "right")
        if image not in centre["body"].values:
            return None
        one, other = centre.sel(body=name).values, centre.sel(body=image).values
        apart.append(np.abs(one * [1.0, -1.0] + other * [1.0, 1.0]).max(1))
    distance = np.max(apart, axis=0) / float(run.attrs["cell_size"])
    return None if distance[0] > 0.01 else float(distance.max())


def scene_of(run: xr.DataTree) -> dict[str, Any]:
    """The scene that a run ran, as nested mappings."""
    return tomllib.loads(run.attrs["scene"])


def placed_well(runs: Sequence[CaseRun]) -> float:
    """Return how many of these runs keep every limit."""
    return float(sum(not run.broken for run in runs))


def share_held(runs: Sequence[CaseRun]) -> float:
    """Return the share of these runs that keep every limit [%]."""
    return 100.0 * placed_well(runs) / len(runs)


def hold(runs: Sequence[CaseRun]) -> float:
    """In how many scenes as they stand a method keeps every limit; a run that failed does not.

    Settings of one scene, the slopes' μ and θ, count together as one: by the share of them that holds.
    """
    held: dict[str, list[bool]] = {}
    for run in runs:
        if not turned(run):
            scene = "slopes" if run.place.make["scene"] is made.incline else run.place.at
            held.setdefault(scene, []).append(not run.broken)
    return float(sum(np.mean(settings) for settings in held.values()))


def cost(runs: Sequence[CaseRun]) -> float:
    """CPU time of the scenes as they stand, settling with them [s]."""
    found = [run.results.attrs for run in runs if not turned(run)]
    return float(sum(one["cpu_time"] + one.get("settle_time", 0.0) for one in found))
