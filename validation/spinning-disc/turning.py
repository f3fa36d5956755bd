"""Angular momentum, radius and energy of a disc over one turn."""

from __future__ import annotations

import numpy as np
from xarray import Dataset, DataTree

from mpmfw.results.analysis import energy_kept
from mpmfw.state.fields import FloatArray

BULK, SHEAR, DENSITY, SPIN = 6e6, 3e6, 1000.0, 10.0  # Pa, Pa, kg/m³, rad/s, R = 1 m: as in scene.toml


def centrifugal_growth() -> float:
    """Static change of the disc's radius of gyration over itself, plane strain [1].

    u = A r − ρ ω² r³ / (8 M), A = ρ ω² R² (3 M + λ) / (8 M (M + λ)), M = λ + 2 G: the solution of M (u'' +
    u'/r − u/r²) = −ρ ω² r with σ_rr(R) = 0 (Timoshenko & Goodier, Theory of Elasticity, rotating discs),
    weighed by r³."""
    lame, modulus = BULK - 2.0 * SHEAR / 3.0, BULK + 4.0 * SHEAR / 3.0
    load = DENSITY * SPIN**2 / (8.0 * modulus)
    return load * ((3.0 * modulus + lame) / (modulus + lame) - 4.0 / 6.0)


def change(tree: DataTree) -> dict[str, float]:
    """Over one turn: change of angular ``momentum`` and ``energy`` [%], ``growth`` of the radius of gyration
    over the static one, and ``strain`` energy over the kinetic, beside that of the ``static`` solution
    [%]."""
    series = tree["series"].to_dataset()
    share = (series["strain_energy"] / series["kinetic_energy"]).isel(body=0).values
    return {
        "momentum": 100.0 * (momentum(series)[-1] - 1.0),
        "growth": float((gyration(tree) - 1.0).mean() / centrifugal_growth()),
        "energy": 100.0 * float(energy_kept(series)[-1] - 1.0),
        "strain": 100.0 * float(share.mean()),
        "static strain": round(100.0 * strain_share(), 3),
    }


def strain_share() -> float:
    """Strain energy of the static solution over the kinetic energy, by quadrature over the radius [1]."""
    lame, modulus = BULK - 2.0 * SHEAR / 3.0, BULK + 4.0 * SHEAR / 3.0
    load = DENSITY * SPIN**2 / (8.0 * modulus)
    r = (np.arange(1000) + 0.5) / 1000.0
    slope = load * (3.0 * modulus + lame) / (modulus + lame)
    radial, hoop = slope - 3.0 * load * r**2, slope - load * r**2
    density = 0.5 * lame * (radial + hoop) ** 2 + SHEAR * (radial**2 + hoop**2)
    return float(np.sum(density * r) / np.sum(0.5 * DENSITY * SPIN**2 * r**3))


def momentum(series: Dataset) -> FloatArray:
    """Angular momentum over that at the start."""
    values = series["angular_momentum"].isel(body=0, rotation=0).values
    return np.asarray(values / values[0])


def gyration(tree: DataTree) -> FloatArray:
    """Radius of gyration over that at the start."""
    data = tree["particles/disc"].to_dataset()
    x, mass = data["position"].values, data["mass"].values
    r = x - (np.einsum("p,tpd->td", mass, x) / mass.sum())[:, None]
    square = np.einsum("p,tpd->t", mass, r**2)
    return np.asarray(np.sqrt(square / square[0]))
