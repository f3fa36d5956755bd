"""The scenes of the shipped studies at three orientations and with two layouts of points.

Bodies, velocities, loads and gravity turn together, and the grid does not. Gates bind each of the six runs.
"""
# cost: 1200

import itertools
import math
import tomllib

import numpy as np
import rolling
from placing import placed, rotation

from mpmfw.results.analysis import fitted_acceleration, impulse, value_at
from mpmfw.results.references import rings_table
from mpmfw.scene import load_scene
from mpmfw.units import to_si
from mpmfw.validation import CLASSICAL, Place, Runs, each, methods

ANGLES = (0.0, 0.35, 0.6)  #: [rad]
LAYOUTS = ("fitted", "lattice")
PRESSURE = 0.2e6  #: on both ends of the pressed blocks [Pa]
#: Nothing but the series of motion.
SERIES = {"output.gap": False, "output.particles": False, "output.surface": False, "output.ledger": False}


def turned(name, angle, layout, changes):
    """Return a shipped scene turned about the origin by ``angle`` [rad], its points in a layout."""
    scene = tomllib.loads(load_scene(name, set=changes).text)
    for table in (scene["grid"], *(body["geometry"] for body in scene["bodies"].values())):
        table.update({key: _metres(value) for key, value in table.items() if key != "type"})
    for body in scene["bodies"].values():
        body["particles"] = {**body["particles"], "layout": layout}
    scene.pop("reference", None)
    settle = scene.pop("settle", None)
    for table in filter(None, (scene, settle)):
        if "gravity" in table:
            table["gravity"] = _vector(table["gravity"])
    made = placed(scene, turn=math.degrees(angle))
    if settle is None:
        return made
    if "gravity" in settle:
        settle["gravity"] = {"vector": (rotation(angle) @ settle["gravity"]["vector"]).tolist()}
    return {**made, "settle": settle}


def pressed(angle, layout):
    """Return two blocks of the shipped contact-stress without walls, with a pressure on both ends."""
    scene = tomllib.loads(load_scene("contact-stress", set=SERIES | {"output.particles": True}).text)
    for body, side in (("lower", "bottom"), ("upper", "top")):
        scene["bodies"][body]["sides"] = [{"side": side, "pressure": PRESSURE}]
        scene["bodies"][body]["particles"]["layout"] = layout
    scene.pop("reference")
    settle = scene.pop("settle")
    return {**placed(scene, turn=math.degrees(angle)), "settle": settle}


def _metres(value):
    return [_metres(one) for one in value] if isinstance(value, list) else float(to_si(value, "m"))


def _vector(gravity):
    tilt, g = float(to_si(gravity["tilt"], "rad")), float(gravity["magnitude"])
    return {"vector": [g * math.sin(tilt), -g * math.cos(tilt)]}


def slides(run, angle):
    """Return the error of the block's fitted acceleration [%], against g (sin 30° − μ cos 30°), μ = 0.3."""
    way, time = _way(run, "block", angle)
    exact = 10.0 * (math.sin(math.radians(30.0)) - 0.3 * math.cos(math.radians(30.0)))
    fitted = fitted_acceleration(time, way, 0.2 * time[-1], time[-1])
    return {"acceleration": 100.0 * (fitted / exact - 1.0)}


def rolls(run, angle, roll):
    """Return errors of the cylinder when the rigid one has moved by 10 m [%]."""
    way, time = _way(run, "cylinder", angle)
    spin = run["series"]["angular_velocity"].sel(body="cylinder").isel(rotation=-1).values
    exact = float(roll.solution.spin(roll.end))
    return {
        "displacement": 100.0 * (value_at(time, way, roll.end) / rolling.DISTANCE - 1.0),
        "spin": 100.0 * (value_at(time, spin, roll.end) / exact - 1.0),
    }


