"""How to damp the oscillations of an impact's contact force, the third open question of [H17]'s conclusions.

No closed form: force and energy of the shipped rings for contact damping, springs and transfers, beside finite elements
without any damping.
"""

# cost: 190

from __future__ import annotations

from typing import Any

from drawing import against_loss, histories
from noise import Found, found_of, of_finite_elements
from rings import REBOUND, SCENE, particles_of

from mpmfw.validation import Case, Method

ZETA, KAPPA, TRANSFER = "contact.penalty.damping", "contact.penalty.kappa", "stepping.transfer"
HALF = {f"bodies.{body}.segment": "0.5 cells" for body in ("left", "right")}

VARIANTS: dict[str, dict[str, Any]] = {
    "": {},
    "damping 0.1": {ZETA: 0.1},
    "damping 0.3": {ZETA: 0.3},
    "damping 1": {ZETA: 1.0},
    "kappa 0.1": {KAPPA: 0.1},
    "kappa 0.1, damping 1": {KAPPA: 0.1, ZETA: 1.0},
    "kappa 1": {KAPPA: 1.0},
    "kappa 1, damping 0.3": {KAPPA: 1.0, ZETA: 0.3},
    "kappa 1, damping 1": {KAPPA: 1.0, ZETA: 1.0},
    "flip": {TRANSFER: "flip"},
    "flip, 1 % pic": {TRANSFER: "flip", "stepping.pic_fraction": 0.01},
    "flip, 5 % pic": {TRANSFER: "flip", "stepping.pic_fraction": 0.05},
    "flip, 10 % pic": {TRANSFER: "flip", "stepping.pic_fraction": 0.1},
    "apic": {TRANSFER: "apic"},
    "tpic": {TRANSFER: "tpic"},
    "pic": {TRANSFER: "pic"},
    "apic, damping 1": {TRANSFER: "apic", ZETA: 1.0},
    "segments of 0.5 h": HALF,
}
COARSER = particles_of("0.5 cells")
#: The answer again with a quarter of the material points.
POINTS = {"points of 1 mm": COARSER, "points of 1 mm, damping 1": {**COARSER, ZETA: 1.0}}
QUICK = ("", "damping 1", "apic")
VALUES = {"output.particles": False, "output.surface": False, "output.ledger": True}


def check(case: Case) -> None:
    """Run every variant with CPDI; nothing but sanity is gated."""
    variants = {label: VARIANTS[label] for label in QUICK} if case.quick else {**VARIANTS, **POINTS}
    values = {**VALUES, **COARSER} if case.quick else VALUES
    elements = {run: of_finite_elements(run) for run in ("fine", "coarse")}
    for run, size in (("fine", "0.5 mm"), ("coarse", "2 mm")):
        _force_rows(case, f"finite elements, {size}, no damping", elements[run])
    results: dict[str, Found] = {}
    for method, tree in case.runs(case.methods(settings=variants), SCENE, values):
        results[method.label] = found_of(tree)
        _rows(case, method, results[method.label])
    drawn = {label: found for label, found in results.items() if label not in POINTS}
    case.figure("", against_loss(drawn, elements))
    case.figure("force", histories(drawn, elements["fine"]))


def _rows(case: Case, method: Method, found: Found) -> None:
    """Sanity as gates of the scene as it is shipped, and of the sign of damping; all else is shown."""
    _force_rows(case, method, found)
    for quantity, value in (
        ("energy lost, of the start", found.lost),
        ("of it in contact dashpots", found.damping),
        ("of it in the transfer", found.transfer),
    ):
        case.show(quantity, 100.0 * value, unit="%", reference=0.0, method=method)
    case.show("rebound velocity", found.rebound, unit="m/s", reference=REBOUND, method=method)
    case.judge(method, "drift of linear momentum", found.momentum, within=(0.0, 1e-12), reference=0.0)
    case.judge(method, "(energy + dissipation) / E0, most", found.most, within=(0.0, 1.005), reference=1.0)
    if "damping" in method.label:
        least = found.least_damping
        case.gate("least increment of damping work / E0", least, within=(-1e-12, 1.0), method=method)


def _force_rows(case: Case, method: Method | str, found: Found) -> None:
    fine = of_finite_elements("fine")
    case.show("force noise, beside 100 us", found.noise, method=method, reference=round(fine.noise, 4))
    case.show("force noise, beside 25 us", found.jitter, method=method, reference=round(fine.jitter, 4))
    case.show("force over 50 us, L2 error", found.errors[50], reference=0.0, method=method)
    case.show("force over 100 us, L2 error", found.errors[100], reference=0.0, method=method)
    case.show("force over 200 us, L2 error", found.errors[200], reference=0.0, method=method)
