"""Rigid tools: a band round a drum, a sheet on a die, a grip that lifts a block, a disc that rebounds."""
# cost: 130

import numpy as np
from common import disc, elastic, polygon, rectangle, scene

from mpmfw.validation import CLASSICAL, Place, Runs, each, methods

RADIUS, THICK, FRICTION, PULL = 2.0, 0.2, 0.3, 4e3  #: of the drum and the band [m], μ, tension [N/m]
DRAWN, DRAG = 0.1, 4.0  #: speed of a band over a drum at rest [m/s], its drag [1/s]
EDGE, GRAVITY = 0.4, 10.0  #: of the gripped block [m], [m/s²]
#: Velocity of the disc after the impact over that before it, with cells of a 20th of its radius.
FINEST = 0.4852
METHODS = [*methods(), *methods(["lcp", CLASSICAL[1]], when="full")]


def rubber(cell, end, lower, upper, friction, bodies, **more):
    """Return a scene of rubber."""
    solid = elastic(1e3, 1e6, 0.3, damping={"bulk": "2 ms", "shear": "2 ms"})
    soft = {"segment": "0.25 cells"}
    bodies = {name: body if "rigid" in body else {**soft, **body} for name, body in bodies.items()}
    tables = {"contact": {"friction": friction}, "output": {"particles": False, "surface": False}, **more}
    return scene(cell, lower, upper, end, end / 100.0, solid, bodies, **tables)


def band(cell, drawn=False):
    """Return a band round a quarter of a drum, one end pulled; the other is held, and the drum turns, or it
    is ``drawn`` over a drum at rest."""
    angle = np.linspace(0.0, 0.5 * np.pi, 64)
    arc, leg = np.stack([np.sin(angle), np.cos(angle)], axis=1), 0.5
    near, far = 1.0002 * RADIUS, RADIUS + THICK
    points = [[-leg, near], *(near * arc), [near, -leg], [far, -leg], *(far * arc[::-1]), [-leg, far]]
    held, motion = {"fixed": True}, {"angular_velocity": [[0.0, 0.0], [0.2, -0.3]]}
    end, drag = 0.8, {"model": "drag", "rate": 20.0}
    if drawn:
        held = {"velocity": [[0.0, 0.0, 0.0], [0.3, -DRAWN, 0.0]]}
        end, drag = 1.6, {"model": "drag", "rate": DRAG}
    pulled = [{"side": "left", **held}, {"side": "bottom", "pressure": -PULL / THICK}]
    turns = True if drawn else {"motion": motion}
    bodies = {
        "band": polygon(points, sides=pulled),
        "drum": disc(0.0, 0.0, RADIUS, segment=0.02, rigid=turns),
    }
    calm = {"settle": {"tolerance": 1e-2}, "loads": {"calm": drag}}
    return rubber(cell, end, [-0.8, -0.8], [2.6, 2.6], FRICTION, bodies, **calm)


def tension(tree, drawn=False):
    """Return the error [%] of the tension of the band against (F + q l) e + q (e − 1) r² / μ R + q l with e =
    e^(μ φ R / r), r = R + t/2, the pull F, the drag q along the band, and straight ends of length l."""
    reaction = tree["series"]["side_reaction"].sel(side="band-left", axis="x").values
    middle, drag = RADIUS + 0.5 * THICK, 1e3 * THICK * DRAG * DRAWN if drawn else 0.0
    grows = np.exp(FRICTION * 0.5 * np.pi * RADIUS / middle)
    exact = (PULL + 0.5 * drag) * grows + drag * ((grows - 1.0) * middle**2 / (FRICTION * RADIUS) + 0.5)
    return 100.0 * (abs(reaction[-30 if drawn else -10 :].mean()) / exact - 1.0)


def place(name, sizes, **make):
    """Return places with the given cells, the first of them in the reduced version as well."""
    return [
        Place(f"{name}, h = {1e3 * cell:g} mm", make={"cell": cell, **make}, when="full" if k else "")
        for k, cell in enumerate(sizes)
    ]


turned = Runs("band", band, METHODS, place("band", (0.1, 0.05)))
drawn = Runs("drawn", band, METHODS, place("drawn band", (0.1, 0.05), drawn=True), when="full")


