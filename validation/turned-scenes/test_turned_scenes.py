"""The scenes of the shipped studies at three orientations and with two layouts of points.

Bodies, velocities, loads and gravity turn together, and the grid does not. A gate takes the worst of the six.
"""
# cost: 1200

import itertools

import rolling
import turning

from mpmfw.validation import CLASSICAL, Place, Runs, each, full, methods, together

CONTACTS = (
    "penalty",
    "penalty(kappa=1)",
    "lcp",
    "hybrid",
    "surfaces+impulse",
    *CLASSICAL,
    "bardenhagen(criterion=position, normal=master, cut_off=1.0)",
    "bardenhagen(traction=true)",
    "nairn",
    "particles",
)
METHODS = [*methods(), *methods(CONTACTS[1:], when="full")]
#: Segments as long as the points' sides, whose ends lie where the points' corners do.
SEGMENTS = {"segments of half a cell": {f"bodies.{body}.segment": "0.5 cells" for body in ("lower", "upper")}}


def runs(title, scene, methods, make):
    """Return the runs of a scene's function at all orientations and layouts."""
    points = itertools.product(turning.LAYOUTS, turning.ANGLES)
    places = [
        Place(
            f"{title}, {layout}, {angle:g} rad",
            make={**make, "angle": angle, "layout": layout},
            when="" if (layout, angle) == ("fitted", 0.35) else "full",
        )
        for layout, angle in points
    ]
    return Runs(title, scene, methods, places)


def shipped(title, name, methods=METHODS, **changes):
    """Return the runs of a shipped scene with changes."""
    return runs(title, turning.turned, methods, {"name": name, "changes": turning.SERIES | changes})


def rolling_at(cells, methods):
    """Return the runs of both rolling cylinders with so many cells in the radius."""
    size = {"grid.cell_size": rolling.RADIUS / cells}
    return [
        shipped(f"rolling {name}, R/h = {cells}", f"rolling-cylinder-{scene}", methods, **size)
        for name, scene in (("with slip", "slip"), ("without slip", "no-slip"))
    ]


block = shipped("block", "sliding-block", **{"time.end": 0.3})
slip, no_slip = rolling_at(2, METHODS)
fine_slip, fine_no_slip = rolling_at(4, methods(["penalty", "penalty(kappa=1)", *CLASSICAL], when="full"))
rings = shipped("rings", "colliding-rings", **{"grid.cell_size": 0.004})
stress = runs(
    "contact stress",
    turning.pressed,
    [
        *METHODS,
        *methods(settings=SEGMENTS, bound=True),
        *methods(["lcp"], settings=SEGMENTS, when="full"),
        *methods(["none"], when="full"),
    ],
    {},
)


#: By name of the runs: errors of a run, their arguments, and limits by key.
ERRORS = {
    block.name: (turning.slides, {}, {"acceleration": 0.1}),
    slip.name: (turning.rolls, {"roll": rolling.SLIP}, {"displacement": 2.0, "spin": 10.0}),
    fine_slip.name: (turning.rolls, {"roll": rolling.SLIP}, {"displacement": 2.0, "spin": 8.0}),
    no_slip.name: (turning.rolls, {"roll": rolling.NO_SLIP}, {"displacement": 2.0, "spin": 10.0}),
    fine_no_slip.name: (turning.rolls, {"roll": rolling.NO_SLIP}, {"displacement": 1.0, "spin": 5.0}),
    rings.name: (turning.collides, {}, {"impulse": 7.0}),
    stress.name: (turning.presses, {}, {"stress": 1.0}),
}
ALL = (block, slip, no_slip, fine_slip, fine_no_slip, rings, stress)


@each(*ALL)
def test_errors(run):
    errors, args, limits = ERRORS[run.runs]
    bound, layout = (
        ("penalty, cpdi, segments*", "fitted") if run.runs == stress.name else ("penalty, cpdi", "*")
    )
    binds = run.method.matches(bound) and run.at(f"*, {layout}, *")
    for key, limit in limits.items():
        value = run.of(errors, key, angle=run.place.make["angle"], **args)
        run.gate(f"{key}, error, {run.place.at}", value, 0.0, limit, "%", binds=binds)


@full
@together(*ALL)
def test_worst(case, runs):
    """Record the worst error of each method, of all six runs and of the three with fitted points."""
    for (name, (errors, args, keys)), (method, same) in itertools.product(ERRORS.items(), runs.by_method()):
        own = [run for run in same if run.runs == name]
        fitted = [run for run in own if run.at("*, fitted, *")]
        for key, (of, chosen) in itertools.product(keys, (("six", own), ("three, fitted", fitted))):
            if chosen:
                value = turning.worst(chosen, errors, key, **args)
                case.show(f"{key}, error, worst of {of}, {name}", value, 0.0, unit="%", method=method)
