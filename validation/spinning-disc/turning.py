"""Angular momentum, radius and energy of a disc over one turn."""

import numpy as np
from xarray import DataTree

from mpmfw.results.analysis import energy_kept

BULK, SHEAR, DENSITY, SPIN = 6e6, 3e6, 1000.0, 10.0  # Pa, Pa, kg/m³, rad/s, R = 1 m: as in scene.toml


def static() -> tuple[float, float]:
    """Static change of the radius of gyration over itself, and strain energy over the kinetic one [1].

    u = A r − ρ ω² r³ / (8 M), A = ρ ω² R² (3 M + λ) / (8 M (M + λ)), M = λ + 2 G, in plane strain: the
    solution of M (u'' + u'/r − u/r²) = −ρ ω² r with σ_rr(R) = 0 (Timoshenko & Goodier, Theory of Elasticity,
    rotating discs). The radius is weighed by r³, the energy integrated over the radius."""
    lame, modulus = BULK - 2.0 * SHEAR / 3.0, BULK + 4.0 * SHEAR / 3.0
    load = DENSITY * SPIN**2 / (8.0 * modulus)
    r = (np.arange(1000) + 0.5) / 1000.0
    slope = load * (3.0 * modulus + lame) / (modulus + lame)
    radial, hoop = slope - 3.0 * load * r**2, slope - load * r**2
    density = 0.5 * lame * (radial + hoop) ** 2 + SHEAR * (radial**2 + hoop**2)
    strain = float(np.sum(density * r) / np.sum(0.5 * DENSITY * SPIN**2 * r**3))
    return slope - load * 4.0 / 6.0, strain


def change(tree: DataTree) -> dict[str, float]:
    """Over one turn: change of angular ``momentum`` and ``energy`` [%], ``growth`` of the radius of gyration
    over the static one, and ``strain`` energy over the kinetic [%]."""
    series = tree["series"].to_dataset()
    momentum = series["angular_momentum"].isel(body=0, rotation=0).values
    points = tree["particles/disc"].to_dataset()
    x, mass = points["position"].values, points["mass"].values
    lever = x - (np.einsum("p,tpd->td", mass, x) / mass.sum())[:, None]
    square = np.einsum("p,tpd->t", mass, lever**2)
    growth = np.sqrt(square / square[0]) - 1.0
    share = (series["strain_energy"] / series["kinetic_energy"]).isel(body=0)
    return {
        "momentum": 100.0 * float(momentum[-1] / momentum[0] - 1.0),
        "growth": float(growth.mean() / static()[0]),
        "energy": 100.0 * float(energy_kept(series)[-1] - 1.0),
        "strain": 100.0 * float(share.mean()),
    }