@each(turned, drawn)
def test_band(run):
    value = run.of(tension, drawn=run.runs == "drawn")
    run.gate(f"tension of the band, error, {run.place.at}", value, 0.0, 3.0, "%")


#: Of the sheet, its thickness, the die's radius, the free end [m].
WAY, SHEET, CURVED, FREE = 1.0, 0.1, 5.0, 0.5
BENT = 1e6 / (1.0 - 0.3**2) * SHEET**3 / 12.0 / (CURVED + 0.5 * SHEET)  #: moment on the die, E' I / R [N]


def die(cell):
    """Return a sheet that is clamped above a round die, and bent over it by a force at its end."""
    force = [[0.0, 0.0, 0.0], [1.0, 0.0, -BENT / FREE]]
    sides = [{"side": "left", "fixed": True}, {"side": "right", "force": force}]
    bodies = {
        "sheet": rectangle(0.0, 0.0, WAY, SHEET, sides=sides, segment="0.5 cells"),
        "die": disc(0.0, -CURVED, CURVED, segment=0.02, rigid=True),
    }
    calm = {"loads": {"calm": {"model": "drag", "rate": 6.0}}, "output": {"surface": False}}
    return scene(
        cell, [-0.2, -0.4], [1.2, 0.3], 3.0, 0.03, elastic(1e3, 1e6, 0.3, "neo_hookean"), bodies, **calm
    )


def bent(tree):
    """Return errors [%] of the ``moment`` where the sheet lies on the die, of the slope of its stress, and of
    the ``way`` of its end; and the ``balance`` of the forces over that at the end.

    A sheet leaves the die where the force has the moment E' I / R, at the free length l. Its end goes by
    (L²/2 − l²/6) / R (Timoshenko 1956), and by l F / (5/6 G t) by shear."""
    points, radius, force = tree["particles/sheet"].to_dataset(), CURVED + 0.5 * SHEET, BENT / FREE
    place, last = points["position"].values[0], points.isel(time=-1)
    x, y = place[:, 0], place[:, 1] - 0.5 * SHEET
    lies, free = (x > 0.2) & (x < 0.3), x > WAY - FREE
    moment = np.polyfit(y[lies], last["stress"].values[lies, 0, 0], 1)[0] * SHEET**3 / 12.0
    falls = np.polyfit(x[free], (place - last["position"].values)[free, 1], 3)
    exact = (0.5 * WAY**2 - FREE**2 / 6.0) / radius + FREE * force * 1.2 * 2.6 / (1e6 * SHEET)
    series = tree["series"].to_dataset().isel(time=slice(-10, None)).mean("time").sel(axis="y")
    forces = series["side_reaction"].values[0] - series["reaction"].sel(body="die").values - force
    return {
        "moment": 100.0 * (moment / BENT - 1.0),
        "way": 100.0 * (np.polyval(falls, WAY) / exact - 1.0),
        "balance": forces / force,
    }


@Runs("die", die, METHODS, place("die", (0.05, 0.025)), when="full")
def test_die(run):
    run.gates(
        bent,
        ("moment of the sheet on the die, error, {at}", "moment", 0.0, 5.0, "%"),
        ("way of its end, error, {at}", "way", 0.0, 2.0, "%"),
        ("sum of all forces on it, {at}", "balance", 0.0, 5e-3),
    )


def grip(cell, friction):
    """Return a block that two plates press by 1 % each, and lift by 20 mm once gravity acts."""
    bodies = {"block": rectangle(0.0, 0.0, EDGE, EDGE)}
    for name, x, way in (("left", -0.2, 0.04), ("right", EDGE, -0.04)):
        table = [[0.0, way, 0.0], [0.1, way, 0.0], [0.11, 0, 0], [0.4, 0, 0], [0.5, 0, 0.2], [0.6, 0, 0]]
        bodies[name] = rectangle(x, -1.3, x + 0.2, 0.7, rigid={"motion": {"velocity": table}})
    gravity = {"table": [[0.15, 0.0, 0.0], [0.3, 0.0, -GRAVITY]]}
    return rubber(cell, 0.8, [-0.3, -1.1], [0.7, 0.9], friction, bodies, gravity=gravity)


