"""Steep friction: is the chatter of an undamped elastic block a fault of the contact, or the motion itself?

Closed form of the rigid block: a = g (sin θ - μ cos θ), or rest if tan θ < μ. Of the elastic one: eigenvalues
of the finite elements about steady sliding, and their motion, with springs and with impulses in their place.
"""

# cost: 340

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "finite-elements"))

from eigenvalues import CONTACTS, VISCOSITY, check_modes, lowest, modes_of, named
from measures import Measured, gravity_table, growth_of, of_elements, of_points, onset
from slider_fem import incline, slide

from mpmfw.validation import Case, Method, methods

if TYPE_CHECKING:
    from slider_fem import Slide

FRICTIONS, TILTS = (0.1, 0.3, 0.5, 0.7, 0.9), (10.0, 20.0, 30.0, 40.0, 50.0)  # of the map [1], [deg]
STEEP, FINER = 40.0, (0.3, 0.4, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75)  # round the onset [deg], [1]
CALM = 0.5  #: μ up to which the acceleration of the recommended combination must be right
CREEP = 1e-3  #: speed below which a block sticks [m/s]

MASTER = {"contact.bardenhagen.normal": "master"}
CLASSICAL = {
    "normal master": MASTER,
    "normal master, criterion position": {**MASTER, "contact.bardenhagen.criterion": "position"},
}
PIC_LABEL, PIC = "flip, 5 % pic", {"stepping.transfer": "flip", "stepping.pic_fraction": 0.05}
ONCE = {"time.output_interval": 0.0005, "time.end": 0.2}

Row = tuple[Method | str, list[Measured]]


def test_steep_friction(case: Case) -> None:
    """Judge eigenvalues, growth of small motions, motion over friction and tilt, and cures."""
    check_modes(case)
    check_growth(case)
    check_onset(case)
    check_cures(case)
    if not case.quick:
        check_map(case)


def check_growth(case: Case) -> list[tuple[str, float, float]]:
    """Judge the growth of the bounce against the eigenvalue, of elements and of mpmfw."""
    grown: list[tuple[str, float, float]] = []
    for contact, size, friction in (
        ("springs", 0.1, 0.3),
        ("springs", 0.05, 0.2),
        ("impulses", 0.1, 0.2),
        ("impulses", 0.05, 0.2),
    ):
        with case.timed():
            run = slide(
                size, friction, math.radians(STEEP), contact=contact, elastic=True, end=ONCE["time.end"]
            )
        _judge_growth(case, named(contact, size), run.time, run.y, size, friction, contact)
    for size, friction in ((0.1, 0.3),) if case.quick else ((0.1, 0.3), (0.05, 0.2), (0.05, 0.3)):
        method = _penalty(size)
        for series in _bounces(case, method, friction):
            found = _judge_growth(case, method, *series, size, friction, "springs")
            grown.append((f"{size:g}", friction, found))
    if not case.quick:
        _show_other_growth(case)
    return grown


def _show_other_growth(case: Case) -> None:
    """The growth with other contacts and with PIC, beside the eigenvalue of the gaps that they keep."""
    for contact, label, values, kind in (
        ("bardenhagen", "normal master", MASTER, "impulses"),
        ("penalty", PIC_LABEL, PIC, "springs"),
    ):
        for size in (0.1, 0.05):
            method = _sized(contact, label, size, values)
            rate, near = lowest(modes_of(incline(size, elastic=True), 0.3, kind))
            for time, y in _bounces(case, method, 0.3):
                sigma, frequency = growth_of(time, y, near)
                for said, value, reference, unit in (
                    ("growth", sigma, rate, "1/s"),
                    ("frequency", frequency, near, "Hz"),
                ):
                    quantity = f"{said} of the bounce at mu = 0.3, 40 deg"
                    case.show(quantity, value, reference, unit=unit, method=method)


def _bounces(case: Case, method: Method, friction: float) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Time [s] and height of the block's centre [m] over the first 0.2 s."""
    for _, tree in case.runs([method], set={**_scene(friction, STEEP), **ONCE}):
        series = tree["series"].to_dataset()
        yield series["time"].values, series["centre_of_mass"].sel(body="block", axis="y").values


def _judge_growth(
    case: Case,
    method: Method | str,
    time: np.ndarray,
    y: np.ndarray,
    size: float,
    friction: float,
    contact: str,
) -> float:
    rate, frequency = lowest(modes_of(incline(size, elastic=True), friction, contact))
    found = growth_of(time, y, frequency)
    label = f"the bounce at mu = {friction:g}, 40 deg"
    case.gate(f"growth of {label}", found[0], rate, (0.9 * rate, 1.1 * rate), "1/s", method)
    case.gate(
        f"frequency of {label}",
        found[1],
        tolerance=(0.98 * frequency, 1.02 * frequency),
        reference=frequency,
        unit="Hz",
        method=method,
    )
    return found[0]


def check_onset(case: Case) -> list[Row]:
    """The acceleration over friction at 40 degrees, and from where on it is wrong by more than 1 %."""
    frictions = (0.3, 0.5, 0.7) if case.quick else FINER
    rows: list[Row] = []
    onsets = []
    for contact in CONTACTS:
        for size in (0.1,) if case.quick else (0.1, 0.05):
            found = _elements(case, contact, size, [(mu, STEEP) for mu in frictions])
            rows.append((named(contact, size), found))
            onsets.append(onset(found))
            case.show("onset: least mu with an error above 1 %, 40 deg", onsets[-1], method=rows[-1][0])
    for size in (0.1,) if case.quick else (0.1, 0.05):
        method = _penalty(size)
        found = _points(case, method, [(mu, STEEP) for mu in frictions])
        rows.append((method, found))
        if not case.quick:
            case.gate(
                "onset: least mu with an error above 1 %, 40 deg",
                onset(found),
                method=method,
                tolerance=(min(onsets) - 0.051, max(onsets) + 0.051),
                reference=f"{min(onsets):g} to {max(onsets):g}",
            )
    return rows


