"""Options of contact, scenes in short, forces of a surface, stress and orders, for several cases."""

import sys
from pathlib import Path

import numpy as np

from mpmfw.api import hookimpl
from mpmfw.runs.simulation import Simulation

sys.path.append(str(Path(__file__).parent / "finite-elements"))  # for rings_fem and slider_fem

POSITION = {"contact.bardenhagen.criterion": "position"}
#: The normal of the stiffer body.
MASTER = {"contact.bardenhagen.normal": "master"}
#: Friction increments of [H17] to the letter, which nothing keeps below Coulomb's cap.
LITERAL = {"contact.hamad2017.friction_law": "literal"}


def specified(*direction):
    """Return a normal that is given."""
    return {"contact.bardenhagen.normal": "specified", "contact.bardenhagen.direction": list(direction)}


def over(key, label, values):
    """Return the settings of methods for each value of one key; ``label`` names it, as ``kappa {:.3g}``."""
    return {label.format(value): {key: value} for value in values}


def elastic(density, young, poisson, model="linear_elastic", **further):
    """Return a material."""
    return {"model": model, "density": density, "youngs_modulus": young, "poissons_ratio": poisson, **further}


def rectangle(left, bottom, right, top, angle=0.0, **body):
    """Return a body that is a rectangle, turned about its middle by ``angle`` [rad]."""
    shape = {"type": "rectangle", "lower": [left, bottom], "upper": [right, top]}
    return {"geometry": {**shape, "angle": angle} if angle else shape, **body}


def disc(x, y, radius=1.0, **body):
    """Return a body that is a disc."""
    return {"geometry": {"type": "disc", "centre": [x, y], "radius": radius}, **body}


def polygon(points, **body):
    """Return a body that is a polygon, anticlockwise."""
    return {"geometry": {"type": "polygon", "points": np.array(points, float).tolist()}, **body}


def fixed(**axes):
    """Return sides with the axes that are fixed: ``xy`` is all, ``bottom="y"``."""
    return [{"side": side, "fixed": True if held == "xy" else [held]} for side, held in axes.items()]


def scene(cell, lower, upper, end, interval, material, bodies, **tables):
    """Return a scene of one material (None: without), with CPDI and penalty contact; bodies that are not
    rigid are of it.

    ``tables`` are added to those that are made: grid, time, shape, contact (None: without), materials."""
    made = {
        "grid": {"cell_size": cell, "lower": list(lower), "upper": list(upper)},
        "time": {"end": end, "output_interval": interval},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty"},
        "materials": {"solid": material} if material else {},
    }
    for name, table in tables.items():
        made[name] = {**made[name], **table} if name in made and isinstance(table, dict) else table
    made = {name: table for name, table in made.items() if table is not None}
    usual = {"material": "solid", "particles": {"size": "0.5 cells"}}
    made["bodies"] = {name: body if "rigid" in body else {**usual, **body} for name, body in bodies.items()}
    return made


class HeldNodes:
    """Gives nodes on y = 0 below a strip its velocity, as finite elements do, without contact.

    ``impulse`` is what they took so far along −y [N s/m]."""

    name, impulse = "held_nodes", 0.0

    def __init__(self, half_width, rough):
        self.half_width, self.rough, self.velocity = half_width, rough, 0.0

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid):
        x, y = grid.position.T
        below = (np.abs(x) <= self.half_width + 1e-9) & (np.abs(y) < 1e-9)
        given = grid.mass[below] * self.velocity
        self.impulse -= float((given - grid.momentum[below, 1]).sum())
        grid.momentum[below, 1] = given
        if self.rough:
            grid.momentum[below, 0] = 0.0


def held_load(scene):
    """Return the mean load [N/m] over the last third on nodes held below the ``footing`` of a scene."""
    made = scene.to_mapping()
    strip, end = made["bodies"].pop("footing"), made["time"]["end"]
    rough = made.pop("contact")["friction"] > 0.0
    time, _, velocity = np.array(strip["rigid"]["motion"]["velocity"]).T
    made.pop("reference", None)
    simulation = Simulation(made)
    nodes = HeldNodes(strip["geometry"]["upper"][0], rough)
    with simulation.extra_plugin(nodes):
        for until in (2.0 * end / 3.0, end):
            before = nodes.impulse
            while simulation.state.time < until:
                nodes.velocity = np.interp(simulation.state.time, time, velocity)
                simulation.step_towards(until)
    return 3.0 * (nodes.impulse - before) / end


def observed_order(sizes, errors):
    """Return the slope of the least-squares line of log |error| over log(cell size)."""
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])


def nodes_of(tree, body, k):
    """Return positions [m] and forces [N/m], (n, 2) each, and lengths (n,) [m] of a body's surface nodes.

    They are those of output ``k``; half of each segment belongs to each of its nodes.
    """
    surface = tree[f"surface/{body}"].to_dataset().isel(time=k)
    position, after = surface["position"].values, surface["next"].values
    length = 0.5 * np.linalg.norm(position[after] - position, axis=1)
    length += np.bincount(after, length, len(length))
    return position, surface["force"].values, length


class PointForces:
    """Nodal forces f_i += Σ_p φ_ip m_p a_p of accelerations at the points, with the step's shape functions.

    A subclass has ``acceleration(state, dt)`` (n, dim) [m/s²] in a step of ``dt`` [s]."""

    name = "point_forces"

    @hookimpl
    def after_momentum_projection(self, phi):
        """Keep this step's table of shape functions."""
        self.phi = phi

    @hookimpl
    def add_nodal_force(self, grid, state, dt):
        """Add the forces of all points."""
        phi, force = self.phi, state.particles.mass[:, None] * self.acceleration(state, dt)
        point = np.repeat(np.arange(len(force)), np.diff(phi.row))
        np.add.at(grid.force, phi.nodes, phi.weight[:, None] * force[point])


PRESSURE, BLOCKS = 0.2e6, ("lower", "upper")  #: on the two blocks at rest of contact-stress [Pa]


def stress(tree):
    """Return errors of σ_yy of the points of two blocks at rest, 1 m wide, against −p at the end [%].

    Within a cell of the interface: the ``mean`` by volume, the largest ``departure``, and the largest one two
    cells ``off the walls``. Over both blocks: ``l2`` = sqrt(∫ (σ_yy + p)² dV / ∫ p² dV).
    """
    h, heights = float(tree.attrs["cell_size"]), []
    frames = [tree[f"particles/{body}"].to_dataset().isel(time=-1) for body in BLOCKS]
    x, y = np.concatenate([frame["position"].values for frame in frames]).T
    volume = np.concatenate([frame["volume"].values for frame in frames])
    ratio = np.concatenate([-frame["stress"].values[:, 1, 1] / PRESSURE for frame in frames])
    for body, at in zip(BLOCKS, (np.max, np.min), strict=True):  # of the nodes that met at the start
        nodes = tree[f"surface/{body}"]["position"].values[..., 1]
        heights.append(nodes[-1][np.abs(nodes[0] - at(nodes[0])) < 0.05 * h].mean())
    near = np.abs(y - float(np.mean(heights))) < h
    off_walls = near & (x > 2.0 * h) & (x < 1.0 - 2.0 * h)
    return {
        "mean": 100.0 * (np.average(ratio[near], weights=volume[near]) - 1.0),
        "departure": 100.0 * np.abs(ratio[near] - 1.0).max(),
        "off the walls": 100.0 * np.abs(ratio[off_walls] - 1.0).max(),
        "l2": 100.0 * np.sqrt(np.average((ratio - 1.0) ** 2, weights=volume)),
    }
