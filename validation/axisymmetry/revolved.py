"""Scenes of bodies of revolution, and what closed forms say of them."""

import numpy as np
from common import elastic, fixed, polygon, rectangle, scene
from scipy.optimize import curve_fit

YOUNG, POISSON, DENSITY = 1e6, 0.3, 1e3
RUBBER = elastic(DENSITY, YOUNG, POISSON)
#: Inner and outer radius of the pipe [m], and the pressure in it [Pa].
INNER, OUTER, PRESSURE = 0.5, 1.0, 1e3
#: Mean radius of the ring, and the edge of its section [m].
RING, EDGE = 2.0, 0.2
#: Radius of the ball [m], and its speed [m/s].
BALL, SPEED = 1.0, 0.3
#: Share of the time of contact in which the middle half of the impulse passes, of x″ = −x^1.5.
MIDDLE = 0.28733
MODULUS = YOUNG / (1.0 - POISSON**2)
MASS = 4.0 / 3.0 * np.pi * BALL**3 * DENSITY


def revolved(cell, body, end, interval, upper, lower=(0.0, -1.0), material=RUBBER, **bodies):
    """Return a scene of a solid of revolution, and other bodies."""
    tables = {"grid": {"axisymmetric": True}, "output": {"ledger": True}}
    tables["contact"] = {} if bodies else None
    return scene(cell, lower, upper, end, interval, material, {"solid": body, **bodies}, **tables)


def pipe(cells):
    """Return a pipe with so many ``cells`` in its wall under pressure, at rest."""
    cell = (OUTER - INNER) / cells
    sides = [{"side": "left", "pressure": PRESSURE}, *fixed(bottom="y", top="y")]
    body = rectangle(INNER, 0.0, OUTER, 4.0 * cell, sides=sides)
    return revolved(cell, body, 1e-4, 1e-4, (1.5, 1.0)) | {"settle": {"tolerance": 1e-4}}


def fitted(cells):
    """Return the pipe without friction on a rigid shaft, too thick by what the pressure opens the pipe by."""
    made, share = pipe(cells), PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
    wide = INNER + (1.0 + POISSON) * share / YOUNG * ((1.0 - 2.0 * POISSON) * INNER + OUTER**2 / INNER)
    made["bodies"]["solid"]["sides"] = made["bodies"]["solid"]["sides"][1:]
    made["bodies"]["shaft"] = rectangle(0.0, -0.5, wide, 1.0, rigid=True)
    return made | {"contact": {"method": "penalty"}, "allow_overlap": True}


def lame(tree):
    """Return the largest errors of the ``hoop`` stress and of its ``mean`` over the points of a row of cells,
    over the inner one's, and that of the ``opening`` [%].

    σ_θθ = A (1 + b²/r²) and u = (1 + ν) A / E ((1 − 2ν) r + b²/r), A = p a² / (b² − a²); plane strain."""
    points = tree["particles/solid"].to_dataset()
    last = points.isel(time=-1)
    share = PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
    stretch = last["hoop_stretch"].values
    radius = last["position"].values[:, 0] / stretch
    exact = share * (1.0 + OUTER**2 / radius**2)
    moved = (1.0 + POISSON) * share / YOUNG * ((1.0 - 2.0 * POISSON) + OUTER**2 / radius**2)
    inner = share * (1.0 + OUTER**2 / INNER**2)
    off = 100.0 * (last["hoop_stress"].values - exact) / inner
    row = ((radius - INNER) / float(tree.attrs["cell_size"])).astype(int)
    return {
        "hoop": float(np.abs(off).max()),
        "mean": float(np.abs(np.bincount(row, off) / np.bincount(row)).max()),
        "opening": 100.0 * float((stretch - 1.0) @ moved / (moved @ moved) - 1.0),
    }


def shell(cells):
    """Return a sphere's shell with so many ``cells`` in its wall under pressure inside, at rest."""
    angle = np.linspace(0.0, np.pi, 181)
    arc = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    arc[[0, -1], 0] = 0.0
    points = np.concatenate([OUTER * arc, INNER * arc[::-1]])
    body = polygon(points, sides=[{"side": "inner", "pressure": PRESSURE}])
    made = revolved((OUTER - INNER) / cells, body, 1e-4, 1e-4, (1.5, 1.5), (0.0, -1.5))
    return made | {"settle": {"tolerance": 1e-4}}


def opened(tree):
    """Return the error [%] of the opening of the shell by least squares over its points.

    u/R = A/E [1 − 2ν + (1 + ν) b³/(2 R³)], A = p a³ / (b³ − a³); Timoshenko & Goodier, article 136."""
    last = tree["particles/solid"].to_dataset().isel(time=-1)
    stretch = last["hoop_stretch"].values
    radius = np.linalg.norm(last["position"].values, axis=1) / stretch
    share = PRESSURE * INNER**3 / (OUTER**3 - INNER**3) / YOUNG
    exact = share * (1.0 - 2.0 * POISSON + 0.5 * (1.0 + POISSON) * (OUTER / radius) ** 3)
    return 100.0 * float((stretch - 1.0) @ exact / (exact @ exact) - 1.0)


