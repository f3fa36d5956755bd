"""A ring that is compressed between platens: its inner radius measures their friction."""
# cost: 60

import numpy as np
from common import elastic, fixed, rectangle, scene
from scipy.optimize import minimize_scalar

from mpmfw.validation import Place, Runs, each, methods

#: Outer and inner radius and half of the height [m], in the usual ratio of 6 to 3 to 2 in diameters.
OUTER, INNER, HALF = 3.0, 1.5, 1.0
YIELD, YOUNG, DENSITY = 1e6, 2.5e8, 1e3
#: Speed of the platen over that of waves along a bar, and the reduction of the height at the end.
SPEED, REDUCTION = 1e-3, 0.4


def pressed(cells, factor):
    """Return the upper half of the ring, so many ``cells`` high, with the friction ``factor`` m."""
    cell, speed = HALF / cells, SPEED * float(np.sqrt(YOUNG / DENSITY))
    end = 1.02 * REDUCTION * HALF / speed
    motion = {"velocity": [[0.0, 0.0, 0.0], [0.04 * end, 0.0, -speed], [end, 0.0, -speed]]}
    contact = {"friction_law": "mohr_coulomb", "mohr_coulomb": {"cohesion": factor * YIELD / 3.0**0.5}}
    bodies = {
        "ring": rectangle(INNER, 0.0, OUTER, HALF, sides=fixed(bottom="y")),
        "platen": rectangle(-0.5, HALF, 2.0 * OUTER, 1.5, rigid={"motion": motion}),
    }
    return scene(
        *(cell, [0.0, -4.0 * cell], [1.6 * OUTER, 1.8 * HALF], end, end / 40.0),
        *(elastic(DENSITY, YOUNG, 0.3, "j2", yield_stress=YIELD), bodies),
        grid={"axisymmetric": True},
        time={"outputs": "nearest"},
        contact=contact if factor else {},
        output={"surface": False},
    )


def upper_bound(factor, steps=100):
    """Return reductions of the height, and the inner radius over that of the start.

    Avitzur (1968): of the fields v_r = (V / 2 H) (r − s / r) between platens that close at V, with ε̇ = V / H
    √(1 + s² / 3 r⁴), s takes the least power of plastic flow and of friction, m σ_y / √3 over both faces."""
    inner, outer, height = INNER, OUTER, 2.0 * HALF
    reductions, radii = [0.0], [1.0]
    x, weight = np.polynomial.legendre.leggauss(64)
    for _ in range(steps):
        r = inner + 0.5 * (outer - inner) * (x + 1.0)

        def power(s, r=r, height=height):
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


def inner_radius(tree, factor):
    """Return the error [%] of the inner radius, a mean over the height, at the end."""
    points = tree["particles/ring"].to_dataset()
    start, last = points["position"].values[0], points["position"].values[-1]
    own = np.isclose(start[:, 0], start[:, 0].min())
    half = 0.25 * float(tree.attrs["cell_size"]) * points["deformation_gradient"].values[-1]
    face = (last[:, 0] - half[:, 0, 0])[own] / INNER
    top = int(last[:, 1].argmax())
    reduction = 1.0 - (last[top, 1] + half[top, 1, 1]) / HALF
    return 100.0 * float(face.mean() / float(np.interp(reduction, *upper_bound(factor))) - 1.0)


def place(at, cells, factor, limit, when="full"):
    """Return a place where the error [%] is at most the ``limit``."""
    return Place(at, make={"cells": cells, "factor": factor}, within={"mean": (-limit, limit)}, when=when)


both = [*methods(), *methods(["lcp"], bound=True, when="full")]
smooth = Runs(
    "smooth", pressed, [*both, *methods(shape=["gimp"])], [place("m = 0", 4, 0.0, 1.0)], when="full"
)
rough = Runs(
    "rough",
    pressed,
    both,
    [
        place("m = 0.1", 4, 0.1, 4.0, when=""),
        place("m = 0.2", 4, 0.2, 4.0),
        place("m = 0.2, finer", 8, 0.2, 4.0),
    ],
)


@each(smooth, rough)
def test_radius(run):
    quantity = f"inner radius against Avitzur's bound, error, {run.place.at}"
    run.gate(quantity, run.of(inner_radius, factor=run.place.make["factor"]), 0.0, None, "%", key="mean")
