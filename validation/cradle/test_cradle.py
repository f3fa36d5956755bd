"""Rigid bodies that meet: a disc runs into a row of discs; a stack, cards and an arch at their limits."""
# cost: 70

import numpy as np
from common import disc, fixed, polygon, rectangle, scene
from scipy.optimize import bisect, linprog

from mpmfw.validation import Place, Runs, methods

RADIUS, SPEED = 0.25, 1.0
RUBBER = {"model": "neo_hookean", "density": 1e3, "bulk_modulus": 1e6, "shear_modulus": 5e5}


def row(count, cell):
    """Return a row of ``count`` discs of 1, 2, 3, … times the density, and a block far away."""
    bodies = {"block": rectangle(0.0, -1.2, 0.4, -0.8)}
    for k in range(count):
        moving = {"rigid": {"density": 1000.0 * (k + 1)}, "velocity": [0.0 if k else SPEED, 0.0]}
        bodies[f"disc{k}"] = disc(0.3 + 0.52 * k, 0.3, RADIUS, segment=0.01, **moving)
    more = {"contact": {"method": "lcp"}, "output": {"particles": False}}
    return scene(cell, [-0.4, -1.6], [3.2, 1.2], 0.02 * count + 0.4, 0.02, RUBBER, bodies, **more)


cradle = Runs(
    "cradle",
    row,
    methods(["lcp"], bound=True) + methods(["impulse"], when="full"),
    [
        Place(f"{count} discs, h = {cell:g} m", make={"count": count, "cell": cell})
        for count, cell in ((2, 0.1), (4, 0.1), (4, 0.05))
    ],
)


def errors(tree):
    """Return errors of the sum of momenta, of the energy that is left, and the largest of a velocity."""
    series = tree["series"].to_dataset().isel(body=slice(1, None))
    momentum, energy = series["linear_momentum"].sel(axis="x").values, series["kinetic_energy"].values
    mass = momentum[0, 0] / SPEED * np.arange(1, momentum.shape[1] + 1)
    total = mass[0] * SPEED
    velocity = momentum[-1] / mass * mass.sum() / total - 1.0
    return {
        "momentum": np.abs(momentum.sum(axis=1) / total - 1.0).max(),
        "energy": 100.0 * (energy[-1].sum() / energy[0].sum() * mass.sum() / mass[0] - 1.0),
        "velocity": 100.0 * velocity[np.abs(velocity).argmax()],
    }


@cradle
def test_cradle(run):
    run.gates(
        errors,
        ("sum of momenta, largest change, {at}", "momentum", 0.0, 1e-12),
        ("energy that is left, error, {at}", "energy", 0.0, 1.0, "%"),
        ("velocity, largest error of a disc, {at}", "velocity", 0.0, 2.0, "%"),
    )


def stack(safety, bricks=5, wide=0.4, high=0.1):
    """Return bricks that jut out by w / 2k over the ``safety``, k = 1, 2, … from the top, and μ."""
    left = np.cumsum([0.0, *(-wide / (2.0 * k * safety) for k in range(1, bricks))])[::-1]
    lower = [(x, high * k) for k, x in enumerate(left)]
    return [[(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)] for x, y in lower], 0.5


def cards(safety, foot=0.25, high=0.5, wide=0.03):
    """Return two cards that lean against each other, cut along the floor and upright, and μ over its least.

    Where they slide, they touch at the top alone, and stand on the inner ends of their feet."""
    top = high * (1.0 + wide / foot)
    corners = np.array([[-foot - wide, 0.0], [-foot, 0.0], [0.0, high], [0.0, top]])
    x, y = corners.T
    parts = x * np.roll(y, -1) - np.roll(x, -1) * y
    centre = ((x + np.roll(x, -1)) * parts).sum() / (3.0 * parts.sum())
    return [corners, corners[::-1] * [-1.0, 1.0]], safety * (foot + centre) / top


def arch(safety, stones=12):
    """Return half a circle of stones, ``safety`` times as thick as the thinnest that stands, and μ."""
    lie, thick = np.pi / stones * np.arange(stones + 1), safety * bisect(spare, 0.02, 0.3, (stones,))
    inner, outer = (r * np.stack([np.cos(lie), np.sin(lie)], axis=1) for r in (1 - thick / 2, 1 + thick / 2))
    return [[inner[k + 1], inner[k], outer[k], outer[k + 1]] for k in range(stones)], 0.9


def spare(thick, stones):
    """Return a number that is positive if an arch stands, by the safe theorem (Heyman 1966).

    A thrust H at the height y of the crown has with the weights a resultant in every joint between its ends:
    their moments about these have opposite signs, and are linear in H and H y."""
    half, joint = 0.5 * np.pi / stones, np.pi / stones * np.arange(stones // 2, 0, -1)
    inner, outer = 1.0 - 0.5 * thick, 1.0 + 0.5 * thick
    arm = 2.0 / 3.0 * np.cos(half) * (outer**3 - inner**3) / (outer**2 - inner**2)  # of a stone's centroid
    moment = np.cumsum([0.0, *(arm * np.cos(joint[:-1] - half))])
    table, most = [], []
    for sign, radius in ((1.0, inner), (-1.0, outer)):
        table += [(sign * radius * np.sin(angle), -sign, 1.0) for angle in joint]
        most += list(sign * (moment - np.arange(len(joint)) * radius * np.cos(joint)))
    return -linprog([0.0, 0.0, -1.0], table, most, bounds=[(0, None), (0, None), (None, None)]).fun


def standing(build, safety):
    """Return rigid blocks under gravity that touch; those of an arch at its feet are at rest."""
    blocks, friction = build(safety)
    bodies = {"block": rectangle(-1.9, -0.9, -1.5, -0.5, sides=fixed(bottom="xy"))}
    bodies["floor"] = rectangle(-4.0, -0.2, 4.0, 0.0, rigid=True)
    for k, points in enumerate(blocks):
        rests = build is arch and k in (0, len(blocks) - 1)
        bodies[f"block{k}"] = polygon(points, rigid=True if rests else {"density": 1e3})
    more = {"gravity": {"vector": [0.0, -10.0]}, "output": {"particles": False}}
    more |= {"contact": {"method": "lcp", "friction": friction}}
    return scene(0.1, [-2.0, -1.0], [2.0, 2.0], 0.6, 0.03, RUBBER, bodies, **more)


stood = Runs(
    "standing",
    standing,
    methods(["lcp"], bound=True) + methods(["impulse"], when="full"),
    [
        Place(f"{build.__name__}, {100 * safety:g} %", make={"build": build, "safety": safety}, when=when)
        for build, share, when in ((stack, 0.03, ""), (cards, 0.03, "full"), (arch, 0.05, "full"))
        for safety in (1.0 + share, 1.0 - share)
    ],
)


@stood
def test_standing(run):
    """Ask for less than 1 mm where a pile must stand, and more than 10 mm where it must fall."""
    centre = run.results["series"]["centre_of_mass"].values[:, 2:]
    farthest = 1e3 * float(np.nanmax(np.linalg.norm(centre - centre[0], axis=-1)))
    limits = (0.0, 1.0) if run.place.make["safety"] > 1.0 else (10.0, np.inf)
    run.gate(f"farthest way of a block, {run.place.at} of its limit", farthest, "", limits, "mm")
