"""[H17] figure 3: von Mises stress in the colliding rings, beside finite elements.

Reference: fine finite elements of ``mpmfw/reference`` (nine-node quadrilaterals of 0.5 mm), whose stresses and outlines
are shipped; the pictures beside the material points are of ``finite-elements/rings_fem``.
"""

# cost: 160

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))

from drawing import beside_finite_elements, histories
from rings import SCENE, STIFF
from rings_fem import collide
from stresses import TIMES, Stresses, outline_distance, reference_stresses, stresses_of

from mpmfw.validation import CONTACTS, SHAPES, Case, Method

POSITION = {"contact.bardenhagen.criterion": "position"}
VALUES = {"time.output_interval": "0.4 ms", "time.outputs": "exact", "output.energy": False}


def check(case: Case) -> None:
    """Stresses of every method against the fine finite elements, and the figure."""
    found: dict[Method, Stresses] = {}
    for method, tree in case.runs(_methods(case), SCENE, VALUES):
        found[method] = stresses_of(tree)
        _judge(case, method, found[method])
        case.show("outline, largest distance", outline_distance(tree), unit="mm", method=method)
    with case.timed():
        elements = collide(2e-3, end=TIMES[-1], times=TIMES)
    for snapshot in elements.snapshots[1:]:
        quantities = {"p95": snapshot.percentile(95.0), "mean": snapshot.mean}
        _rows(case, "finite elements, 4-node, 2 mm", snapshot.time, quantities, binds=False)
    recommended = next((method for method in found if method.recommended), None)
    if recommended is not None:
        case.figure("", beside_finite_elements(found[recommended], elements))
    if not case.quick:
        case.figure("methods", histories(found))


def _methods(case: Case) -> list[Method]:
    if case.quick:
        return case.methods()
    return [
        *case.methods(CONTACTS, SHAPES),
        *case.methods(("bardenhagen",), ("cpdi",), {"criterion position": POSITION}),
        *case.methods(("penalty",), ("cpdi", "cpdi2"), {"kappa 1": STIFF}),
    ]


def _judge(case: Case, method: Method, stresses: Stresses) -> None:
    for k, time in enumerate(TIMES[1:], start=1):
        quantities = {"p95": stresses.percentile(k, 95.0), "mean": stresses.mean(k)}
        _rows(case, method, time, quantities, binds=method.recommended)


def _rows(case: Case, method: Method | str, time: float, values: dict[str, float], binds: bool) -> None:
    """95th percentile to 10 %, mean to 15 % [Pa]."""
    exact = reference_stresses(time)
    for name, words, part in (("p95", "95th percentile", 0.10), ("mean", "mean", 0.15)):
        limits = ((1.0 - part) * exact[name], (1.0 + part) * exact[name])
        case.gate(
            f"von Mises stress, {words}, {1e3 * time:.1f} ms",
            1e-6 * values[name],
            within=limits,
            reference=exact[name],
            unit="MPa",
            method=method,
            binds=binds,
        )
