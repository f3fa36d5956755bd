"""Balanced two-pass contact against master and slave: symmetry, force noise, accuracy, contact stress, cost."""

# cost: 60

from __future__ import annotations

from drawing import draw
from questions import (
    BLOCK,
    RINGS_SERIES,
    ROLLING_FINE,
    STRESS,
    Points,
    cost_of,
    points_of,
    rings_noise,
    rolling_noise,
    segments,
)
from rings import SCENE, measures_of
from rolling import NO_SLIP, SLIP, Roll, measures, motion_of
from sliding import acceleration_error, friction_error
from symmetry import mirror_errors

from mpmfw.fields import FloatArray
from mpmfw.validation import Case, Method

MIRROR = 0.01  #: largest mirror error with two passes [h], from the list of benchmarks
#: What the surfaces of the two blocks are made of, in cells: like meshes, and one four times as coarse.
MESHES = {
    "like segments": {},
    "upper segments h": segments(1.0, "upper"),
    "upper segments 2h": segments(2.0, "upper"),
}


def check(case: Case) -> None:
    """Every scene with two passes and with either body as master."""
    mirrors = _rings(case)
    if not case.quick:
        for roll in (NO_SLIP, SLIP):
            _rolling(case, roll)
        _sliding(case)
    stresses = _stress(case)
    case.figure("", draw(mirrors, stresses))


def passes(case: Case, *bodies: str) -> list[Method]:
    """Two passes, and one with each of the bodies as master."""
    settings = {f"one pass, master {body}": {"contact.penalty.passes": "one"} for body in bodies}
    for body in bodies:
        settings[f"one pass, master {body}"]["contact.penalty.master"] = body
    return case.methods(settings={"": {}, **settings})


def _rings(case: Case) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Rows of the rings; times [s] and mirror errors [h] by label."""
    curves = {}
    values = {**RINGS_SERIES, "time.end": "0.4 ms"} if case.quick else RINGS_SERIES
    for method, tree in case.runs(passes(case, "left", "right"), SCENE, values):
        found = measures_of(tree)
        within = (0.0, MIRROR)
        case.judge(method, "rings: mirror error", found["mirror"], within=within, unit="h", reference=0.0)
        case.show("rings: noise of the force", rings_noise(tree), unit="%", method=method)
        if not case.quick:
            case.show(
                "rings: impulse curve, largest error", found["impulse_curve_error"], unit="%", method=method
            )
            case.show("rings: force over 100 us, L2 error", found["force_error_100us"], method=method)
            case.show("rings: largest penetration", found["largest_penetration"], unit="h", method=method)
        _cost(case, method, "rings", cost_of(tree))
        curves[method.label] = mirror_errors(tree)
    return curves


def _rolling(case: Case, roll: Roll) -> None:
    for method, tree in case.runs(passes(case, "cylinder", "plane"), roll.scene, ROLLING_FINE):
        found = measures(motion_of(tree), roll)
        for name in ("displacement", "acceleration", "spin"):
            case.show(
                f"rolling, {roll.name}: {name}, error", found[name], unit="%", reference=0.0, method=method
            )
        case.show(
            f"rolling, {roll.name}: noise of the normal force", rolling_noise(tree), unit="%", method=method
        )
        case.show(f"rolling, {roll.name}: mean penetration", found["penetration"], unit="h", method=method)
        _cost(case, method, f"rolling, {roll.name}", cost_of(tree))


def _cost(case: Case, method: Method, scene: str, cost: dict[str, float]) -> None:
    case.show(f"{scene}: CPU time of a step", 1e3 * cost["cpu"] / cost["steps"], unit="ms", method=method)
    case.show(f"{scene}: share of contact", 100.0 * cost["contact"] / cost["cpu"], unit="%", method=method)


def _sliding(case: Case) -> None:
    for method, tree in case.runs(passes(case, "block", "plane"), BLOCK, {"output.particles": False}):
        series = tree["series"].to_dataset()
        error = acceleration_error(series)
        case.show("sliding block: fitted acceleration, error", error, unit="%", reference=0.0, method=method)
        error = friction_error(series)
        case.show("sliding block: T / (mu N), error", error, unit="%", reference=0.0, method=method)


def _stress(case: Case) -> dict[tuple[str, str], Points]:
    """Rows of the two blocks; their points by mesh and label."""
    found = {}
    for mesh in ("upper segments 2h",) if case.quick else MESHES:
        for method, tree in case.runs(passes(case, "lower", "upper"), STRESS, MESHES[mesh]):
            points = points_of(tree)
            found[mesh, method.label] = points
            case.show(
                f"blocks, {mesh}: largest departure of σ_yy",
                points.oscillation(),
                unit="%",
                reference=0.0,
                method=method,
            )
    return found
