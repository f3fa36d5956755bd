"""Points of a neo-Hookean body, stepped by the real stepper and plug-ins: a block, or the colliding rings."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.runs.bodies import lay_out
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State
from mpmfw.state.windows import MARGIN, allocate_nodes
from mpmfw.step.schemes import usl
from mpmfw.step.timestep import Clock
from mpmfw.step.transfer import Transfer

#: All is of order one: h = 1 m, density 1 kg/m^3, moduli [Pa]; the step [s] is well below its limit.
BULK, SHEAR, DT = 1.0, 0.5, 0.1
#: Material points along each edge of a cell.
PER_CELL = 2
#: Standard deviation of the points' velocities [m/s]: the block jitters and stays where it is.
JITTER = 1e-4


@dataclass
class Block:
    """A block ready to be stepped."""

    state: State
    hook: Any
    transfer: Transfer
    clock: Clock
    half_edges: FloatArray  #: (n, dim, dim) [m]

    def step(self):
        """One step of update stress last."""
        usl(self.state, self.hook, self.transfer, self.clock, lambda: DT)


def make_block(shape, count, dim=2):
    """A cube of about ``count`` points at slightly irregular positions."""
    cells = max(1, round((count / PER_CELL**dim) ** (1.0 / dim)))
    corners = {"lower": [float(MARGIN)] * dim, "upper": [float(MARGIN + cells)] * dim}
    geometry = {"type": "rectangle" if dim == 2 else "box", **corners}
    block = _block_of({"block": geometry}, {"size": 1.0 / PER_CELL}, shape, cells, dim)
    position = block.state.particles.position
    position += np.random.default_rng(1).uniform(-0.1, 0.1, position.shape)
    return block


def make_rings(shape):
    """The points of the scene ``colliding-rings``, lengths in cells, in one velocity field."""
    rings = {
        name: {
            "type": "ring",
            "centre": [MARGIN + x, MARGIN + 20.0],
            "inner_radius": 15.0,
            "outer_radius": 20.0,
        }
        for name, x in (("left", 20.0), ("right", 62.0))
    }
    return _block_of(rings, {"layout": "fitted", "size": 0.25}, shape, 82, 2)


def _block_of(geometries, particles, shape, cells, dim):
    """Bodies that jitter and are slightly deformed, on a grid of so many cells and a margin on both sides."""
    solid = {"model": "neo_hookean", "density": 1.0, "bulk_modulus": BULK, "shear_modulus": SHEAR}
    scene = {
        "grid": {"cell_size": 1.0, "lower": [0.0] * dim, "upper": [cells + 2.0 * MARGIN] * dim},
        "time": {"end": 1.0, "output_interval": 1.0},
        "stepping": {"scheme": "usl", "transfer": "aflip"},
        "shape": {"method": shape},
        "materials": {"solid": {**solid, "energy": "log"}},
        "bodies": {
            name: {"material": "solid", "geometry": geometry, "particles": particles}
            for name, geometry in geometries.items()
        },
        "output": {"particles": False, "gap": False},
    }
    if len(geometries) > 1:
        scene["contact"] = {"method": "none"}
    else:
        scene["bodies"]["block"]["rotation"] = "lumped"
    sim = Simulation(scene)
    rng, p, grid = np.random.default_rng(0), sim.state.particles, sim.state.grid
    p.velocity[:] = JITTER * rng.normal(size=p.velocity.shape)
    p.deformation_gradient += rng.uniform(-1e-3, 1e-3, p.deformation_gradient.shape)
    grid.window_lower[:], grid.window_shape[:] = 0, grid.nodes  # the plain loop knows one cubic window
    allocate_nodes(grid)
    half_edges = np.concatenate([layout.half_edges for layout in lay_out(sim.scene)])
    return Block(sim.state, sim.hook, sim.transfer, sim.clock, half_edges)
