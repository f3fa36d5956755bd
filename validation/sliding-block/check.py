"""Sliding block: acceleration and friction force against Coulomb's law, for every method.

Closed form, of a rigid block under Coulomb friction (any textbook of mechanics): along the incline
m a = m g sin θ − μ N with N = m g cos θ, so a = g (sin θ − μ cos θ) = 2.402 m/s², and T = μ N.
"""

# cost: 70

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from figure import draw
from normals import steepest_tilt

from mpmfw.analysis import fitted_acceleration
from mpmfw.validation import CONTACTS, SHAPES, Case, Method

if TYPE_CHECKING:
    import xarray as xr

TILT, FRICTION, GRAVITY = math.radians(30.0), 0.3, 10.0  # [rad], [1], [m/s²]
ACCELERATION = GRAVITY * (math.sin(TILT) - FRICTION * math.cos(TILT))  # [m/s²]
NORMAL_FORCE = 1000.0 * 0.6 * 0.3 * GRAVITY * math.cos(TILT)  # [N/m]
#: The share of the motion that is judged: the start, when the tilt is sudden, is left out.
FROM = 0.2

CLASSICAL = {
    "criterion position": {"contact.bardenhagen.criterion": "position"},
    "normal master": {"contact.bardenhagen.normal": "master"},
    "normal specified": {
        "contact.bardenhagen.normal": "specified",
        "contact.bardenhagen.direction": [0.0, -1.0],
    },
    "normal specified, criterion position": {
        "contact.bardenhagen.normal": "specified",
        "contact.bardenhagen.direction": [0.0, -1.0],
        "contact.bardenhagen.criterion": "position",
    },
}
#: Height of the interface over a grid line, in cells of 0.1 m; the scene's is 0.13.
HEIGHTS = {"interface on a grid line": 0.0, "interface in mid-cell": 0.5}
#: [H17] with increments that add up below Coulomb's cap, and to the letter.
HAMAD = {"": {}, "literal": {"contact.hamad2017.friction_law": "literal"}}


def check(case: Case) -> None:
    """Run every contact strategy with every shape function, classical contact in its stronger forms too."""
    shapes = ("cpdi", "cpdi2") if case.quick else SHAPES
    methods = case.methods(CONTACTS, shapes)
    if not case.quick:
        methods += case.methods(("bardenhagen",), SHAPES, CLASSICAL)
        heights = {label: _interface_at(0.1 * height) for label, height in HEIGHTS.items()}
        methods += case.methods(("bardenhagen", "penalty"), ("cpdi",), heights)
        methods += case.methods(("hamad2017",), ("cpdi",), HAMAD)
    values = {"output.particles": False} | ({"time.end": 0.5} if case.quick else {})
    results = {}
    for method, tree in case.runs(methods, set=values):
        series = tree["series"].to_dataset()
        _judge(case, method, series)
        results[method] = series
    with case.timed():
        for label, height in {"interface as in the scene": 0.13, **HEIGHTS}.items():
            case.show(
                f"steepest averaged normal at the leading corner, {label}",
                steepest_tilt(height),
                unit="deg",
                reference=f"locks above {math.degrees(TILT - math.atan(FRICTION)):.1f}",
            )
    case.figure("", draw(results, ACCELERATION, acceleration))


def acceleration(series: xr.Dataset) -> float:
    """Fitted to the motion of the block's centre [m/s²]."""
    time = series["time"].values
    x = series["centre_of_mass"].sel(body="block", axis="x").values
    return fitted_acceleration(time, x - x[0], FROM * time[-1], time[-1])


def _judge(case: Case, method: Method, series: xr.Dataset) -> None:
    error = 100.0 * (acceleration(series) / ACCELERATION - 1.0)
    limits = {"within": (-0.5, 0.5), "unit": "%", "reference": 0.0}
    case.judge(method, "fitted acceleration, error", error, **limits)
    if "contact_force" not in series:
        return  # none: what one velocity field exchanges is not told from internal force
    time = series["time"].values
    force = series["contact_force"].sel(pair="block-plane")[time > FROM * time[-1]].mean("time")
    tangential, normal = -float(force.sel(axis="x")), float(force.sel(axis="y"))
    case.judge(method, "mean T / (mu N), error", 100.0 * (tangential / (FRICTION * normal) - 1.0), **limits)
    case.show("mean N / (m g cos theta)", normal / NORMAL_FORCE, reference=1.0, method=method)


def _interface_at(height: float) -> dict[str, object]:
    """Both bodies moved, so that their interface is at ``height`` [m]."""
    block = {"type": "rectangle", "lower": [0.03, height], "upper": [0.63, height + 0.3]}
    plane = {"type": "rectangle", "lower": [-0.4, height - 0.213], "upper": [3.2, height]}
    return {"bodies.block.geometry": block, "bodies.plane.geometry": plane}
