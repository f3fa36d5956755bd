"""[H17] figure 4: total contact force of the colliding rings, its impulse, energies and symmetry.

Reference: fine finite elements of ``mpmfw/reference`` (nine-node quadrilaterals of 0.5 mm); its README says where the
tolerances come from. Exact: first contact after 4 mm / 60 m/s; linear momentum; mirror symmetry at x = 0.
"""

# cost: 290

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))

from drawing import Curves, curves_of, forces, impulse_and_energy, methods_compared
from judging import judge, show_briefly
from rings import SCENE, STIFF, measures_of, particles_of
from rings_fem import distance, regenerate
from rings_fem.collision import Collision

from mpmfw.validation import CONTACTS, SHAPES, Case, Method

#: The exact normal: by symmetry the rings meet at x = 0 only.
EXACT_NORMAL = {"contact.bardenhagen.normal": "specified", "contact.bardenhagen.direction": [1.0, 0.0]}
POSITION = {"contact.bardenhagen.criterion": "position"}
#: [H17] with the stiffness that the scene has for the penalty contact; friction of its increments added up, and to the letter.
AS_SHIPPED = {"contact.hamad2017.kappa": 0.25}
HAMAD = {
    "kappa 0.25": AS_SHIPPED,
    "kappa 0.25, literal": {**AS_SHIPPED, "contact.hamad2017.friction_law": "literal"},
}
FINER = {"grid.cell_size": "1 mm", **particles_of("0.5 cells")}
VALUES = {"output.particles": False}


def check(case: Case) -> None:
    """The shipped scene with every method, stiffer springs and finer cells at the same limits."""
    curves: dict[Method, Curves] = {}
    for method, tree in case.runs(_in_full(case), SCENE, VALUES):
        curves[method] = curves_of(tree)
        judge(case, method, measures_of(tree))
    if not case.quick:
        for method, tree in case.runs(_in_brief(case), SCENE, VALUES):
            curves[method] = curves_of(tree)
            show_briefly(case, method, measures_of(tree))
    with case.timed():
        elements = regenerate()
    _finite_elements(case, elements)
    case.figure("", forces(curves, elements))
    case.figure("impulse-energy", impulse_and_energy(curves, elements))
    if not case.quick:
        case.figure("methods", methods_compared(curves))


def _in_full(case: Case) -> list[Method]:
    """Methods all of whose rows are in the table: those that gates bind, and one change each."""
    if case.quick:
        return case.methods()
    return [
        *case.methods(("penalty",), ("cpdi", "cpdi2")),
        *case.methods(("penalty",), ("cpdi", "cpdi2"), {"kappa 1": STIFF}),
        *case.methods(
            ("penalty",), ("cpdi",), {"cells 1 mm": FINER, "cells 1 mm, kappa 1": {**FINER, **STIFF}}
        ),
    ]


def _in_brief(case: Case) -> list[Method]:
    """All other combinations of the shipped scene."""
    others = [method for method in case.methods(CONTACTS, SHAPES) if not method.recommended]
    return [
        *others,
        *case.methods(("bardenhagen",), SHAPES, {"criterion position": POSITION}),
        *case.methods(
            ("bardenhagen",), ("cpdi",), {"criterion position, exact normal": {**POSITION, **EXACT_NORMAL}}
        ),
        *case.methods(("hamad2017",), ("cpdi",), HAMAD),
    ]


def _finite_elements(case: Case, elements: Collision) -> None:
    """What another method of the same resolution gets; the case ``finite-elements`` judges it."""
    apart, method = distance(elements), "finite elements, 4-node, 2 mm"
    case.show("total impulse, error", 100.0 * apart.total, within=(-1.5, 1.5), unit="%", method=method)
    case.show(
        "impulse curve, largest error", 100.0 * apart.impulse, within=(0.0, 5.0), unit="%", method=method
    )
    case.show("force over 100 us, L2 error", apart.force, within=(0.0, 0.45), method=method)
    case.show(
        "kinetic energy, largest error", 100.0 * apart.kinetic, within=(0.0, 8.0), unit="%", method=method
    )