def ring():
    """Return a ring two cells wide that is thrown outwards, for two periods."""
    half, period = 0.5 * EDGE, 2.0 * np.pi * RING / np.sqrt(YOUNG / DENSITY)
    body = rectangle(RING - half, 0.4, RING + half, 0.4 + EDGE, velocity=[0.1, 0.0])
    return revolved(half, body, 2.0 * period, period / 50.0, (3.0, 1.5))


def breathing(tree):
    """Return errors of the ``period`` by least squares against √(E/ρ)/R and of the ``energy`` at the end [%],
    and the largest axial ``momentum`` over the radial one."""
    series = tree["series"].to_dataset()
    time, place = series["time"].values, series["centre_of_mass"].values[:, 0, 0]
    rate = np.sqrt(YOUNG / DENSITY) / RING
    moved = place - place[0]
    fit = curve_fit(lambda t, a, w: a * np.sin(w * t), time, moved, p0=[np.ptp(moved) / 2.0, rate])[0]
    energy, momentum = series["total_energy"].values[:, 0], series["linear_momentum"].values[:, 0]
    return {
        "period": 100.0 * float(rate / fit[1] - 1.0),
        "energy": 100.0 * float(energy[-1] / energy[0] - 1.0),
        "momentum": float(np.abs(momentum[:, 1]).max() / np.abs(momentum[:, 0]).max()),
    }


def half_disc(corners=240):
    """Return the outline of a ball in the half-plane; the polygon has the ball's volume to 1e-4."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, corners)
    place = BALL * np.stack([np.cos(angle), 1.0 + np.sin(angle)], axis=1)
    place[[0, -1], 0] = 0.0
    return place.tolist()


def ball(cells):
    """Return a ball of so many ``cells`` in its radius that falls on a rigid plane without friction."""
    body, end = polygon(half_disc(), velocity=[0.0, -SPEED]), 1.4 * hertz()["time"]
    plane = rectangle(-0.5, -0.5, 1.5, -1e-6, rigid=True)
    return revolved(BALL / cells, body, end, end / 400.0, (1.5, 2.5), plane=plane)


def bar(cells):
    """Return Taylor's bar of copper, so many ``cells`` in its radius, against a smooth wall for 80 µs."""
    length, radius = 32.4e-3, 3.2e-3
    body = rectangle(0.0, 0.0, radius, length, velocity=[0.0, -227.0], sides=fixed(bottom="y"))
    copper = elastic(8930.0, 117e9, 0.35, "j2", yield_stress=4e8, hardening_modulus=1e8)
    cell = radius / cells
    return revolved(cell, body, 8e-5, 4e-6, (3.2 * radius, 1.1 * length), (0.0, -4.0 * cell), copper)


def plate(cells):
    """Return the same bar in the plane, half of a plate without end, to one side of its plane of symmetry."""
    made, (_, upper) = bar(cells), bar(cells)["grid"]["upper"]
    made["bodies"]["solid"]["sides"] = fixed(left="x", bottom="y")
    lower = made["grid"]["lower"][1]
    made["grid"] = {"cell_size": 3.2e-3 / cells, "lower": [lower, lower], "upper": [6.0 * 3.2e-3, upper]}
    return made


def quarter(cells):
    """Return a quarter of the same bar in space, between two smooth planes of symmetry; the axis is z."""
    made, radius, lower = bar(cells), 3.2e-3, -4.0 * 3.2e-3 / cells
    angle = np.linspace(0.0, 0.5 * np.pi, 6 * cells + 1)
    arc = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1).round(12)
    outline = {"type": "polygon", "points": [[0.0, 0.0], *arc.tolist()]}
    made["bodies"]["solid"] |= {
        "geometry": {"type": "extrusion", "outline": outline, "low": 0.0, "high": 32.4e-3},
        "velocity": [0.0, 0.0, -227.0],
        "sides": fixed(left="x", bottom="y", back="z"),
    }
    upper = [3.2 * radius, 3.2 * radius, 36e-3]
    made["grid"] = {"cell_size": radius / cells, "lower": [lower] * 3, "upper": upper}
    return made


