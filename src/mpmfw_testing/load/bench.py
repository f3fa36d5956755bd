"""A square, or a cube, under a load, alone or beside another body."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.plugin.discovery import available, load
from mpmfw.plugin.named import NamedPlugIn
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import FloatArray
from mpmfw.step.operations import interpolate, project
from mpmfw_testing.check import Inapplicable
from mpmfw_testing.saving import remember
from mpmfw_testing.subject import Subject

#: Length of a step [s].
STEP = 1e-5


def scene(dim: int, size: float, *, beside: bool) -> dict[str, Any]:
    """A moving body of points of a ``size`` [m] in cells of 0.5 m; ``beside`` it one at rest."""
    places = {"other": -2.5, "loaded": -0.5} if beside else {"loaded": -0.5}
    bodies: dict[str, dict[str, Any]] = {}
    for name, left in places.items():
        lower = [left, -0.5, -0.5][:dim]
        geometry = {
            "type": "rectangle" if dim == 2 else "box", "lower": lower, "upper": [x + 1.0 for x in lower]
        }  # fmt: skip
        bodies[name] = {
            "material": "soft", "geometry": geometry, "particles": {"size": size}, "rotation": "lumped"
        }  # fmt: skip
    bodies["loaded"]["velocity"] = [1.0, -0.5, 0.25][:dim]
    return {
        "grid": {"cell_size": 0.5, "lower": [-4.0] * dim, "upper": [4.0] * dim},
        "time": {"end": 1.0, "output_interval": 1.0, "step": STEP},
        "shape": {"method": "linear"},
        "stepping": {"scheme": "usl", "transfer": "flip"},
        "materials": {
            "soft": {"model": "linear_elastic", "density": 1000.0, "bulk_modulus": 5e6, "shear_modulus": 3e6}
        },
        "bodies": bodies,
        "output": {"gap": False},
        **({"contact": {"method": _letting_be()}} if beside else {}),
    }


def _letting_be() -> str:
    """Name of a contact that gives every body a velocity field of its own and does nothing between them."""
    for name in available("contact"):
        strategy = load("contact", name)
        if strategy.velocity_fields == "per_body" and not strategy.keeps_apart:
            return name
    raise Inapplicable("no installed contact lets bodies be")


class Bench:
    """A body with a load, before its first step.

    Parameters
    ----------
    subject
        The load under test.
    dim
        Number of space dimensions.
    size
        Of the material points [m].
    beside
        Whether there is another body, on which the load does not act.
    """

    def __init__(self, subject: Subject, dim: int, size: float = 0.25, *, beside: bool = False) -> None:
        self.dim, self.load = dim, subject.make()
        mapping = scene(dim, size, beside=beside)
        remember(mapping, 1)
        made = load_scene(mapping)
        self.simulation = Simulation(made, loads={"checked": self.load})
        self.state = self.simulation.state
        self.body = self.state.bodies[-1]
        self.load.bodies = (self.body,)
        if self.state.surface is not None:
            own = self.state.surface.facets_of(self.body.index)
            self.load.facets = np.arange(own.start, own.stop)
        self.simulation.start()

    def nodal_forces(self, time: float = 0.0) -> FloatArray:
        """Forces (n_nodes, dim) [N] that the load adds to the nodes at a ``time`` [s]."""
        simulation, state = self.simulation, self.state
        grid = state.grid
        phi = interpolate(state, simulation.hook, simulation.clock)
        project(state.particles, phi, grid)
        simulation.hook.detect(grid=grid, phi=phi, particles=state.particles)
        state.time = time
        simulation.hook.add_nodal_force(grid=grid, state=state, phi=phi, dt=STEP)
        return grid.force.copy()

    def resultant(self, time: float = 0.0) -> FloatArray:
        """Sum [N] and moment about the origin [N m] of the forces, (6,)."""
        force = np.pad(self.nodal_forces(time), ((0, 0), (0, 3 - self.dim)))
        arm = np.pad(self.state.grid.position, ((0, 0), (0, 3 - self.dim)))
        return np.concatenate([force.sum(axis=0), np.cross(arm, force).sum(axis=0)])

    def momenta(self) -> FloatArray:
        """Momentum of every body, (n_bodies, dim) [kg m/s]."""
        p = self.state.particles
        return np.array([p.mass[b.particles] @ p.velocity[b.particles] for b in self.state.bodies])


def dims_of(subject: Subject) -> tuple[int, ...]:
    """Dimensions that a plug-in with a table of its own works in, with its options."""
    made: NamedPlugIn = subject.make()
    found = tuple(d for d in made.dimensions if not list(type(made).problems(made.options, d)))
    if not found:
        raise Inapplicable(f"the {subject.kind} takes its options in no dimension")
    return found
