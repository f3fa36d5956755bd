"""The sphere after the impact, against rigid spheres, Maw, Barber and Fawcett's elastic one, and Hertz."""

import tomllib
from dataclasses import replace

import numpy as np
import xarray as xr
from elastic import LEVER, rebound
from spheres import ACROSS, ALONG, NORMAL, SPHERES, Sphere

#: Energies of bodies, and what a contact keeps or takes of them.
STORED = ("kinetic_energy", "affine_energy", "strain_energy")
TAKEN = ("contact_energy", "frictional_work", "damping_work", "spring_work")
#: Of the largest force: what counts as contact.
TOUCHING = 2e-3


def impact(tree: xr.DataTree) -> dict[str, float]:
    """``restitution``; ``slope``, what the point of contact has along the plane over v_n; and over that
    ``along``, the change of the sphere's velocity, ``across`` the same across, ``spin``, the change of ω R,
    and ``contact``, what the point has after it.

    All as the slab or the larger sphere sees it, which moves a little; of two equal spheres as their common
    centre does."""
    series, radius = tree["series"].to_dataset(), _sphere(tree).radius
    before, after = (_seen(series, k, radius) for k in (0, -1))
    spins = series["angular_velocity"].sel(body="sphere").values @ ACROSS * radius
    came = float(before @ ALONG - spins[0])
    over = came or 1.0  # a sphere that falls straight has no such velocity
    return {
        "restitution": -float(after @ NORMAL) / float(before @ NORMAL),
        "slope": came / -float(before @ NORMAL),
        "along": float((after - before) @ ALONG) / over,
        "across": float((after - before) @ ACROSS) / over,
        "spin": float(spins[-1] - spins[0]) / over,
        "contact": float(after @ ALONG - spins[-1]) / over,
    }


def errors(tree: xr.DataTree) -> dict[str, float]:
    """Errors [%] of the changes ``along`` and ``spin`` against
    Maw, Barber and Fawcett's sphere; of both changes also against a rigid one, from which friction takes μ (1
    + e) v_n where it slides throughout, and which else rolls at the end."""
    found, sphere = impact(tree), _sphere(tree)
    left = rebound(found["slope"] / sphere.friction, sphere.poisson)
    sliding = sphere.friction * (1.0 + found["restitution"]) / found["slope"]
    rigid = _changes(found, min(1.0 / LEVER, sliding))
    return {
        **_changes(found, (1.0 - left) / LEVER),
        **{f"{name}, rigid": value for name, value in rigid.items()},
    }


def against_hertz(tree: xr.DataTree) -> dict[str, float]:
    """Errors [%] of the largest ``force`` and of the ``time`` of contact."""
    series, sphere = tree["series"].to_dataset(), _sphere(tree)
    pressing = np.abs(series["contact_force"].isel(pair=0).values @ NORMAL)
    touching = series["time"].values[pressing > TOUCHING * pressing.max()]
    lasted = float(touching[-1] - touching[0]) + float(tree.attrs["output_interval"])
    return {
        "force": 100.0 * (float(pressing.max()) / sphere.force - 1.0),
        "time": 100.0 * (lasted / sphere.contact_time - 1.0),
    }


def kept(tree: xr.DataTree) -> dict[str, float]:
    """Change of the whole ``momentum``, over what there is; ``moment`` of contact on both bodies about one
    point, times a step, over their angular momentum, at its largest; and largest ``energy`` with what was
    dissipated, over the start."""
    series = tree["series"].to_dataset()
    momentum = series["linear_momentum"].values
    whole = momentum.sum(axis=1)
    spins = series["angular_momentum"].values + np.cross(series["centre_of_mass"].values, momentum)
    brought, step = np.linalg.norm(spins[0], axis=1).sum(), float(series["time"][-1]) / tree.attrs["steps"]
    on_both = np.linalg.norm(series["contact_moment"].values.sum(axis=1), axis=1)
    energy = (
        sum(series[name].sum("body") for name in STORED if name in series) + series["transfer_dissipation"]
    )
    energy = energy + sum(series[name].sum("pair") for name in TAKEN if name in series)
    return {
        "momentum": float(np.abs(whole - whole[0]).max() / np.abs(momentum[0]).sum()),
        "moment": float(on_both.max() * step / brought),
        "energy": float(energy.max() / energy[0]),
    }


def _changes(found: dict[str, float], taken: float) -> dict[str, float]:
    """Return errors of both changes [%] if friction takes ``taken`` along the plane."""
    return {
        "along": 100.0 * (-found["along"] / taken - 1.0),
        "spin": 100.0 * (found["spin"] / (2.5 * taken) - 1.0),
    }


def _sphere(tree: xr.DataTree) -> Sphere:
    """The sphere of a run, with the speed that it has there."""
    title = str(tomllib.loads(tree.attrs["scene"])["title"])
    came = tree["series/mean_velocity"].sel(body="sphere").values[0] @ NORMAL
    return replace(SPHERES[title.rpartition(", ")[2]], speed=-float(came))


def _seen(series: xr.Dataset, k: int, radius: float) -> np.ndarray:
    """Velocity of the sphere at output ``k``, less that of slab or cap below its lowest point [m/s]."""
    velocity, place = series["mean_velocity"].values[k], series["centre_of_mass"].values[k]
    if "twin" in series["body"]:  # their common centre is at rest
        return np.asarray(velocity[0])
    spin = series["angular_velocity"].values[k, 1]
    return np.asarray(velocity[0] - velocity[1] - np.cross(spin, place[0] - radius * NORMAL - place[1]))