def upset(tree):
    """Return the final ``length`` and extent of the ``foot`` along x [mm], half a point beyond the outermost
    ones, the energy that is ``lost`` beyond plastic flow and the transfer, over the start [%], and the share
    of CPDI's domains that are degenerate, and ``replaced`` [%]."""
    points = tree["particles/solid"].to_dataset()
    series, half = tree["series"].to_dataset(), 0.25 * float(tree.attrs["cell_size"])
    last, stretch = points.isel(time=-1), points["deformation_gradient"].values[-1]
    radius, height = last["position"].values[:, [0, -1]].T
    outer, upper = int(radius.argmax()), int(height.argmax())
    edges = np.linalg.norm(stretch, axis=1)
    far = (np.abs(np.log(edges)) > np.log(4.0)).any(axis=1)
    return {
        "length": 1e3 * float(height[upper] + half * stretch[upper, -1, -1]),
        "foot": 1e3 * float(radius[outer] + half * stretch[outer, 0, 0]),
        "lost": 100.0
        * abs(float(series["energy_residual"].values[-1] / series["total_energy"].values[0, 0])),
        "replaced": 100.0 * float(np.mean(far | (np.linalg.det(stretch) < 0.5 * edges.prod(axis=1)))),
    }


def hertz():
    """Return the largest force [N] and the time of contact [s] of Hertz's impact on a rigid plane.

    K. L. Johnson, Contact Mechanics (1985), section 11.4: F = 4/3 E* √R δ^1.5, and the kinetic energy."""
    stiffness = 4.0 / 3.0 * MODULUS * np.sqrt(BALL)
    depth = (1.25 * MASS * SPEED**2 / stiffness) ** 0.4
    return {"force": stiffness * depth**1.5, "time": 2.9432 * depth / SPEED}


def resting(cells, kappa):
    """Return the ball of the case hertz-in-space on a rigid plane under its weight: a contact of 0.2 R."""
    made, rise = ball(cells), 0.014
    made["bodies"]["solid"] |= polygon([[x, y + rise] for x, y in half_disc()])
    made["bodies"]["plane"] |= rectangle(-0.5, -0.5, 1.5, rise)
    made["materials"]["solid"] = elastic(DENSITY, 3.5771353e6, POISSON)
    del made["bodies"]["solid"]["velocity"]
    made["contact"]["penalty"] = {"kappa": kappa}
    made["time"] = {"end": 1e-4, "output_interval": 1e-4}
    return made | {"gravity": {"vector": [0.0, -10.0]}, "settle": {"tolerance": 1e-3}}


def circle(tree):
    """Return the errors [%] of the ``force`` against the weight, and of the ``radius`` √(5/2 ⟨r²⟩) of the
    contact against 0.2 R."""
    solid = tree["surface/solid"].to_dataset().isel(time=-1)
    place, force = solid["position"].values, solid["force"].values[:, 1]
    total, square = float(force.sum()), float(force @ place[:, 0] ** 2)
    return {
        "force": 100.0 * (total / (10.0 * MASS) - 1.0),
        "radius": 100.0 * (np.sqrt(2.5 * square / total) / (0.2 * BALL) - 1.0),
    }


def in_space(cells):
    """Return the same impact in space, where the axis is y."""
    made = ball(cells)
    made["grid"] = {"cell_size": BALL / cells, "lower": [-1.5, -1.0, -1.5], "upper": [1.5, 2.5, 1.5]}
    centre = {"type": "ball", "centre": [0.0, BALL, 0.0], "radius": BALL}
    made["bodies"]["solid"] |= {"geometry": centre, "velocity": [0.0, -SPEED, 0.0]}
    made["bodies"]["plane"]["geometry"] = {
        "type": "box",
        "lower": [-0.8, -0.4, -0.8],
        "upper": [0.8, -1e-6, 0.8],
    }
    return made


def impact(tree):
    """Return errors of the ``force`` over the approach of the centre of mass by least squares, of the
    ``time`` between a quarter and three quarters of the impulse [%], the ``restitution``, and the ``energy``
    with what was lost, over the start."""
    series = tree["series"].to_dataset()
    force, time = np.abs(series["contact_force"].values[:, 0, 1]), series["time"].values
    place = series["centre_of_mass"].sel(body="solid", axis="y").values
    exact = 4.0 / 3.0 * MODULUS * np.sqrt(BALL) * np.maximum(place[0] - place, 0.0) ** 1.5
    passed = np.cumsum(force) / force.sum()
    middle = float(np.diff(np.interp([0.25, 0.75], passed, time))[0])
    velocity = series["mean_velocity"].sel(body="solid", axis="y").values
    energy = series["total_energy"].sel(body="solid").values + series["transfer_dissipation"].values
    return {
        "force": 100.0 * float(force @ exact / (exact @ exact) - 1.0),
        "time": 100.0 * (middle / (MIDDLE * hertz()["time"]) - 1.0),
        "restitution": float(-velocity[-1] / velocity[0]),
        "energy": float(energy.max() / energy[0]),
    }
