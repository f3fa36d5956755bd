"""The checks of a boundary condition: which points it holds, and how they move, on a square or a cube."""

from __future__ import annotations

import numpy as np

from mpmfw.boundary import Boundary
from mpmfw.fields import FloatArray
from mpmfw.scene import load_scene
from mpmfw.simulation import Simulation
from mpmfw.testing.check import Check, Inapplicable, Violation
from mpmfw.testing.load.bench import dims_of, scene, simulation_with
from mpmfw.testing.sent import SENT
from mpmfw.testing.subject import Subject

#: Times at which it is asked [s].
TIMES = (0.0, 1e-3, 0.1, 10.0)
#: Places (n, 3) [m] of a body of 1 m round the origin.
PLACES = np.random.default_rng(2).uniform(-0.5, 0.5, (20, 3))


def runs(subject: Subject) -> None:
    """``holds`` and ``velocity`` answer for every place, at four times: (n,) of truth values, (n, dim) of which none is infinite.

    And a square, or a cube, of which it holds a part takes a step.
    """
    for dim in dims_of(subject):
        made, places = subject.make(), PLACES[:, :dim].copy()
        held = np.asarray(made.holds(places.copy()))
        if held.shape != (len(places),):
            raise Violation(
                f"holds answers with the shape {held.shape}; expected {(len(places),)}", {"dim": dim}
            )
        for time in TIMES:
            found = np.asarray(made.velocity(places.copy(), time), dtype=float)
            if found.shape != places.shape or np.isinf(found).any():
                text = f"velocity answers with the shape {found.shape}; expected {places.shape}, none of them infinite"
                raise Violation(text, {"dim": dim, "time [s]": time})
        if held.any():
            simulation_with(subject, "boundaries", dim).step()


def no_memory(subject: Subject) -> None:
    """What moves is a function of place and time: asked again in another order, the same bits; runs are resumed without more."""
    for dim in dims_of(subject):
        made, places = subject.make(), PLACES[:, :dim].copy()
        fresh = {time: _answer(subject.make(), places, time) for time in TIMES}
        for time in (*TIMES, *reversed(TIMES)):
            _same(
                _answer(made, places, time),
                fresh[time],
                "what was asked before",
                {"dim": dim, "time [s]": time},
            )


def each_for_itself(subject: Subject) -> None:
    """A place is held, and moves, by where it is: the same bits in another order and with fewer places."""
    order = np.array([13, 2, 7, 5])
    for dim in dims_of(subject):
        places = PLACES[:, :dim].copy()
        for time in TIMES:
            few, whole = _answer(subject.make(), places[order], time), _answer(subject.make(), places, time)
            _same(few, whole[order], "which other places there are", {"dim": dim, "time [s]": time})


def as_prescribed(subject: Subject) -> None:
    """After three steps the nodes that are held move as ``velocity`` says at that time, and nothing is free that it names."""
    for dim in dims_of(subject):
        if not np.asarray(subject.make().holds(_points(dim))).any():
            raise Inapplicable("it holds nothing of a square or cube of 1 m round the origin")
        simulation = simulation_with(subject, "boundaries", dim)
        for _ in range(3):
            simulation.step()
        state, made = simulation.state, subject.make()
        grid = state.grid
        (own,) = (b for b in simulation.manager.get_plugins() if isinstance(b, Boundary))
        nodes = np.flatnonzero((own.node_mass > 0.5 * grid.mass) & (grid.mass > 0.0))
        wanted = np.asarray(made.velocity(grid.position[nodes].copy(), state.time), dtype=float)
        apart = np.abs(np.nan_to_num(grid.velocity[nodes] - wanted))
        scale = max(float(np.abs(np.nan_to_num(wanted)).max(initial=0.0)), 1e-3)
        if not len(nodes) or apart.max() > 1e-12 * scale:
            raise Violation(
                "nodes that are held do not move as prescribed", {"dim": dim, "nodes": len(nodes)},
                measured=float(apart.max(initial=0.0)), bound=1e-12 * scale,
            )  # fmt: skip


def own_body(subject: Subject) -> None:
    """A body that the scene does not name for it moves with the bits that it has without it."""
    for dim in dims_of(subject):
        if np.asarray(subject.make().holds(_points(dim))).any():
            held, free = (
                simulation_with(subject, "boundaries", dim, beside=True, named=named)
                for named in (True, False)
            )
            for each in (held, free):
                for _ in range(3):
                    each.step()
            other = held.state.bodies[0].particles
            moved, alone = (each.state.particles.velocity[other] for each in (held, free))
            if not np.array_equal(moved, alone):
                raise Violation("it moves a body that the scene does not name", {"dim": dim})


def _points(dim: int) -> FloatArray:
    """Material points of the body that is held, at the start."""
    return Simulation(load_scene(scene(dim, 0.25, beside=False))).state.particles.position.copy()


def _answer(made: Boundary, places: FloatArray, time: float) -> FloatArray:
    """Whether places are held, and how they move: (n, 1 + dim)."""
    held = np.asarray(made.holds(places.copy()), dtype=float)
    return np.column_stack([held, np.asarray(made.velocity(places.copy(), time), dtype=float)])


def _same(found: FloatArray, expected: FloatArray, what: str, case: dict[str, object]) -> None:
    if not np.array_equal(found, expected, equal_nan=True):
        raise Violation(f"what is held, or how it moves, depends on {what}", case)


def boundary_checks() -> list[Check]:
    """All checks of a boundary condition: those first whose failure makes others fail as well."""
    return [
        Check("runs", "It answers for every place and time.", runs),
        Check("no-memory", "What moves is a function of place and time.", no_memory),
        Check("each-for-itself", "A place moves by where it is, in whatever company.", each_for_itself),
        Check("as-prescribed", "What is held moves as it says.", as_prescribed),
        Check("own-body", "It holds its own bodies alone.", own_body),
        SENT,
    ]
