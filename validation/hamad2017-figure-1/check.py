"""[H17] figure 1: displacement and velocity of the rolling cylinder, with slip and without, and its spin."""

# cost: 195

from __future__ import annotations

from collections.abc import Iterable

from drawing import all_shapes, as_published, spin_and_departure
from rolling import LUMPED, NO_SLIP, SERIES_ONLY, SLIP, Motion, Roll, measures, motion_of

from mpmfw.validation import CONTACTS, SHAPES, Case, Method

WITHOUT = "rotation = lumped"
TILTED = "settled under the tilted normal load"
#: g cos 60° towards the plane: nothing pulls along it while the cylinder settles [m/s²].
NORMAL_LOAD = {"settle.gravity": {"vector": [0.0, -5.0]}}

POSITION = {"contact.bardenhagen.criterion": "position"}
MASTER = {"contact.bardenhagen.normal": "master"}
#: Out of the cylinder, the pair's first body: the normal that the two surfaces really have.
SPECIFIED = {"contact.bardenhagen.normal": "specified", "contact.bardenhagen.direction": [0.0, -1.0]}
#: [H17] with increments that add up below Coulomb's cap, and to the letter.
HAMAD = {"": {}, "literal": {"contact.hamad2017.friction_law": "literal"}}

GAP, BEHIND = (0.5, 1.1), (-float("inf"), -3.0)  #: of classical contact [h], [%]


def check(case: Case) -> None:
    """Run both cases of the figure with every method."""
    slip = _slip(case)
    no_slip = _no_slip(case)
    case.figure("", as_published({SLIP: slip, NO_SLIP: no_slip}))
    case.figure("spin", spin_and_departure({SLIP: slip, NO_SLIP: no_slip}))
    if not case.quick:
        case.figure("shapes", all_shapes({SLIP: slip, NO_SLIP: no_slip}))


def _methods(case: Case) -> list[Method]:
    if case.quick:
        return case.methods(("penalty", "bardenhagen"))
    return [
        *case.methods(CONTACTS, SHAPES),
        *case.methods(("penalty",), ("cpdi", "cpdi2"), {WITHOUT: LUMPED}),
        *case.methods(("hamad2017",), ("cpdi",), HAMAD),
        *case.methods(("bardenhagen",), SHAPES, {"criterion = position": POSITION}),
        *case.methods(
            ("bardenhagen",),
            ("cpdi",),
            {"normal = master": MASTER, "position and specified normal": {**POSITION, **SPECIFIED}},
        ),
    ]


def _bound(method: Method, *labels: str) -> bool:
    """Whether gates of the penalty contact bind a method that is recommended but for its label."""
    return method.contact == "penalty" and method.shape in ("cpdi", "cpdi2") and method.label in ("", *labels)


def _classical(method: Method) -> bool:
    """Whether a method must show what [H17] reports of the classical contact."""
    return (method.contact, method.shape, method.label) == ("bardenhagen", "cpdi", "")


def _motions(
    case: Case, roll: Roll, methods: Iterable[Method]
) -> Iterable[tuple[Method, Motion, dict[str, float]]]:
    """Run; a method with a gate that fails is red, whatever its label."""
    chosen, done = list(methods), set()
    for method, tree in case.runs(chosen, roll.scene, SERIES_ONLY):
        done.add(method)
        motion = motion_of(tree)
        yield method, motion, measures(motion, roll)
    for method in chosen:
        if (
            method not in done
            and not method.recommended
            and (_bound(method, WITHOUT, TILTED) or _classical(method))
        ):
            case.failed(method, "no result, and gates bind it", binds=True)


def _slip(case: Case) -> dict[Method, Motion]:
    motions = {}
    for method, motion, found in _motions(case, SLIP, _methods(case)):
        motions[method] = motion
        binds = _bound(method, WITHOUT)
        spin = 12.0 if method.label == WITHOUT else 5.0
        _error(case, method, "slip: displacement at 10 m, error", found["displacement"], 2.0, binds)
        _error(case, method, "slip: fitted acceleration, error", found["acceleration"], 0.2, binds)
        _error(case, method, "slip: spin at 10 m, error", found["spin"], spin, binds)
        _angular(case, method, "slip", found)
        depth = found["penetration"]
        case.gate("slip: mean penetration", depth, within=(0.0, 0.03), unit="h", method=method, binds=binds)
        _as_reported(case, method, "slip", found)
    if not case.quick:
        _from_tilted_load(case)
    return motions


def _from_tilted_load(case: Case) -> None:
    """Start where the sudden tilt changes nothing normal to the plane."""
    methods = [
        *case.methods(("penalty",), ("cpdi", "cpdi2"), {TILTED: NORMAL_LOAD}),
        *case.methods(("bardenhagen",), ("cpdi",), {TILTED: NORMAL_LOAD}),
    ]
    for method, _, found in _motions(case, SLIP, methods):
        binds = _bound(method, TILTED)
        _error(case, method, "slip: displacement at 10 m, error", found["displacement"], 1.0, binds)
        _angular(case, method, "slip", found)


def _no_slip(case: Case) -> dict[Method, Motion]:
    motions = {}
    for method, motion, found in _motions(case, NO_SLIP, _methods(case)):
        motions[method] = motion
        limit = 2.5 if method.label == WITHOUT else 0.5
        binds = _bound(method, WITHOUT)
        _error(case, method, "no slip: displacement at 10 m, error", found["displacement"], limit, binds)
        for name in ("acceleration", "spin"):
            what = {"acceleration": "fitted acceleration", "spin": "spin at 10 m"}[name]
            case.show(f"no slip: {what}, error", found[name], unit="%", reference=0.0, method=method)
        _angular(case, method, "no slip", found)
        _as_reported(case, method, "no slip", found)
    return motions


def _error(case: Case, method: Method, what: str, value: float, limit: float, binds: bool) -> None:
    case.gate(what, value, within=(-limit, limit), unit="%", reference=0.0, method=method, binds=binds)


def _angular(case: Case, method: Method, name: str, found: dict[str, float]) -> None:
    what = f"{name}: fitted angular acceleration, error"
    case.show(what, found["angular acceleration"], unit="%", reference=0.0, method=method)


def _as_reported(case: Case, method: Method, name: str, found: dict[str, float]) -> None:
    """What [H17] reports of the classical contact, asserted of its plain form; of others the gap is shown."""
    if not _classical(method):
        case.show(f"{name}: gap at the end", found["gap"], unit="h", method=method)
        return
    reported = "fig. 1, 2 of [H17]"
    gap, behind = found["gap"], found["displacement"]
    case.gate(f"{name}: gap at the end", gap, within=GAP, unit="h", method=method, reference=reported)
    what = f"{name}: displacement behind, as published"
    case.gate(what, behind, within=BEHIND, unit="%", method=method, reference=reported)
