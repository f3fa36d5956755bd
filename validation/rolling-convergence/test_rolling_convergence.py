"""Convergence of the rolling cylinder with the cell size: against the rigid cylinder and the elastic one."""
# cost: 440

import math

import numpy as np
from rolling import EXACT, LUMPED, NO_SLIP, SERIES_ONLY, SLIP, errors, lumping_loss

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, Place, Runs, each, methods, together

_BLUE, _LIGHT, _RED, _GREEN = "#0072B2", "#56B4E9", "#D55E00", "#117733"
_LOOKS = {"displacement": ("o", "-"), "acceleration": ("s", "--"), "angular acceleration": ("^", "-.")}


def draw(found):
    """Draw sizes of errors, no slip, and errors with the values that they must tend to."""
    columns = 2 if (SLIP.name, CORRECTED) in found else 1
    figure = new_figure(columns, 1, 68.0)
    panels = figure.subplots(1, columns, squeeze=False)[0]
    drawn = [("penalty", CORRECTED, _BLUE, "o"), ("penalty, lumped", UNCORRECTED, _LIGHT, "D")]
    for method, colour, marker in zip(methods(CLASSICAL), (_RED, _GREEN), ("s", "^"), strict=True):
        drawn.append((method.contact, method, colour, marker))
    curves = {name: (found[NO_SLIP.name, method], *look) for name, method, *look in drawn}
    handles = _no_slip(panels[0], curves)
    if columns == 2:
        _slip(panels[1], found[SLIP.name, CORRECTED])
    legend_below(figure, [handles] if columns == 2 else [handles[:3], handles[3:]])
    return figure


def _no_slip(axes, curves):
    handles = []
    for name, (found, colour, marker) in curves.items():
        sizes = np.array(sorted(found))
        values = [abs(found[h]["displacement"]) for h in sizes]
        look = {"color": colour, "marker": marker, "markersize": 4, "linewidth": 1.1}
        handles += axes.loglog(sizes, values, **look, label=name)
    (exact, *_), (lumped, *_) = curves["penalty"], curves["penalty, lumped"]
    sizes = np.array(sorted(set(exact) & set(lumped)))
    loss = [exact[h]["acceleration"] - lumped[h]["acceleration"] for h in sizes]
    closed = 100.0 * lumping_loss(sizes, 0.5 * sizes) / 3.0
    handles += axes.plot(sizes, loss, "x", color="black", markersize=5, label="lost to lumping")
    handles += axes.plot(sizes, closed, **EXACT, label="ε/3")
    if len(sizes) > 2:
        _triangle(axes, 0.32, 0.012, 2.0)
    dress(axes, "cell size h [m]", "size of the error [%]", "no slip: displacement; lost to lumping")
    _ticks(axes, sizes)
    return handles


def _slip(axes, found):
    sizes = np.array(sorted(found))
    for name, (marker, style) in _LOOKS.items():
        values = [found[h][name] for h in sizes]
        look = {"color": _BLUE, "marker": marker, "linestyle": style, "markersize": 4, "linewidth": 1.1}
        axes.semilogx(sizes, values, **look, label=name)
        axes.axhline(ELASTIC[name], color="0.4", linestyle=style, linewidth=0.8, zorder=1)
    axes.axhline(0.0, **EXACT)
    axes.text(sizes[-1], 0.05, "rigid", ha="right", va="bottom")
    dress(axes, "cell size h [m]", "error [%]", "slip, penalty; grey: converged elastic solution")
    # Between the accelerations, where no curve runs
    axes.legend(loc="center", bbox_to_anchor=(0.5, 0.43))
    _ticks(axes, sizes)


def _ticks(axes, sizes):
    axes.set_xticks(sizes, [f"{h:g}" for h in sizes])
    axes.set_xticks([], minor=True)


def _triangle(axes, left, bottom, order):
    """Slope of an order, over a factor of two in h."""
    right, top = 2.0 * left, bottom * 2.0**order
    axes.plot([left, right, right, left], [bottom, bottom, top, bottom], color="0.3", linewidth=0.8)
    axes.text(1.04 * right, np.sqrt(bottom * top), f"{order:g}", va="center", color="0.3")
    axes.text(np.sqrt(left * right), 0.93 * bottom, "1", va="top", ha="center", color="0.3")


SIZES = (0.8, 0.4, 0.2, 0.1)  #: h [m]; particles h/2, segments h/4
PAPER, HALF = 0.4, 0.2
WITHOUT = "rotation = lumped"
CORRECTED, UNCORRECTED = methods(settings={"": {}, WITHOUT: LUMPED})
#: The cylinder settles under the normal load that it will have on the tilted plane: g cos 60° [m/s²]. After a
#: sudden tilt its spin oscillates, and at one time shows the oscillation's phase rather than an error.
NORMAL_LOAD = {"settle.gravity": {"vector": [0.0, -5.0]}}
#: Departures of the converged elastic solution with slip from the rigid cylinder [%]: see the README.
ELASTIC = {"displacement": 0.55, "acceleration": 0.0, "spin": -2.5, "angular acceleration": -1.25}


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


@each(no_slip, half, slip, classical_no_slip, classical_slip)
def test_errors(run):
    at, size, rolls = run.place.at, run.scene.grid.cell_size, run.runs == NO_SLIP.name
    displacement, acceleration, spin = (
        run.of(errors, key, roll=run.runs) for key in ("displacement", "acceleration", "spin")
    )
    lumped = 1.0 if size <= HALF else 2.5
    limit = (lumped if run.method.label else 0.5) if rolls else 1.0
    binds = run.method.contact == "penalty" and rolls and size in (PAPER, HALF)
    run.gate(f"{at}: displacement at 10 m, error", displacement, "rigid 0 %", limit, "%", binds=binds)
    if not rolls:
        run.gate(f"{at}: fitted acceleration, error", acceleration, "rigid 0 %", 0.2, "%", binds=False)
        run.gate(f"{at}: spin at 10 m, error", spin, "rigid 0 %, elastic -2.5 %", 5.0, "%", binds=False)


@together(no_slip, slip, classical_no_slip, classical_slip)
def test_orders(case, runs):
    found = {}
    for run in runs:
        own = found.setdefault((run.runs, run.method), {})
        own[run.scene.grid.cell_size] = errors(run.results, run.runs)
    lumping(case, found[NO_SLIP.name, CORRECTED], found[NO_SLIP.name, UNCORRECTED])
    case.figure("", draw(found))


def lumping(case, corrected, lumped):
    """Record the order of the loss by lumping, whose closed form is ε/3 − O(ε²), and the lumped error."""
    loss = {h: corrected[h]["acceleration"] - lumped[h]["acceleration"] for h in corrected if h in lumped}
    for h in (h for h in loss if h / 2.0 in loss):
        step = f"h = {h:g} → {h / 2.0:g} m"
        coarse, fine, binds = loss[h], loss[h / 2.0], h <= PAPER  # ε is a fifth at R/h = 2: from R/h = 4 on
        order = math.log2(coarse / fine) if coarse * fine > 0.0 else math.nan  # a change of sign has none
        quantity = f"no slip, {step}: observed order of that loss"
        case.gate(quantity, order, 2.0, (1.5, 2.5), method=WITHOUT, binds=binds)
        ratio = abs(lumped[h / 2.0]["displacement"] / lumped[h]["displacement"])
        quantity = f"no slip, {step}: ratio of displacement errors"
        case.gate(quantity, ratio, 0.25, (0.0, 1.0), method=WITHOUT, binds=binds)
