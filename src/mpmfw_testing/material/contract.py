"""What a material may read and write."""

from __future__ import annotations

import numpy as np

from mpmfw_testing.check import Violation, within
from mpmfw_testing.generic import Values, require_repeatable, unchanged
from mpmfw_testing.material.bench import MARK, Bench, dims_of, path
from mpmfw_testing.subject import Subject

#: Strain of the paths here.
SIZE = 0.05
#: Arrays that a step of the bench writes, or that the material may.
WRITTEN = ("deformation_gradient", "volume", "stress")


def runs(subject: Subject) -> None:
    """The material can be set up, and answers with finite arrays of the right shape."""
    for dim in dims_of(subject):
        bench = Bench(subject, dim, 4)
        for f in path(dim, 4, SIZE, 10):
            stress = bench.deform(f)
        for name, found, shape in (
            ("stress", stress, (4, dim, dim)),
            ("energy_of_points", bench.energy(), (4,)),
            ("stress_of_points", bench.full_stress(), (4, 3, 3)),
            ("dissipated_by_points", bench.dissipated(), (4,)),
        ):
            if found.shape != shape:
                raise Violation(f"{name} has the shape {found.shape}; expected {shape}", {"dim": dim})
            if not np.isfinite(found).all():
                raise Violation(f"{name} is not finite", {"dim": dim})


def own_points(subject: Subject) -> None:
    """It writes the stress of its own points, and nothing else."""
    for dim in dims_of(subject):
        bench = Bench(subject, dim, 4)
        p = bench.particles
        for f in path(dim, 4, SIZE, 5):
            with unchanged("update_stress", p, but=WRITTEN, dim=dim):
                bench.deform(f)
            if not np.array_equal(p.deformation_gradient[bench.own], f):
                raise Violation("update_stress changes deformation_gradient", {"dim": dim})
        others = np.delete(p.stress, np.r_[bench.own], axis=0)
        if (others != MARK).any():
            raise Violation(
                "update_stress writes the stress of points that are not made of the material", {"dim": dim}
            )


def each_for_itself(subject: Subject) -> None:
    """A point answers for itself, in whatever company. A point's stress, energy and loss depend on its own
    deformations alone: bitwise the same in another order and company."""
    for dim in dims_of(subject):
        many, order = Bench(subject, dim, 6), np.array([4, 1, 5])
        few = Bench(subject, dim, 3)
        for f in path(dim, 6, SIZE, 10):
            stress, alone = many.deform(f), few.deform(f[order])
        pairs = (
            (stress[order], alone),
            (many.energy()[order], few.energy()),
            (many.dissipated()[order], few.dissipated()),
        )
        for name, (first, second) in zip(("stress", "energy", "loss"), pairs, strict=True):
            within(
                float(np.abs(first - second).max()),
                0.0,
                f"the {name} of a point depends on the points beside it",
                {"dim": dim},
            )


def repeatable(subject: Subject) -> None:
    """The same path gives the same bits."""

    def stresses() -> Values:
        for dim in dims_of(subject):
            bench = Bench(subject, dim, 4)
            yield f"stress in {dim}D", np.array([bench.deform(f) for f in path(dim, 4, SIZE, 10)])

    require_repeatable(stresses)


def declared_history(subject: Subject) -> None:
    """Its history is in arrays of the run, which are saved with it. What the stress depends on beside F is in
    arrays of the run: put back, the points go on with the same bits.

    The material is another object by then, as in a process that resumes a run.
    """
    for dim in dims_of(subject):
        steps = path(dim, 4, SIZE, 20)
        first = Bench(subject, dim, 4)
        for f in steps[:10]:
            first.deform(f)
        kept = {name: array.copy() for name, array in first.state.arrays.items()}
        expected = np.array([first.deform(f) for f in steps[10:]])
        second = Bench(subject, dim, 4)
        for name, array in kept.items():
            second.state.arrays[name][...] = array
        second.particles.deformation_gradient[second.own] = steps[9]
        found = np.array([second.deform(f) for f in steps[10:]])
        within(
            float(np.abs(found - expected).max()), 0.0,
            "the points have a history that is in no array of the run: a run that is resumed "
            "differs", {"dim": dim},
        )  # fmt: skip


#: In the order in which they are run.
CHECKS = (runs, own_points, each_for_itself, repeatable, declared_history)