def collides(run, angle):
    """Return the largest departure of the rings' impulse from the finite elements' [% of the total]."""
    series, table = run["series"], rings_table("force")
    time, exact = series["time"].values, table["fine_impulse_Ns_per_m"]
    ours = impulse(time, -series["contact_force"].values[:, 0] @ rotation(angle)[:, 0])
    return {"impulse": 100.0 * float(np.abs(ours - np.interp(time, table["time"], exact)).max() / exact[-1])}


def presses(run, angle):
    """Return the departure of −n·σ·n from the pressure within a cell of the interface [%, root mean square].

    n is the turned y axis, along which the interface lies at 1.037 m."""
    n, near, volume = rotation(angle)[:, 1], [], []
    for body in ("lower", "upper"):
        points = run[f"particles/{body}"].to_dataset().isel(time=-1)
        chosen = np.abs(points["position"].values @ n - _interface(run, n)) < run.attrs["cell_size"]
        stress = np.einsum("i,pij,j->p", n, points["stress"].values[:, :2, :2], n)
        near.append(-stress[chosen] / PRESSURE - 1.0)
        volume.append(points["volume"].values[chosen])
    square = np.average(np.concatenate(near) ** 2, weights=np.concatenate(volume))
    return {"stress": 100.0 * math.sqrt(square)}


def _interface(run, n):
    """Return where the interface lies along n [m]: midway between the innermost points of the blocks."""
    lower, upper = (
        run[f"particles/{body}"]["position"].isel(time=-1).values @ n for body in ("lower", "upper")
    )
    return 0.5 * float(lower.max() + upper.min())


def _way(run, body, angle):
    """Return the way of a body's centre along the turned x axis (time,) [m], and the times [s]."""
    series = run["series"]
    centre = series["centre_of_mass"].sel(body=body).values
    return (centre - centre[0]) @ rotation(angle)[:, 0], series["time"].values


CONTACTS = (
    *("penalty(kappa=1)", "lcp", "hybrid", "surfaces+impulse", *CLASSICAL),
    *("bardenhagen(criterion=position, normal=master, cut_off=1.0)", "bardenhagen(traction=true)"),
    *("nairn", "particles"),
)
METHODS = [*methods(), *methods(CONTACTS, when="full")]
#: Segments as long as the points' sides, whose ends lie where the points' corners do.
SEGMENTS = {"segments of half a cell": {f"bodies.{body}.segment": "0.5 cells" for body in ("lower", "upper")}}


def runs(title, scene, methods, make):
    """Return the runs of a scene's function at all orientations and layouts."""
    points = itertools.product(LAYOUTS, ANGLES)
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
    return runs(title, turned, methods, {"name": name, "changes": SERIES | changes})


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
    pressed,
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
    block.name: (slides, {}, {"acceleration": 0.1}),
    slip.name: (rolls, {"roll": rolling.SLIP}, {"displacement": 2.0, "spin": 10.0}),
    fine_slip.name: (rolls, {"roll": rolling.SLIP}, {"displacement": 2.0, "spin": 8.0}),
    no_slip.name: (rolls, {"roll": rolling.NO_SLIP}, {"displacement": 2.0, "spin": 10.0}),
    fine_no_slip.name: (rolls, {"roll": rolling.NO_SLIP}, {"displacement": 1.0, "spin": 5.0}),
    rings.name: (collides, {}, {"impulse": 7.0}),
    stress.name: (presses, {}, {"stress": 1.0}),
}


@each(block, slip, no_slip, fine_slip, fine_no_slip, rings, stress)
def test_errors(run):
    errors, args, limits = ERRORS[run.runs]
    bound = (
        ("penalty, cpdi, segments*", "*, fitted, *") if run.runs == stress.name else ("penalty, cpdi", "*")
    )
    binds = run.method.matches(bound[0]) and run.at(bound[1])
    for key, limit in limits.items():
        value = run.of(errors, key, angle=run.place.make["angle"], **args)
        run.gate(f"{key}, error, {run.place.at}", value, 0.0, limit, "%", binds=binds)
