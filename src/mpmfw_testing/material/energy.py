"""Energy: the work of the stress is stored or lost, and what is lost never comes back."""

from __future__ import annotations

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Violation, within
from mpmfw_testing.material.bench import Bench, dims_of, path
from mpmfw_testing.subject import Subject

#: Work that is neither stored nor lost, over the largest work of the path.
UNEXPLAINED = 0.02
#: Energy that may come back, over K + 4 G / 3.
RETURNED = 1e-14
SIZES, STEPS = (1e-3, 0.1, 0.4), 2000


def _history(bench: Bench, steps: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Work, stored and lost energy at every step, (n_steps, n) [J/m^3]."""
    work, energy, lost = [np.zeros(steps.shape[1])], [], []
    before: FloatArray | None = None
    for k, f in enumerate(steps):
        stress = bench.deform(f)
        piola = np.linalg.det(f)[:, None, None] * stress @ np.swapaxes(np.linalg.inv(f), 1, 2)
        if before is not None:
            work.append(work[-1] + 0.5 * np.einsum("nij,nij->n", before + piola, f - steps[k - 1]))
        before = piola
        energy.append(bench.energy())
        lost.append(bench.dissipated())
    return np.array(work), np.array(energy), np.array(lost)


def work(subject: Subject) -> None:
    """The work of the stress is stored or lost. Along paths of 2000 steps ∫ P : dF is the change of the
    stored energy and what was lost, to 2 % of the largest work.

    At every step, at strains of 0.1, 10 and 40 %, with rotation and most of the way back. A stress that is no
    gradient of its energy misses it by its own size.
    """
    for dim in dims_of(subject):
        for size in SIZES:
            bench = Bench(subject, dim, 4)
            work, energy, lost = _history(bench, path(dim, 4, size, STEPS))
            rest = np.abs(work - (energy - energy[0]) - (lost - lost[0]))
            share = rest / np.abs(work).max(axis=0)
            step, point = np.unravel_index(int(np.argmax(share)), share.shape)
            case: dict[str, object] = {
                "dim": dim,
                "strain": size,
                "step": int(step),
                "work [J/m^3]": float(work[step, point]),
                "unexplained [J/m^3]": float(rest[step, point]),
            }
            message = "the work of the stress is neither stored nor lost (a share of the largest work)"
            within(float(share.max()), UNEXPLAINED, message, case)


def loss(subject: Subject) -> None:
    """What is lost never comes back, and is declared. What is lost grows or stays in every step, to 1e-14 of
    K + 4 G / 3.

    A material that says ``dissipates = False`` loses nothing.
    """
    for dim in dims_of(subject):
        bench = Bench(subject, dim, 4)
        _, _, lost = _history(bench, path(dim, 4, SIZES[1], 200))
        if not bench.material.dissipates and np.any(lost):
            raise Violation(
                "the material loses energy, and says dissipates = False: no series has it", {"dim": dim}
            )
        back = float(-np.diff(lost, axis=0).min()) / bench.modulus
        within(back, RETURNED, "energy that was lost comes back (over K + 4 G / 3)", {"dim": dim})


#: In the order in which they are run.
CHECKS = (work, loss)
