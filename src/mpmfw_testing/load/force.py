"""What the forces of a load must add up to."""

from __future__ import annotations

import numpy as np

from mpmfw_testing.check import within
from mpmfw_testing.load.bench import STEP, Bench, dims_of
from mpmfw_testing.load.contract import TIMES
from mpmfw_testing.subject import Subject

#: Share of the force by which half the size of the points may change it: forces by place, on parts of a body,
#: are known to a row of points. A force by point in place of volume is four times as large.
REFINED = 0.3

#: Rounding of momenta, as a share of the body's own.
ROUNDING = 1e-12


def impulse(subject: Subject) -> None:
    """A body gains the impulse of the load's forces, and nothing else. To 1e-12 of its momentum."""
    for dim in dims_of(subject):
        force = Bench(subject, dim).nodal_forces().sum(axis=0)
        bench = Bench(subject, dim)
        before = bench.momenta()[0]
        bench.simulation.step(STEP)
        gained = bench.momenta()[0] - before
        scale = np.abs(before).max() + STEP * np.abs(force).max()
        within(
            float(np.abs(gained - STEP * force).max()), ROUNDING * scale,
            "the momentum that the body gains in a step is not the impulse of the load's "
            "forces", {"dim": dim},
        )  # fmt: skip


def power(subject: Subject) -> None:
    """Energy is gained by the power of the forces, force times velocity. The energy that a step gives the
    grid is Δt Σ f_i·v_i with the mean of the velocities before and after, to 1e-9 of it."""
    for dim in dims_of(subject):
        force = Bench(subject, dim).nodal_forces()
        bench = Bench(subject, dim)
        bench.simulation.step(STEP)
        grid = bench.state.grid
        mean = 0.5 * (grid.start_velocity + grid.velocity)
        change = 0.5 * grid.mass @ ((grid.velocity**2).sum(axis=1) - (grid.start_velocity**2).sum(axis=1))
        work = STEP * float((force * mean).sum())
        energy = 0.5 * float(grid.mass @ (grid.start_velocity**2).sum(axis=1))
        within(
            abs(float(change) - work), 1e-9 * abs(work) + ROUNDING * energy,
            "the energy that the body gains is not the power of the load's forces", {"dim": dim},
        )  # fmt: skip


def refinement(subject: Subject) -> None:
    """The force is that of the body, however it is divided into points. Force and moment of a body change by
    at most 30 % of the largest when its points have half the size, and by half of that when they are halved
    again."""
    for dim in dims_of(subject):
        for time in TIMES:
            found = [Bench(subject, dim, size).resultant(time) for size in (0.25, 0.125, 0.0625)]
            scale = max(np.abs(each).max() for each in found)
            for k in (0, 1):
                within(
                    float(np.abs(found[k + 1] - found[k]).max()), REFINED * scale / 2**k,
                    "the force depends on how finely the body is divided into points",
                    {"dim": dim, "time [s]": time, "size of the points [m]": 0.125 / 2**k},
                )  # fmt: skip


#: In the order in which they are run.
CHECKS = (impulse, power, refinement)
