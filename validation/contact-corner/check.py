"""Free expansion at a contact corner: slope of the sides' displacement over the strain, for every method.

Closed form, plane strain between frictionless bodies: σ_xx = 0 everywhere, hence each side moves outwards by
ν W ε / (2 (1 − ν)) at every height, at the corners too.
"""

# cost: 100

from __future__ import annotations

from expansion import PLACES, Expansion, expansion_of, placed
from figures import expansion_figure, size_figure

from mpmfw.validation import SHAPES, Case
from mpmfw.validation.case import Method

LIMIT = 5.0  #: [%]
SCENE = 0.5e-3  #: cell size [m]: 20 cells across the block
SIZES = (1e-3, 0.7e-3, SCENE)
OFFSET, OFFSETS = 0.23, (0.0, 0.5, 0.75)  #: of the block's left side past a grid line [cells]
MASTER = {"contact.bardenhagen.normal": "master"}
STRONGEST = {**MASTER, "contact.bardenhagen.criterion": "position"}
SLOW = {
    "time.end": 20e-3,
    "time.output_interval": 0.4e-3,
    "bodies.bottom.sides": [{"side": "bottom", "velocity": [0.0, 0.005]}],
    "bodies.top.sides": [{"side": "top", "velocity": [0.0, -0.005]}],
}


def check(case: Case) -> None:
    """Every method; half the speed; sub-cell offsets and cell sizes."""
    results: dict[str, Expansion] = {}
    for method, tree in case.runs(_methods(case), set=placed(SCENE, OFFSET)):
        results[str(method)] = found = expansion_of(tree)
        _judge(case, method, found)
        case.show("kinetic over strain energy, at most", 100.0 * found.energy_ratio, unit="%", method=method)
    if not case.quick:
        _half_speed(case, results["penalty, cpdi"])
        case.figure("", expansion_figure(results))
        case.figure("cell-size", size_figure(_offsets_and_sizes(case, results["penalty, cpdi"])))


def _methods(case: Case) -> list[Method]:
    if case.quick:
        return case.methods(shape=("cpdi",))
    classical = {"stiffer body's normal": MASTER, "stiffer body's normal, position": STRONGEST}
    return [
        *case.methods(("penalty", "bardenhagen"), SHAPES),
        *case.methods(("bardenhagen",), ("cpdi", "gimp"), classical),
        *case.methods(("none",), SHAPES),
    ]


def _judge(case: Case, method: Method, found: Expansion, at: str = "") -> None:
    for name, height in PLACES.items():
        error = found.slope_error(height)
        case.judge(
            method, f"slope, {name}, error{at}", error, within=(-LIMIT, LIMIT), unit="%", reference=0.0
        )


def _half_speed(case: Case, at_speed: Expansion) -> None:
    """Loading is slow enough if half the speed gives the same slopes."""
    for method, tree in case.runs(case.methods(), set={**placed(SCENE, OFFSET), **SLOW}):
        slow = expansion_of(tree)
        for name, height in PLACES.items():
            change = 100.0 * (slow.slope(height) / at_speed.slope(height) - 1.0)
            case.show(
                f"slope, {name}, change at half the speed", change, unit="%", method=method, reference=0.0
            )
        case.show(
            "kinetic over strain energy, at half the speed",
            100.0 * slow.energy_ratio,
            unit="%",
            method=method,
        )


def _offsets_and_sizes(case: Case, known: Expansion) -> dict[tuple[float, float], Expansion]:
    """Penalty with CPDI at other places within a cell (gated at the scene's cell size) and other cell sizes (shown)."""
    method = case.methods()[0]
    found = {(SCENE, OFFSET): known}
    for size in SIZES:
        for offset in OFFSETS if size == SCENE else (OFFSET, *OFFSETS):
            for _, tree in case.runs([method], set=placed(size, offset)):
                found[size, offset] = expansion_of(tree)
                _rows(case, method, found[size, offset], size, offset)
    return found


def _rows(case: Case, method: Method, found: Expansion, size: float, offset: float) -> None:
    at = f", h = {1e3 * size:g} mm, side at {offset:g} h"
    if size == SCENE:
        _judge(case, method, found, at)
        return
    worst = max((found.slope_error(height) for height in PLACES.values()), key=abs)
    case.show(
        f"slope, worst error{at}", worst, within=(-LIMIT, LIMIT), unit="%", method=method, reference=0.0
    )
