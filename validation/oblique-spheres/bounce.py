"""What the sphere has after the impact, against rigid spheres and against Maw, Barber and Fawcett's elastic one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from elastic import rebound
from thrown import ACROSS, ALONG, FRICTION, NORMAL, RADIUS

if TYPE_CHECKING:
    import xarray as xr

#: 1 + m R² / I of a solid sphere: an impulse T at the contact changes its velocity there by 3.5 T / m.
LEVER = 3.5
#: Energies of bodies, and what a contact keeps or takes of them.
STORED = ("kinetic_energy", "affine_energy", "strain_energy")
TAKEN = ("contact_energy", "frictional_work", "damping_work", "spring_work")


def impact(tree: xr.DataTree) -> dict[str, float]:
    """``restitution``; velocity along the slab over that before, ``along``, and ``across`` the throw; ``spin`` R / v_t; and what
    the point of contact has, ``contact``. All as the slab sees it, which moves a little."""
    series = tree["series"].to_dataset()
    before, after = (_seen(series, k) for k in (0, -1))
    spin = series["angular_velocity"].sel(body="sphere").values[-1] @ ACROSS
    turning = RADIUS * float(spin) / float(before @ ALONG)
    return {
        "restitution": -float(after @ NORMAL) / float(before @ NORMAL),
        "along": float(after @ ALONG) / float(before @ ALONG),
        "across": float(after @ ACROSS) / float(before @ ALONG),
        "spin": turning,
        "contact": float(after @ ALONG) / float(before @ ALONG) - turning,
        "slope": float(before @ ALONG) / -float(before @ NORMAL),
    }


def against_sliding(tree: xr.DataTree) -> dict[str, float]:
    """Errors [%] against a rigid sphere that slides throughout: Δv_t = μ (1 + e) v_n, ω = 5 μ (1 + e) v_n / (2 R)."""
    found = impact(tree)
    taken = FRICTION * (1.0 + found["restitution"]) / found["slope"]  # Δv_t over v_t
    return {
        "along": 100.0 * ((1.0 - found["along"]) / taken - 1.0),
        "spin": 100.0 * (found["spin"] / (2.5 * taken) - 1.0),
    }


def against_rolling(tree: xr.DataTree) -> dict[str, float]:
    """Errors [%] against a rigid sphere that rolls at the end: v_t' = 5/7 v_t, ω R = v_t'."""
    found = impact(tree)
    return {"along": 100.0 * (1.4 * found["along"] - 1.0), "spin": 100.0 * (1.4 * found["spin"] - 1.0)}


def against_elastic(tree: xr.DataTree) -> dict[str, float]:
    """Errors [%] against Maw, Barber and Fawcett's sphere with the same friction and angle."""
    found = impact(tree)
    left = rebound(found["slope"])
    exact = 1.0 - (1.0 - left) / LEVER
    return {
        "along": 100.0 * (found["along"] / exact - 1.0),
        "spin": 100.0 * (found["spin"] / (2.5 * (1.0 - exact)) - 1.0),
        "contact": found["contact"] - left,
    }


def kept(tree: xr.DataTree) -> dict[str, float]:
    """Change of the whole ``momentum``, over what there is; ``moment`` of contact on both bodies about one point, times a step,
    over their angular momentum, at its largest; largest ``energy`` with what was dissipated, over the start; and [%] of
    ``angular`` momentum that both lose."""
    series = tree["series"].to_dataset()
    momentum = series["linear_momentum"].values
    whole = momentum.sum(axis=1)
    spins = series["angular_momentum"].values + np.cross(series["centre_of_mass"].values, momentum)
    turning = spins.sum(axis=1)
    brought, step = np.linalg.norm(turning[0]), float(series["time"][-1]) / tree.attrs["steps"]
    on_both = np.linalg.norm(series["contact_moment"].values.sum(axis=1), axis=1)
    energy = (
        sum(series[name].sum("body") for name in STORED if name in series) + series["transfer_dissipation"]
    )
    energy = energy + sum(series[name].sum("pair") for name in TAKEN if name in series)
    return {
        "momentum": float(np.abs(whole - whole[0]).max() / np.abs(momentum[0]).sum()),
        "moment": float(on_both.max() * step / brought),
        "energy": float(energy.max() / energy[0]),
        "angular": 100.0 * float(np.linalg.norm(turning[-1] - turning[0]) / brought),
    }


def _seen(series: xr.Dataset, k: int) -> np.ndarray:
    """Velocity of the sphere at output ``k``, less that of the slab below its lowest point [m/s]."""
    velocity, place = series["mean_velocity"].values[k], series["centre_of_mass"].values[k]
    spin = series["angular_velocity"].sel(body="slab").values[k]
    return np.asarray(velocity[0] - velocity[1] - np.cross(spin, place[0] - RADIUS * NORMAL - place[1]))
