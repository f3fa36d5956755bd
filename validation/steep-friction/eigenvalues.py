"""Eigenvalues of the finite elements about steady sliding: growth over friction and element size."""

import numpy as np
from slider_fem.bodies import Incline, incline
from slider_fem.flutter import growth, slide_steadily

from mpmfw.validation import Case

CONTACTS = ("springs", "impulses")
#: Where eigenvalues are sought [1]; 0.3 and 0.9 alone with the finest elements.
FRICTIONS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 0.9)
#: The first modes, of rocking and shear, couple at 63 to 76 Hz, the next ones at 110 Hz and above [Hz].
LOWEST = 95.0
#: β of the viscous solid [s]: a loss factor of 0.28 at the 75 Hz of the lowest mode that flutters.
VISCOSITY = 6e-4
QUANTITY = "growth of the lowest mode, mu = 0.3"


def check_modes(case: Case) -> None:
    """Record the growth rate of the lowest mode that flutters, over friction."""
    sizes = (0.1, 0.05) if case.quick else (0.1, 0.05, 1.0 / 30.0)
    rates: dict[tuple[str, float], np.ndarray] = {}
    for size in sizes:
        bodies = incline(size, elastic=True)
        frictions = (0.3,) if case.quick else FRICTIONS if size > 0.04 else (0.3, 0.9)
        for contact in CONTACTS:
            method = named(contact, size)
            with case.timed():
                found = {friction: modes_of(bodies, friction, contact) for friction in (0.0, *frictions)}
            quiet = len(found[0.0])
            case.gate("growing modes without friction", quiet, tolerance=(0, 0), reference=0, method=method)
            sigma, frequency = lowest(found[0.3])
            case.show(QUANTITY, sigma, unit="1/s", method=method)
            case.show("its frequency", frequency, unit="Hz", method=method)
            fastest = float(found[0.3][:, 0].max())
            case.show("growth of the fastest mode, mu = 0.3", fastest, unit="1/s", method=method)
            rates[contact, size] = np.array([(mu, lowest(modes)[0]) for mu, modes in found.items()])
    _check_limit(case, rates, *sizes[-2:])
    if not case.quick:
        _show_damping(case)


def _check_limit(case: Case, rates: dict[tuple[str, float], np.ndarray], coarse: float, fine: float) -> None:
    """The growth has a limit as the elements become smaller, and the springs, κ M l/h, have it too."""

    def at(contact: str, size: float) -> float:
        mu, sigma = rates[contact, size].T
        return float(sigma[np.isclose(mu, 0.3)][0])

    change = at("impulses", fine) / at("impulses", coarse) - 1.0
    line = (fine * at("springs", coarse) - coarse * at("springs", fine)) / (fine - coarse)  # at h = 0
    for said, value, method in (
        ("change by finer elements", change, "finite elements, no springs"),
        ("springs to h = 0 against none", line / at("impulses", fine) - 1.0, "finite elements"),
    ):
        case.gate(f"{QUANTITY}, {said}", 100.0 * value, 0.0, (-5.0, 5.0), "%", method)


def _show_damping(case: Case) -> None:
    """What dashpots across the faces, and a viscous solid, leave of the growth."""
    for size in (0.1, 0.05):
        bodies = incline(size, elastic=True)
        for said, how in (("dashpots of 1", {"damping": 1.0}), ("viscous", {"viscosity": VISCOSITY})):
            with case.timed():
                modes = growth(bodies, 0.3, **how)
            case.show(QUANTITY, lowest(modes)[0], unit="1/s", method=f"{named('springs', size)}, {said}")


def modes_of(bodies: Incline, friction: float, contact: str) -> np.ndarray:
    """(n, 2) σ and f of the modes that grow, about sliding with those nodes in contact that then bear."""
    rigid = contact == "impulses"
    pressed = slide_steadily(bodies, friction, rigid_contact=rigid).pressed
    return growth(bodies, friction, rigid_contact=rigid, pressed=pressed)


def lowest(modes: np.ndarray) -> tuple[float, float]:
    """σ and f of the growing mode below :data:`LOWEST`; (0, 0) if there is none."""
    below = modes[modes[:, 1] < LOWEST]
    return (float(below[0, 0]), float(below[0, 1])) if len(below) else (0.0, 0.0)


def named(contact: str, size: float) -> str:
    """The finite elements' name in the table."""
    return f"finite elements, {'springs' if contact == 'springs' else 'no springs'}, {1e3 * size:.3g} mm"
