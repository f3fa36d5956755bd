"""Two arms on one back that are pressed together: one body with contact of its own surface, or three that are
tied."""

from typing import Any

import numpy as np

import mpmfw
from mpmfw.scene import Scene

#: Lengths in thicknesses of an arm: of an arm, of the back along it, of the pad at its end, of the gap.
LONG, BACK, PAD, GAP = 5.0, 1.0, 1.25, 0.75
ARM, CLOSES, END = 0.4, 0.35, 0.8  #: thickness [m], way of the pads towards each other [m], time [s]


def upper(foot: float) -> list[list[float]]:
    """Return the outline of the upper arm from ``foot`` on [m], with its part of the back."""
    half, top, pad = 0.5 * GAP * ARM, (0.5 * GAP + 1.0) * ARM, (0.5 * GAP + 1.5) * ARM
    length, back, start = LONG * ARM, BACK * ARM, (LONG - PAD) * ARM
    corners = [[0.0, foot], [back, foot], [back, half], [length, half], [length, pad], [start, pad]]
    distinct = [place for k, place in enumerate(corners) if k == 0 or place != corners[k - 1]]
    return [*distinct, [start, top], [0.0, top]]


def mirrored(outline: list[list[float]]) -> list[list[float]]:
    """Return an outline on the other side of y = 0."""
    return [[x, -y] for x, y in outline[::-1]]


def arms(cells: int, joined: bool = True) -> dict[str, Any]:
    """Return arms of so many ``cells`` across; not ``joined`` they are tied to a piece of the back."""
    half, speed = 0.5 * GAP * ARM, 0.5 * CLOSES / END

    def body(outline: list[list[float]], *sides: dict[str, Any], **keys: Any) -> dict[str, Any]:
        geometry = {"type": "polygon", "points": outline}
        particles = {"size": "0.5 cells"}
        return {
            "material": "soft",
            "geometry": geometry,
            "particles": particles,
            "rotation": "lumped",
            "sides": sides,
            **keys,
        }

    down = {"side": "top", "velocity": [0.0, -speed]}
    up = {"side": "bottom", "velocity": [0.0, speed]}
    contact: dict[str, Any] = {"method": "penalty"}
    whole = upper(0.0)[1:]
    if joined:
        bodies = {"arms": body([*whole, *mirrored(whole)], up, down, self_contact=True)}
    else:
        arm, middle = upper(half), [[0.0, -half], [BACK * ARM, -half], [BACK * ARM, half], [0.0, half]]
        bodies = {"low": body(mirrored(arm), up), "high": body(arm, down), "back": body(middle)}
        contact["pairs"] = {f"{name}-back": {"method": "tied"} for name in ("low", "high")}
    return {
        "grid": {"cell_size": ARM / cells, "lower": [-0.6, -1.6], "upper": [2.6, 1.6]},
        "time": {"end": END, "output_interval": 0.04},
        "shape": {"method": "cpdi"},
        "contact": contact,
        "materials": {
            "soft": {
                "model": "neo_hookean",
                "density": 1000.0,
                "youngs_modulus": 1e6,
                "poissons_ratio": 0.3,
                "damping": {"bulk": "5 ms", "shear": "5 ms"},
            }
        },
        "bodies": bodies,
        "output": {"particles": False},
    }


def compare(scene: Scene) -> dict[str, float]:
    """Return what contact of one body differs in from that of tied bodies.

    ``force``: mean over the last third of the time in which they touch [%]; ``gap``: mean from half of the
    way on [cells]; ``early``: largest force before the tied ones touch, over the largest of all [%]."""
    given = scene.to_mapping()
    h = given["grid"]["cell_size"]
    apart = arms(round(ARM / h), joined=False)
    apart["contact"].update({key: given["contact"][key] for key in ("method",)})
    apart["shape"] = given["shape"]
    one, tied = (mpmfw.run(each)["series"].to_dataset() for each in (scene, apart))
    tied = tied.sel(pair="low-high")
    first, second = (np.abs(each["contact_force"].sel(axis="y").values.ravel()) for each in (one, tied))
    gaps = [each["min_gap"].values.ravel()[len(first) // 2 :] / h for each in (one, tied)]
    touching = np.flatnonzero(second > 0.0)
    late = touching[2 * len(touching) // 3 :]
    return {
        "force": 100.0 * float(first[late].sum() / second[late].sum() - 1.0),
        "gap": float(np.abs(np.minimum(gaps[1], gaps[0].max()) - gaps[0]).mean()),
        "early": 100.0 * float(first[: touching[0]].max() / first.max()),
    }
