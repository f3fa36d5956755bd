"""Spinning disc: angular momentum, radius and energy over one turn, and the inertia that answers a torque."""

# cost: 22

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from torque import effective_inertia
from xarray import Dataset, DataTree

from mpmfw.analysis import energy_kept
from mpmfw.fields import FloatArray
from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.scene import load_scene
from mpmfw.validation import SHAPES, Case
from mpmfw.validation.case import Method

BULK, SHEAR, DENSITY, SPIN = 6e6, 3e6, 1000.0, 10.0  # Pa, Pa, kg/m³, rad/s, R = 1 m: as in scene.toml
TRANSFERS = ("flip", "pic", "apic", "tpic", "aflip")
SCHEMES = ("usl", "musl", "usf")
COLOURS = dict(zip(TRANSFERS, ("#D55E00", "#6B6B6B", "#009E73", "#E69F00", "#0072B2"), strict=True))
STYLES = {"usl": "-", "musl": "--", "usf": ":"}
EXACT = {"gimp", "cpdi", "cpdi2", "bspline"}  # those that ``auto`` runs with USL and aflip


def check(case: Case) -> None:
    """Every transfer with every scheme, every shape function, every treatment of rotational inertia."""
    drawn = {}
    for method, tree in case.runs(methods(case)):
        judge(case, method, tree)
        if method.shape == "cpdi" and "stepping.scheme" in method.set and "," in method.label:
            drawn[method.label] = tree["series"].to_dataset()
        elif method.recommended and method.shape == "cpdi":
            drawn[""] = tree["series"].to_dataset()
    judge_inertia(case)
    if not case.quick:
        case.figure("", figure(drawn))


def methods(case: Case) -> list[Method]:
    """The defaults of every shape function, and CPDI with every transfer, scheme and treatment."""
    if case.quick:
        return case.methods(("",), ("cpdi", "cpdi2"))
    steppings = {
        f"{transfer}, {scheme}": {"stepping.transfer": transfer, "stepping.scheme": scheme}
        for transfer in TRANSFERS
        for scheme in SCHEMES
    }
    untransported = {"stepping.scheme": "usl", "stepping.transported": False}
    others = {
        "aflip, usl, C not transported": {"stepping.transfer": "aflip", **untransported},
        "flip, usl, 5 % pic": {
            "stepping.transfer": "flip",
            "stepping.scheme": "usl",
            "stepping.pic_fraction": 0.05,
        },
        "rotation exact": {"bodies.disc.rotation": "exact"},
        "rotation lumped": {"bodies.disc.rotation": "lumped"},
        "rotation local": {"bodies.disc.rotation": "local"},
    }
    return [*case.methods(("",), SHAPES), *case.methods(("",), ("cpdi",), steppings | others)]


def centrifugal_growth() -> float:
    """Static change of the disc's radius of gyration over itself, plane strain [1].

    u = A r − ρ ω² r³ / (8 M), A = ρ ω² R² (3 M + λ) / (8 M (M + λ)), M = λ + 2 G: the solution of M (u'' + u'/r − u/r²)
    = −ρ ω² r with σ_rr(R) = 0 (Timoshenko & Goodier, Theory of Elasticity, rotating discs), weighed by r³.
    """
    lame, modulus = BULK - 2.0 * SHEAR / 3.0, BULK + 4.0 * SHEAR / 3.0
    load = DENSITY * SPIN**2 / (8.0 * modulus)
    return load * ((3.0 * modulus + lame) / (modulus + lame) - 4.0 / 6.0)


def judge(case: Case, method: Method, tree: DataTree) -> None:
    """Rows of one turn."""
    series = tree["series"].to_dataset()
    spin = momentum(series)
    kept = 100.0 * (spin[-1] - 1.0)
    case.judge(
        method, "angular momentum, change per turn", kept, within=(-0.05, 0.05), unit="%", reference=0.0
    )
    growth = gyration(tree) - 1.0
    case.show(
        "radius of gyration, mean growth over the static",
        float(growth.mean() / centrifugal_growth()),
        reference=1.0,
        method=method,
    )
    energy = 100.0 * float(energy_kept(series)[-1] - 1.0)
    case.show("energy, change per turn", energy, unit="%", reference=0.0, method=method)
    share = (series["strain_energy"] / series["kinetic_energy"]).isel(body=0).values
    reference = 100.0 * strain_share()
    case.show(
        "strain energy over kinetic, mean",
        100.0 * float(share.mean()),
        unit="%",
        reference=round(reference, 3),
        method=method,
    )


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


def judge_inertia(case: Case) -> None:
    """Inertia under a torque on the whole disc, and on its rim alone."""
    shapes = ("cpdi", "cpdi2") if case.quick else SHAPES
    for method in case.methods(
        ("",),
        shapes,
        {"": {}} | {f"rotation {r}": {"bodies.disc.rotation": r} for r in ("exact", "lumped", "local")},
    ):
        if method.label and (case.quick or method.shape not in EXACT):
            continue
        still = {"bodies.disc.angular_velocity": 0.0, "shape.method": method.shape, **method.set}
        scene = load_scene(case.folder / "scene.toml", set=still)
        for load, inner in (("torque on the disc", 0.0), ("torque on its rim", 0.7)):
            with case.timed():
                error = 100.0 * (effective_inertia(scene, inner) - 1.0)
            limit = {"within": (-0.5, 0.5), "unit": "%", "reference": 0.0}
            case.judge(method, f"inertia under a {load}, error", error, **limit)


def figure(drawn: dict[str, Dataset]) -> Figure:
    """Angular momentum over the turn; transfers that dissipate on a scale of their own."""
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
