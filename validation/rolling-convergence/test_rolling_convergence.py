"""Convergence of the rolling cylinder with the cell size: against the rigid cylinder and the elastic one."""
# cost: 440

import math

from drawing import convergence
from rolling import LUMPED, NO_SLIP, SERIES_ONLY, SLIP, errors, lumping_loss

from mpmfw.validation import CLASSICAL, Method, Place, Runs, each, methods, together

SIZES = (0.8, 0.4, 0.2, 0.1)  #: h [m]; particles h/2, segments h/4
PAPER, HALF = 0.4, 0.2
PARTICLE = 0.5  #: size of a material point [h]
WITHOUT = "rotation = lumped"
CORRECTED, UNCORRECTED = methods(settings={"": {}, WITHOUT: LUMPED})
#: The cylinder settles under the normal load that it will have on the tilted plane: g cos 60° [m/s²]. After a
#: sudden tilt its spin oscillates, and at one time shows the oscillation's phase rather than an error.
NORMAL_LOAD = {"settle.gravity": {"vector": [0.0, -5.0]}}
#: Departures of the converged elastic solution from the rigid cylinder [%]: see the README.
ELASTIC = {
    SLIP.name: {"displacement": 0.55, "acceleration": 0.0, "spin": -2.5, "angular acceleration": -1.25},
    NO_SLIP.name: {"acceleration": -0.2},
}
NAMES = {
    "displacement": "displacement at 10 m",
    "acceleration": "fitted acceleration",
    "spin": "spin at 10 m",
    "angular acceleration": "fitted angular acceleration",
}


def refined(roll, chosen, sizes, quick=0, when=""):
    """Return the runs of a roll at every size, the first ``quick`` of them in the reduced version as well."""
    places = [
        Place(f"{roll.name}, h = {h:g} m", {"grid.cell_size": h}, when="" if k < quick else "full")
        for k, h in enumerate(sizes)
    ]
    settings = {**SERIES_ONLY, **(NORMAL_LOAD if roll is SLIP else {})}
    binds = ["penalty, *"] if chosen[0].contact == "penalty" else []
    return Runs(roll.name, roll.scene, chosen, places, set=settings, binds=binds, when=when)


no_slip = refined(NO_SLIP, [CORRECTED, UNCORRECTED], SIZES, quick=2)
half = refined(NO_SLIP, methods(shape=["cpdi2"], settings={"": {}, WITHOUT: LUMPED}), [HALF], when="full")
slip = refined(SLIP, [CORRECTED], SIZES, when="full")
#: Classical contact to h = 0.2 m only.
classical_no_slip = refined(NO_SLIP, methods(CLASSICAL), SIZES[:3], quick=1)
classical_slip = refined(SLIP, methods(CLASSICAL), SIZES[:3], when="full")


def against(roll, key):
    """Return the reference of an error, in words."""
    elastic = ELASTIC[roll].get(key)
    return "rigid 0 %" if elastic is None else f"rigid 0 %, elastic {elastic:+g} %"


@each(no_slip, half, slip, classical_no_slip, classical_slip)
def test_errors(run):
    roll, size, penalty = run.runs, run.scene.grid.cell_size, run.method.contact == "penalty"
    limits = {"displacement": 1.0, "acceleration": 0.2, "spin": 5.0}
    if roll == NO_SLIP.name:
        lumped = 1.0 if size <= HALF else 2.5
        limits = {"displacement": lumped if run.method.label else 0.5}
    for key, what in NAMES.items():
        binds = penalty and roll == NO_SLIP.name and size in (PAPER, HALF) and key == "displacement"
        value, limit = run.of(errors, key, roll=roll), limits.get(key, math.inf)
        run.gate(f"{run.place.at}: {what}, error", value, against(roll, key), limit, "%", binds=binds)


@together(no_slip, slip, classical_no_slip, classical_slip)
def test_orders(case, runs):
    found: dict[tuple[str, Method], dict[float, dict[str, float]]] = {}
    for run in runs:
        own = found.setdefault((run.runs, run.method), {})
        own[run.scene.grid.cell_size] = errors(run.results, run.runs)
    lumping(case, found[NO_SLIP.name, CORRECTED], found[NO_SLIP.name, UNCORRECTED])
    case.figure("", convergence(found, ELASTIC, CORRECTED, UNCORRECTED, methods(CLASSICAL)))


def lumping(case, corrected, lumped):
    """Record the loss by lumping beside its closed form, its order, and the lumped error."""
    loss = {h: corrected[h]["acceleration"] - lumped[h]["acceleration"] for h in corrected if h in lumped}
    for h, lost in loss.items():
        closed = 100.0 * lumping_loss(h, PARTICLE * h) / 3.0
        quantity = f"no slip, h = {h:g} m: acceleration lost to lumping"
        case.show(quantity, lost, unit="%", reference=f"ε/3 = {closed:.3g} %", method=WITHOUT)
    for h in (h for h in loss if h / 2.0 in loss):
        step = f"h = {h:g} → {h / 2.0:g} m"
        # The closed form is ε/3 − O(ε²), and ε is a fifth at R/h = 2: the order is asserted from R/h = 4 on
        order, binds = observed_order(loss[h], loss[h / 2.0]), h <= PAPER
        quantity = f"no slip, {step}: observed order of that loss"
        case.gate(quantity, order, 2.0, (1.5, 2.5), method=WITHOUT, binds=binds)
        ratio = abs(lumped[h / 2.0]["displacement"] / lumped[h]["displacement"])
        quantity = f"no slip, {step}: ratio of displacement errors"
        case.gate(quantity, ratio, 0.25, (0.0, 1.0), method=WITHOUT, binds=binds)


def observed_order(coarse, fine):
    """Return the order of what halving h brings from ``coarse`` to ``fine``; NaN if the sign changes."""
    return math.log2(coarse / fine) if coarse * fine > 0.0 else math.nan
