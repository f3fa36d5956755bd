"""A ring of metal between flat platens whose shear traction is a share of the metal's strength in shear."""

from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar

#: Outer and inner radius and half of the height [m], in the usual ratio of 6 to 3 to 2 in diameters.
OUTER, INNER, HALF = 3.0, 1.5, 1.0
YIELD, YOUNG, DENSITY = 1e6, 2.5e8, 1e3
#: Speed of the platen over that of waves along a bar, and the reduction of the height at the end.
SPEED, REDUCTION = 1e-3, 0.4


def scene(cells: int, factor: float) -> dict[str, Any]:
    """Return the upper half of the ring, so many ``cells`` high, with the friction ``factor`` m."""
    cell, speed = HALF / cells, SPEED * float(np.sqrt(YOUNG / DENSITY))
    end = 1.02 * REDUCTION * HALF / speed
    motion = [[0.0, 0.0, 0.0], [0.04 * end, 0.0, -speed], [end, 0.0, -speed]]
    contact = {"friction_law": "mohr_coulomb", "mohr_coulomb": {"cohesion": factor * YIELD / 3.0**0.5}}
    metal = {"model": "j2", "density": DENSITY, "youngs_modulus": YOUNG, "poissons_ratio": 0.3}
    return {
        "grid": {
            "cell_size": cell,
            "lower": [0.0, -4.0 * cell],
            "upper": [1.6 * OUTER, 1.8 * HALF],
            "axisymmetric": True,
        },
        "time": {"end": end, "output_interval": end / 40.0, "outputs": "nearest"},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", **(contact if factor else {})},
        "materials": {"metal": metal | {"yield_stress": YIELD}},
        "bodies": {
            "ring": {
                "material": "metal",
                "geometry": {"type": "rectangle", "lower": [INNER, 0.0], "upper": [OUTER, HALF]},
                "particles": {"size": "0.5 cells"},
                "sides": [{"side": "bottom", "fixed": ["y"]}],
            },
            "platen": {
                "geometry": {"type": "rectangle", "lower": [-0.5, HALF], "upper": [2.0 * OUTER, 1.5]},
                "rigid": {"motion": {"velocity": motion}},
            },
        },
        "output": {"surface": False},
    }


def upper_bound(factor: float, steps: int = 100) -> tuple[list[float], list[float]]:
    """Return reductions of the height, and the inner radius over that of the start.

    Avitzur (1968): of the fields v_r = (V / 2 H) (r − s / r) between platens that close at V, with ε̇ = V / H
    √(1 + s² / 3 r⁴), s takes the least power of plastic flow and of friction, m σ_y / √3 over both faces."""
    inner, outer, height = INNER, OUTER, 2.0 * HALF
    reductions, radii = [0.0], [1.0]
    x, weight = np.polynomial.legendre.leggauss(64)
    for _ in range(steps):
        r = inner + 0.5 * (outer - inner) * (x + 1.0)

        def power(s: float, r: np.ndarray = r, height: float = height) -> float:
            flow = np.sqrt(1.0 + s**2 / (3.0 * r**4))
            return float(weight @ (r * (flow + factor / np.sqrt(3.0) / height * np.abs(r - s / r))))

        s = minimize_scalar(
            power, bounds=(-30.0 * outer**2, outer**2), method="bounded", options={"xatol": 1e-9}
        ).x
        closing = 2.0 * HALF * REDUCTION / steps
        inner += 0.5 * closing / height * (inner - s / inner)
        outer += 0.5 * closing / height * (outer - s / outer)
        height -= closing
        reductions.append(1.0 - 0.5 * height / HALF)
        radii.append(inner / INNER)
    return reductions, radii


def inner_radius(tree: xr.DataTree, factor: float) -> dict[str, float]:
    """Return the error [%] of the inner radius, as a ``mean`` over the height, at the end, and how far the
    middle is within the rim, the ``barrel``, over the radius at the start [%]."""
    points = tree["particles/ring"].to_dataset()
    start, last = points["position"].values[0], points["position"].values[-1]
    own = np.isclose(start[:, 0], start[:, 0].min())
    half = 0.25 * float(tree.attrs["cell_size"]) * points["deformation_gradient"].values[-1]
    face = (last[:, 0] - half[:, 0, 0])[own] / INNER
    top = int(last[:, 1].argmax())
    reduction = 1.0 - (last[top, 1] + half[top, 1, 1]) / HALF
    exact = float(np.interp(reduction, *upper_bound(factor)))
    return {
        "mean": 100.0 * float(face.mean() / exact - 1.0),
        "barrel": 100.0 * float(face.max() - face.min()),
    }
