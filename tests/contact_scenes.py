"""Small contact scenes as nested mappings, every contact strategy by name, and runs of a few dozen steps."""

import math
from dataclasses import dataclass

import numpy as np

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of

CELL = 0.1  # m
MU = 0.3
STEP = 1e-3  # s, below every stability limit of these scenes

#: Name → contact method and its options. Interfaces of the scenes are normal to x, out of the first body.
STRATEGIES = {
    "none": ("none", {}),
    "separate": ("separate", {}),
    "bardenhagen": ("bardenhagen", {}),
    "bardenhagen-position": ("bardenhagen", {"criterion": "position"}),
    "bardenhagen-master": ("bardenhagen", {"normal": "master"}),
    "bardenhagen-position-master": ("bardenhagen", {"criterion": "position", "normal": "master"}),
    "bardenhagen-specified": ("bardenhagen", {"normal": "specified", "direction": [1.0, 0.0]}),
    "penalty": ("penalty", {}),
    "penalty-one-pass": ("penalty", {"passes": "one"}),
    "hamad2017": ("hamad2017", {}),
    "lcp": ("lcp", {}),
    "lcp-nodes": ("nodes+lcp", {}),
    "hybrid": ("hybrid", {}),
    "barrier": ("barrier", {}),
    "midplane": ("midplane", {}),
    "nairn": ("nairn", {}),
    "particles": ("particles", {}),
}
#: Those that report an impulse.
ACTING = [name for name in STRATEGIES if name not in ("none", "separate")]


def material(bulk, density):
    """A Neo-Hookean solid with G = K / 2 [Pa]."""
    return {"model": "neo_hookean", "density": density, "bulk_modulus": bulk, "shear_modulus": 0.5 * bulk}


MATERIALS = {
    "soft": material(6e4, 1000.0),
    "stiff": material(2.4e5, 2000.0),
    "stiffer": material(4.8e5, 3000.0),
    "firm": material(1.2e6, 1000.0),  # hardly bends under its own weight
    "ground": material(4.8e6, 2000.0),
}


def body(geometry, *, kind="soft", layout="lattice", **keys):
    """A body of particles of half a cell."""
    particles = {"layout": layout, "size": 0.5 * CELL}
    return {"material": kind, "geometry": geometry, "particles": particles, **keys}


def rectangle(lower, upper, **keys):
    """A rectangular body."""
    return body({"type": "rectangle", "lower": lower, "upper": upper}, **keys)


def disc(centre, radius, **keys):
    """A disc of quadrilaterals that follow its outline."""
    return body({"type": "disc", "centre": centre, "radius": radius}, layout="fitted", **keys)


def scene(bodies, *, friction=MU, extent=1.2, **keys):
    """A scene of these bodies in a square grid round the origin, without contact as yet."""
    materials = {b["material"]: dict(MATERIALS[b["material"]]) for b in bodies.values()}
    tables = {"contact": {"method": "separate", "friction": friction}, "materials": materials, **keys}
    return scene_of(bodies, CELL, [-extent] * 2, [extent] * 2, end=1.0, outputs=10, **tables)


def impact(*, gap=0.01, speed=1.0, slide=0.1, right="stiff", **keys):
    """Two blocks that approach along x, the left one soft."""
    return scene(
        {
            "left": rectangle([-0.43, -0.2], [-0.03, 0.2], velocity=[0.5 * speed, slide]),
            "right": rectangle(
                [gap - 0.03, -0.17], [gap + 0.37, 0.23], kind=right, velocity=[-0.5 * speed, 0.0]
            ),
        },
        **keys,
    )


def slider(*, gap=0.0, **keys):
    """A small block pressed against a tall one, along which it slides upwards; both are free."""
    return scene(
        {
            "left": rectangle([-0.3, -0.5], [0.0, -0.2], velocity=[0.3, 1.0]),
            "right": rectangle([gap, -0.8], [gap + 0.3, 0.8], kind="stiff", velocity=[0.0, 0.0]),
        },
        **keys,
    )


def three_meet(order=("left", "right", "top"), **keys):
    """Three blocks of different stiffness that meet at one spot."""
    bodies = {
        "left": rectangle([-0.41, -0.3], [-0.01, 0.1], velocity=[1.0, 0.1]),
        "right": rectangle([0.0, -0.3], [0.4, 0.1], kind="stiff", velocity=[-0.5, 0.0]),
        "top": rectangle([-0.2, 0.11], [0.2, 0.51], kind="stiffer", velocity=[0.0, -0.6]),
    }
    return scene({name: bodies[name] for name in order}, **keys)


def simulation(strategy, mapping, **options):
    """The scene under a strategy, started; ``options`` go to the contact's own table."""
    method, given = STRATEGIES[strategy]
    table = {**mapping["contact"], "method": method}
    if given or options:
        table[method] = {**given, **options}
    made = Simulation({**mapping, "contact": table})
    made.start()
    return made


@dataclass
class Motion:
    """What bodies did, by name, and the pairs' records; arrays have a row per step."""

    centre: dict[str, np.ndarray]  # (n + 1, 2) [m]
    momentum: dict[str, np.ndarray]  # (n + 1, 2) [N s/m]
    kinetic: np.ndarray  # (n + 1,) [J/m]
    impulse: np.ndarray  # (n, pair, 2) of every step, on the pair's first body [N s/m]
    work: np.ndarray  # (n, pair) frictional work of every step [J/m]

    @property
    def total_momentum(self):
        """(n + 1, 2)"""
        return np.sum(list(self.momentum.values()), axis=0)


def run(sim, steps, dt=STEP, each=None):
    """Take steps of length ``dt``; ``each`` looks at the simulation after every one."""
    rows = [_look(sim)]
    for _ in range(steps):
        sim.step(dt)
        rows.append(_look(sim))
        if each is not None:
            each(sim)
    names = [b.name for b in sim.state.bodies]
    return Motion(
        centre={n: np.array([row[0][i] for row in rows]) for i, n in enumerate(names)},
        momentum={n: np.array([row[1][i] for row in rows]) for i, n in enumerate(names)},
        kinetic=np.array([row[2] for row in rows]),
        impulse=np.diff([row[3] for row in rows], axis=0),
        work=np.diff([row[4] for row in rows], axis=0),
    )


def _look(sim):
    p = sim.state.particles
    slices = [b.particles for b in sim.state.bodies]
    centre = [p.mass[s] @ p.position[s] / p.mass[s].sum() for s in slices]
    momentum = [p.mass[s] @ p.velocity[s] for s in slices]
    kinetic = 0.5 * p.mass @ (p.velocity**2).sum(axis=1)
    records = getattr(sim.contact, "records", None)
    if records is None:
        return centre, momentum, kinetic, np.zeros((len(sim.state.pairs), 2)), np.zeros(len(sim.state.pairs))
    return centre, momentum, kinetic, records.impulse.copy(), records.frictional_work.copy()


def wave_speed(kind):
    """c = sqrt((K + 4 G / 3) / ρ) of a material of this module [m/s]."""
    m = MATERIALS[kind]
    return math.sqrt((m["bulk_modulus"] + 4.0 * m["shear_modulus"] / 3.0) / m["density"])
