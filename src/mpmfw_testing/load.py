"""The checks of loads, on a moving square or cube, alone or beside another body."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.step.schemes import interpolate, project
from mpmfw_testing.bench import STEP, dims_of, in_each_dimension, square
from mpmfw_testing.check import Inapplicable, remember, within
from mpmfw_testing.generic import repeatable, runs, sent, unchanged
from mpmfw_testing.subject import Subject

#: Times at which forces are read [s].
TIMES = (0.0, 1e-3, 0.1, 10.0)
#: Share of the force by which half the size of the points may change it: forces by place, on parts of a body,
#: are accurate to a row of points. A force by point instead of volume is four times as large.
REFINED = 0.3
#: Rounding of momenta, as a share of the body's own.
ROUNDING = 1e-12


class Bench:
    """A body with a load, before its first step; ``size`` [m] is that of its points.

    ``beside`` it there may be another body, on which the load does not act.
    """

    def __init__(self, load: Any, dim: int, size: float = 0.25, *, beside: bool = False) -> None:
        self.dim, self.load = dim, load
        mapping = square(dim, size, beside=beside)
        remember(mapping, 1)
        self.simulation = Simulation(load_scene(mapping), loads={"checked": load})
        self.state = self.simulation.state
        self.body = self.state.bodies[-1]
        load.bodies = (self.body,)
        if self.state.surface is not None:
            own = self.state.surface.facets_of(self.body.index)
            load.facets = np.arange(own.start, own.stop)
        self.simulation.start()

    def nodal_forces(self, time: float = 0.0) -> FloatArray:
        """Return the forces (n_nodes, dim) [N] that the load adds to the nodes at a ``time`` [s]."""
        hook, state, grid = self.simulation.hook, self.state, self.state.grid
        phi = interpolate(state, hook, self.simulation.clock)
        project(state.particles, phi, grid)
        hook.detect(grid=grid, phi=phi, particles=state.particles)
        state.time = time
        hook.add_nodal_force(grid=grid, state=state, phi=phi, dt=STEP)
        return grid.force.copy()

    def advance(self) -> Iterator[tuple[str, AnyArray]]:
        """Yield the nodal forces at several times."""
        for time in TIMES:
            yield f"nodal forces in {self.dim}D at {time} s", self.nodal_forces(time)

    def resultant(self, time: float = 0.0) -> FloatArray:
        """Return sum [N] and moment about the origin [N m] of the forces, (6,)."""
        force = np.pad(self.nodal_forces(time), ((0, 0), (0, 3 - self.dim)))
        arm = np.pad(self.state.grid.position, ((0, 0), (0, 3 - self.dim)))
        return np.concatenate([force.sum(axis=0), np.cross(arm, force).sum(axis=0)])


def openings(subject: Subject) -> Iterator[Callable[[Any], Bench]]:
    """Yield a body of each dimension, whose forces are read at four times."""
    for dim in dims_of(subject):
        yield functools.partial(Bench, dim=dim)


@in_each_dimension
def changes_nothing_else(subject: Subject, dim: int) -> None:
    """It changes nothing but the nodal forces. Arrays of points and grid keep their bits."""
    bench = Bench(subject.make(), dim)
    bench.nodal_forces()
    with unchanged("the load", bench.state.particles, bench.state.grid, but=("force",)):
        bench.nodal_forces()


@in_each_dimension
def own_body(subject: Subject, dim: int) -> None:
    """It acts on its own bodies alone, by their own state. Beside another body, which comes before it, the
    loaded one has the forces that it has alone; the other has none."""
    alone = Bench(subject.make(), dim).resultant()
    try:
        bench = Bench(subject.make(), dim, beside=True)
    except Exception as error:
        raise Inapplicable(f"the load takes one body alone: {error}") from error
    found, force = bench.resultant(), bench.nodal_forces()
    others = np.abs(force[bench.state.grid.field_nodes(bench.state.bodies[0].field)]).max()
    within(others, 0.0, "the load acts on a body that the scene does not name")
    text = "another body changes the force on the loaded one"
    within(np.abs(found - alone).max(), 1e-9 * np.abs(alone).max(), text)


@in_each_dimension
def impulse(subject: Subject, dim: int) -> None:
    """A body gains the impulse of the load's forces, and nothing else. To 1e-12 of its momentum."""
    force = Bench(subject.make(), dim).nodal_forces().sum(axis=0)
    bench = Bench(subject.make(), dim)
    p = bench.state.particles
    before = p.mass @ p.velocity
    bench.simulation.step(STEP)
    off = np.abs(p.mass @ p.velocity - before - STEP * force).max()
    scale = np.abs(before).max() + STEP * np.abs(force).max()
    text = "the momentum that the body gains in a step is not the impulse of the load's forces"
    within(off, ROUNDING * scale, text)


@in_each_dimension
def power(subject: Subject, dim: int) -> None:
    """Energy is gained by the power of the forces, force times velocity. The energy that a step gives the
    grid is Δt Σ f_i·v_i with the mean of the velocities before and after, to 1e-9 of it."""
    force = Bench(subject.make(), dim).nodal_forces()
    bench = Bench(subject.make(), dim)
    bench.simulation.step(STEP)
    grid = bench.state.grid
    start, end = (0.5 * grid.mass @ (v**2).sum(axis=1) for v in (grid.start_velocity, grid.velocity))
    work = STEP * (force * 0.5 * (grid.start_velocity + grid.velocity)).sum()
    text = "the energy that the body gains is not the power of the load's forces"
    within(abs(end - start - work), 1e-9 * abs(work) + ROUNDING * start, text)


@in_each_dimension
def refinement(subject: Subject, dim: int) -> None:
    """The force is that of the body, however it is divided into points. Force and moment of a body change by
    at most 30 % of the largest when its points have half the size, and by half of that when they are halved
    again."""
    for time in TIMES:
        found = [Bench(subject.make(), dim, size).resultant(time) for size in (0.25, 0.125, 0.0625)]
        scale = max(np.abs(each).max() for each in found)
        for k in (0, 1):
            off = np.abs(found[k + 1] - found[k]).max()
            text = "the force depends on how finely the body is divided into points"
            case = {"time [s]": time, "size of the points [m]": 0.125 / 2**k}
            within(off, REFINED * scale / 2**k, text, case)


#: Those first whose failure makes others fail as well.
CHECKS = (runs, repeatable, changes_nothing_else, own_body, impulse, power, refinement, sent)