def check_cures(case: Case) -> list[Row]:
    """Judge viscosity of the solid, PIC and the flat body's normal, which end the chatter, and dashpots."""
    steep = [(0.7, STEEP), (0.9, 50.0)]
    for size in (0.1,) if case.quick else (0.1, 0.05):
        found = _elements(case, "springs", size, steep, viscosity=VISCOSITY)
        for one in found:
            case.gate(_error_at(one), one.error, 0.0, (-1.0, 1.0), "%", f"{named('springs', size)}, viscous")
    rows: list[Row] = []
    cures: Sequence[tuple[str, str, dict[str, Any], tuple[float, float] | None]] = (
        ("penalty", PIC_LABEL, PIC, (-2.0, 2.0)),
        *(("bardenhagen", label, values, None) for label, values in CLASSICAL.items()),
        ("penalty", "damping 1", {"contact.penalty.damping": 1.0}, None),
    )
    for contact, label, values, within in cures[:1] if case.quick else cures:
        for size in (0.1,) if case.quick else (0.1, 0.05):
            method = _sized(contact, label, size, values)
            frictions = (0.5, 0.6) if label in (PIC_LABEL, "normal master") and size == 0.05 else ()
            found = _points(case, method, [*steep, *((mu, STEEP) for mu in frictions)])
            for one in found[:2]:
                limits: dict[str, Any] = {"reference": 0.0, "unit": "%", "method": method}
                if within:
                    case.gate(_error_at(one), one.error, tolerance=within, **limits)
                else:
                    case.show(_error_at(one), one.error, tolerance=(-2.0, 2.0), **limits)
            if frictions:
                rows.append((method, [one for one in found if one.tilt < math.radians(45.0)]))
    return rows


def check_map(case: Case) -> list[Row]:
    """Stick and slide over friction and tilt, with springs, impulses, penalty and the classical contacts."""
    at = [(mu, tilt) for mu in FRICTIONS for tilt in TILTS]
    rows: list[Row] = []
    every = [
        *CONTACTS,
        *methods(settings={"": {}, PIC_LABEL: PIC}),
        *methods(("bardenhagen",), settings={"": {}, **CLASSICAL}),
    ]
    for method in every:
        with case.timed():
            if isinstance(method, Method):
                row: Row = (method, _points(case, method, at))
            else:
                row = (named(method, 0.05), _elements(case, method, 0.05, at))
        _judge_map(case, *row)
        rows.append(row)
    return rows


def _judge_map(case: Case, method: Method | str, found: list[Measured]) -> None:
    """Creep, acceleration below the onset, and the cone, over the cells of one method's map."""
    sticks = [one.speed for one in found if not one.slides]
    calm = [one.error for one in found if one.slides and one.friction <= CALM]
    judge = case.gate if isinstance(method, Method) and method.recommended else case.show
    for quantity, value, within, unit, reference in (
        ("largest creep of a block that sticks", 1e3 * max(sticks), (0.0, 1e3 * CREEP), "mm/s", "0"),
        (f"largest error of the acceleration, mu <= {CALM:g}", max(calm, key=abs), (-1.0, 1.0), "%", "0"),
        ("largest T / (mu N)", max(one.ratio for one in found), (0.0, 1.001), "", "at most 1"),
    ):
        judge(f"map: {quantity}", value, tolerance=within, unit=unit, reference=reference, method=method)
    right = sum(one.speed < CREEP if not one.slides else abs(one.error) <= 1.0 for one in found)
    case.show("map: cells that stick, or slide within 1 %", right, reference=len(found), method=method)


def _elements(
    case: Case, contact: str, size: float, at: Sequence[tuple[float, float]], viscosity: float = 0.0
) -> list[Measured]:
    found = []
    with case.timed():
        for friction, tilt in at:
            run: Slide = slide(
                size, friction, math.radians(tilt), contact=contact, elastic=True, viscosity=viscosity
            )
            found.append(of_elements(friction, math.radians(tilt), run))
    return found


def _points(case: Case, method: Method, at: Sequence[tuple[float, float]]) -> list[Measured]:
    found = []
    for friction, tilt in at:
        for _, tree in case.runs([method], set=_scene(friction, tilt)):
            found.append(of_points(friction, math.radians(tilt), tree["series"].to_dataset()))
    return found


def _scene(friction: float, tilt: float) -> dict[str, Any]:
    table = {"table": gravity_table(math.radians(tilt))}
    return {"contact.friction": friction, "gravity": table, "output.particles": False}


def _penalty(size: float) -> Method:
    return _sized("penalty", "", size, {})


def _sized(contact: str, label: str, size: float, values: dict[str, Any]) -> Method:
    """A method at a cell size; the size is part of the label unless it is the scene's."""
    told = ", ".join(filter(None, (label, f"h = {size:g}" if size != 0.1 else "")))
    return methods((contact,), settings={told: {**values, "grid.cell_size": size}})[0]


def _error_at(one: Measured) -> str:
    return f"error of the acceleration at mu = {one.friction:g}, {math.degrees(one.tilt):.0f} deg"
