"""What a load may read, write and remember."""

from __future__ import annotations

import numpy as np

from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.generic import unchanged
from mpmfw_testing.load.bench import Bench, dims_of
from mpmfw_testing.subject import Subject

#: Times at which loads are asked [s].
TIMES = (0.0, 1e-3, 0.1, 10.0)


def runs(subject: Subject) -> None:
    """The load can be set up and answers with finite forces. Asked for a step, and at four times."""
    for dim in dims_of(subject):
        bench = Bench(subject, dim)
        for time in TIMES:
            if not np.isfinite(bench.nodal_forces(time)).all():
                raise Violation("the forces are not finite", {"dim": dim, "time [s]": time})
        Bench(subject, dim).simulation.step()


def writes_nothing(subject: Subject) -> None:
    """It changes nothing but the nodal forces. Arrays of points and grid keep their bits."""
    for dim in dims_of(subject):
        bench = Bench(subject, dim)
        bench.nodal_forces()
        state = bench.state
        with unchanged("the load", state.particles, state.grid, but=("force",), dim=dim):
            bench.nodal_forces()


def own_body(subject: Subject) -> None:
    """It acts on its own bodies alone, by what is theirs. Beside another body, which comes before it, the
    loaded one has the forces that it has alone; the other has none."""
    for dim in dims_of(subject):
        alone = Bench(subject, dim).resultant()
        try:
            bench = Bench(subject, dim, beside=True)
        except Exception as error:
            raise Inapplicable(f"the load takes one body alone: {error}") from error
        found, force = bench.resultant(), bench.nodal_forces()
        others = np.abs(force[bench.state.grid.field_nodes(bench.state.bodies[0].field)]).max()
        within(float(others), 0.0, "the load acts on a body that the scene does not name", {"dim": dim})
        scale = np.abs(alone).max()
        within(
            float(np.abs(found - alone).max()), 1e-9 * scale,
            "another body changes the force on the loaded one",
            {"dim": dim},
        )  # fmt: skip


def no_memory(subject: Subject) -> None:
    """Its force is a function of time and motion. The same bits, whatever was asked before."""
    for dim in dims_of(subject):
        fresh = [Bench(subject, dim).nodal_forces(time) for time in TIMES]
        bench = Bench(subject, dim)
        for time in (*TIMES, *reversed(TIMES)):
            found = bench.nodal_forces(time)
            within(
                float(np.abs(found - fresh[TIMES.index(time)]).max()), 0.0,
                "the force depends on what was asked before: it has a memory that is in no array of the run",
                {"dim": dim, "time [s]": time},
            )  # fmt: skip


#: In the order in which they are run.
CHECKS = (runs, writes_nothing, own_body, no_memory)
