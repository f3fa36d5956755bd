"""Driven side: σ_yy of uniaxial strain in a block that its sides press together, wherever they lie in a cell.

Closed form: Neo-Hookean (`split`) at F = diag(1, 1 − ε).
"""

# cost: 60

from __future__ import annotations

import math
from typing import Any

import numpy as np
from xarray import DataTree

from mpmfw.fields import FloatArray
from mpmfw.validation import SHAPES, Case
from mpmfw.validation.case import Method

BULK, SHEAR, STRAIN = 12e6, 6e6, 0.1  # Pa, Pa, 1: as in scene.toml
SIZES, SCENE = (0.1, 0.05, 0.025), 0.1  # m
OFFSETS = (0.0, 0.3)  #: of the sides past a grid line [cells]
LIMIT = 2.0  #: [%]
TURN = math.radians(30.0)
CENTRE = 0.5  # m


def check(case: Case) -> None:
    """CPDI and CPDI2 at all sizes and offsets, the other shapes at one size, and the turned block."""
    for size in SIZES[:1] if case.quick else SIZES:
        for offset in OFFSETS:
            methods = case.methods(("",), ("cpdi",) if case.quick else ("cpdi", "cpdi2"))
            if size == SCENE and not case.quick:
                methods = case.methods(("",), SHAPES)
            for method, tree in case.runs(methods, set=placed(size, offset)):
                judge(case, method, tree, f"h = {size:g} m, sides at {offset:g} h")
    for size in SIZES[:1] if case.quick else SIZES[:2]:
        turned = {**placed(size, OFFSETS[-1]), "bodies.block.geometry.angle": TURN}
        for method, tree in case.runs(case.methods(("",), ("cpdi",)), set=turned):
            judge_turned(case, method, tree, size)


def placed(size: float, offset: float) -> dict[str, Any]:
    """Cell size [m], and a grid on whose lines the sides lie, or `offset` cells past one."""
    margin = math.ceil(0.5 / size) * size
    lower, upper = -margin - offset * size, 1.0 + margin + (1.0 - offset) * size
    return {"grid.cell_size": size, "grid.lower": [lower, lower], "grid.upper": [upper, upper]}


def exact() -> float:
    """σ_yy [Pa] at the last strain."""
    j = 1.0 - STRAIN
    return 0.5 * BULK * (j - 1.0 / j) + SHEAR * j ** (-5.0 / 3.0) * (j * j - (2.0 + j * j) / 3.0)


def stress(tree: DataTree, angle: float = 0.0) -> FloatArray:
    """Stress across the driven side over its closed form, at every point at the end."""
    n = np.array([-math.sin(angle), math.cos(angle)])
    found = tree["particles/block"]["stress"].isel(time=-1).values
    ratio: FloatArray = np.einsum("d,pde,e->p", n, found, n) / exact()
    return ratio


def judge(case: Case, method: Method, tree: DataTree, at: str) -> None:
    """Least and largest σ_yy."""
    found = 100.0 * (stress(tree) - 1.0)
    limits: dict[str, Any] = {"within": (-LIMIT, LIMIT), "unit": "%", "reference": 0.0}
    case.judge(method, f"least σ_yy, error, {at}", float(found.min()), **limits)
    case.judge(method, f"largest σ_yy, error, {at}", float(found.max()), **limits)


def judge_turned(case: Case, method: Method, tree: DataTree, size: float) -> None:
    """Mean, and extremes by the distance from sides as they are at the start."""
    at = f"turned by 30°, h = {size:g} m"
    found = 100.0 * (stress(tree, TURN) - 1.0)
    begin = tree["particles/block"]["position"].isel(time=0).values - CENTRE
    c, s = math.cos(TURN), math.sin(TURN)
    inside = 0.5 - np.abs(
        begin @ np.array([[c, -s], [s, c]])
    )  # distance from the nearer of two opposite sides
    near = inside < 3.0 * size
    limits: dict[str, Any] = {"unit": "%", "reference": 0.0, "method": method}
    case.gate(f"mean σ_yy, error, {at}", float(found.mean()), within=(-1.0, 1.0), **limits)
    worst = float(np.abs(found[~near.any(axis=1)]).max())
    case.gate(f"largest error farther than 3 h from sides, {at}", worst, within=(0.0, LIMIT), **limits)
    one = near.any(axis=1) & ~near.all(axis=1)
    case.show(f"largest error within 3 h of one side, {at}", float(np.abs(found[one]).max()), **limits)
    two = near.all(axis=1)
    case.show(f"largest error within 3 h of two, {at}", float(np.abs(found[two]).max()), **limits)
