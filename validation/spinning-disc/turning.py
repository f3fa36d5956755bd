"""Angular momentum, radius and energy of a disc over one turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from xarray import Dataset, DataTree

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.results.analysis import energy_kept
from mpmfw.state.fields import FloatArray
from mpmfw.validation import CaseRun

BULK, SHEAR, DENSITY, SPIN = 6e6, 3e6, 1000.0, 10.0  # Pa, Pa, kg/m³, rad/s, R = 1 m: as in scene.toml
TRANSFERS = ("flip", "pic", "apic", "tpic", "aflip")
COLOURS = dict(zip(TRANSFERS, ("#D55E00", "#6B6B6B", "#009E73", "#E69F00", "#0072B2"), strict=True))
STYLES = {"usl": "-", "musl": "--", "usf": ":"}


def centrifugal_growth() -> float:
    """Static change of the disc's radius of gyration over itself, plane strain [1].

    u = A r − ρ ω² r³ / (8 M), A = ρ ω² R² (3 M + λ) / (8 M (M + λ)), M = λ + 2 G: the solution of M (u'' + u'/r − u/r²)
    = −ρ ω² r with σ_rr(R) = 0 (Timoshenko & Goodier, Theory of Elasticity, rotating discs), weighed by r³.
    """
    lame, modulus = BULK - 2.0 * SHEAR / 3.0, BULK + 4.0 * SHEAR / 3.0
    load = DENSITY * SPIN**2 / (8.0 * modulus)
    return load * ((3.0 * modulus + lame) / (modulus + lame) - 4.0 / 6.0)


def change(tree: DataTree) -> dict[str, float]:
    """Over one turn: change of angular ``momentum`` and ``energy`` [%], ``growth`` of the radius of gyration over the static
    one, and ``strain`` energy over the kinetic, beside that of the ``static`` solution [%]."""
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


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Angular momentum over the turn; transfers that dissipate on a scale of their own."""
    steppings = [run for run in runs if "stepping.scheme" in run.method.set]
    drawn = {run.method.label: run.results["series"].to_dataset() for run in steppings}
    result = new_figure(1, 2, 50.0)
    panels = result.subplots(2, 1, sharex=True)
    for label, series in drawn.items():
        if label.count(",") != 1:
            continue
        transfer, scheme = label.split(", ")
        change = 100.0 * (momentum(series) - 1.0)
        turns = series["time"].values * SPIN / (2.0 * np.pi)
        for axes in panels:
            axes.plot(turns, change, color=COLOURS[transfer], linestyle=STYLES[scheme], linewidth=0.9)
    for axes in panels:
        axes.axhspan(-0.05, 0.05, color="0.85", zorder=0)
        axes.axhline(0.0, color="black", linewidth=0.6)
    panels[1].set_ylim(-0.6, 0.2)
    dress(panels[0], "", "change of $L$ [%]")
    dress(panels[1], "turns [1]", "change of $L$, enlarged [%]")
    transfers = [Line2D([], [], color=colour, linewidth=2.0, label=name) for name, colour in COLOURS.items()]
    schemes = [Line2D([], [], color="0.3", linestyle=style, label=name) for name, style in STYLES.items()]
    closed = Line2D([], [], color="black", linewidth=0.6, label="closed form")
    gate = Line2D([], [], color="0.85", linewidth=4.0, label="gate")
    legend_below(result, [transfers[:3], transfers[3:], schemes, [closed, gate]])
    return result