def held(tree, friction):
    """Return errors of the weight on the plates [%], of the block's way [mm], and of its fall against
    g − 2 μ N / m with the force N that presses [% of g], over the last 0.2 s."""
    series, mass = tree["series"].to_dataset(), 1e3 * EDGE**2
    time, y = series["time"].values, series["centre_of_mass"].sel(body="block", axis="y").values
    late = time > 0.599
    forces = series["reaction"].sel(body=["left", "right"]).values[late].mean(axis=0)
    fall = -2.0 * np.polyfit(time[late], y[late], 2)[0]
    slips = GRAVITY - friction * np.abs(forces[:, 0]).sum() / mass
    return {
        "weight": 100.0 * (-forces[:, 1].sum() / (mass * GRAVITY) - 1.0),
        "way": 1e3 * (y[-1] - y[time < 0.151][-1]) - 20.0,
        "fall": 100.0 * (fall - slips) / GRAVITY,
    }


@Runs(
    "grip",
    grip,
    METHODS,
    place("μ = 0.3", (0.1, 0.05), friction=0.3) + place("μ = 0.05", (0.1, 0.05), friction=0.05),
)
def test_grip(run):
    friction = run.place.make["friction"]
    rows = (("fall of the block, error, {at}", "fall", 0.0, 2.0, "% of g"),)
    if friction == 0.3:
        rows = (
            ("weight on the plates, error, {at}", "weight", 0.0, 5.0, "%"),
            ("way of the block less the plates', {at}", "way", 0.0, 2.0, "mm"),
        )
    run.gates(held, *rows, friction=friction)


def rebound(cell):
    """Return a free rigid disc that falls on an elastic block in flight."""
    bodies = {
        "block": rectangle(-0.6, -0.5, 0.6, 0.0),
        "disc": disc(0.1, 0.26, 0.25, segment=0.01, rigid={"density": 1e3}, velocity=[0.0, -1.0]),
    }
    output = {"particles": False, "surface": False, "ledger": True, "contact_moment": [0.0, 0.0]}
    return rubber(cell, 0.15, [-1.0, -1.1], [1.0, 1.0], FRICTION, bodies, output=output)


def bounced(tree):
    """Return the ``velocity`` of the disc away from the block over that before, the ``energy`` at its largest
    over the first, and the largest change of ``momentum`` over the disc's; of that about the origin, that by
    contact (``contact``) over what each body has of it, and all (``turned``) [%]."""
    series = tree["series"].to_dataset()
    velocity = series["mean_velocity"].sel(axis="y").values
    momentum = series["linear_momentum"].sum("body").values
    energy = series["total_energy"].sum("body").values
    moments = series["contact_moment"].values[..., 0]
    x, y = series["centre_of_mass"].values.T
    along, across = series["linear_momentum"].values.T
    turned = series["angular_momentum"].values[..., 0].sum(axis=1) + (x * across - y * along).sum(axis=0)
    return {
        "contact": float(np.abs(moments.sum(axis=1)).max() / np.abs(moments).max()),
        "turned": 100.0 * float(np.abs(turned / turned[0] - 1.0).max()),
        "velocity": float(velocity[-1, 1] - velocity[-1, 0]),
        "energy": float(energy.max() / energy[0]),
        "momentum": float(np.abs(momentum - momentum[0]).max() / np.abs(momentum[0]).max()),
    }


@Runs("rebound", rebound, METHODS, place("rebound", (0.05, 0.025)))
def test_rebound(run):
    error = 100.0 * (run.of(bounced, "velocity") / FINEST - 1.0)
    run.gate(f"restitution against the finest run, error, {run.place.at}", error, 0.0, 5.0, "%")
    run.gates(
        bounced,
        ("largest energy over the first, {at}", "energy", 1.0, (0.0, 1.001)),
        ("largest change of momentum, {at}", "momentum", 0.0, 1e-12),
        ("largest sum of the moments of contact, {at}", "contact", 0.0, 1e-12),
        ("largest change of angular momentum, {at}", "turned", 0.0, 0.5, "%"),
    )


@Runs("finest", rebound, places=place("rebound", (0.0125,)), when="full")
def test_finest(run):
    run.gate("restitution", run.of(bounced, "velocity"), FINEST, (0.99 * FINEST, 1.01 * FINEST))
