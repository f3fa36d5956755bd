"""The checks of boundaries, outputs, measures and references: the generic ones."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mpmfw.campaigns.measures import MEASURES, inferred
from mpmfw.plugin.measure import About
from mpmfw.results import Frame
from mpmfw.runs.run import run
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import AnyArray
from mpmfw_testing.bench import Opened, dims_of, square
from mpmfw_testing.check import Inapplicable, Violation, remember
from mpmfw_testing.generic import repeatable, sent
from mpmfw_testing.subject import Subject

#: Steps of a run, with an output after each.
STEPS = 4
#: Tables of a scene that name plug-ins of a kind.
TABLES = {"boundary": "boundaries", "output": "outputs"}


def openings(subject: Subject) -> Iterator[Callable[[Any], Opened]]:
    """Yield small scenes of each dimension; of a measure one run, of a reference its example."""
    if subject.kind in TABLES:
        for dim in dims_of(subject):
            yield functools.partial(Opened, functools.partial(_series, subject, dim))
    elif subject.kind == "measure":
        yield functools.partial(Opened, _measured)
    else:
        yield functools.partial(Opened, _exact)


def _series(subject: Subject, dim: int, _made: Any) -> Iterator[tuple[str, AnyArray]]:
    """Yield series at the start and after each step, and the points' positions at the end."""
    plugin = subject.plugin
    if "<" in plugin.__qualname__:
        raise Inapplicable("a scene cannot name it: expected a class of a module")
    bodies = {"bodies": ["loaded"]} if subject.kind == "boundary" else {}
    table = {"model": f"{plugin.__module__}:{plugin.__qualname__}", **bodies, **subject.options}
    mapping = {**square(dim, beside=True), TABLES[subject.kind]: {"checked": table}}
    remember(mapping, STEPS)
    simulation, frames = Simulation(load_scene(mapping)), list[Frame]()
    simulation.start()
    simulation.advance(STEPS, frames.append)
    for step, frame in enumerate(frames):
        for name, values in frame.series.items():
            if np.isinf(values).any():
                raise Violation("a value is infinite", {"value": name})
            yield f"{name} in {dim}D after {step} steps", np.array(values, dtype=float)
    yield f"positions in {dim}D", simulation.state.particles.position


def _measured(measure: Any) -> Iterator[tuple[str, AnyArray]]:
    """Yield the measure of two bodies, one of which moves, with four outputs."""
    time = {"end": 4e-4, "output_interval": 1e-4, "step": 1e-5}
    scene = load_scene({**square(2, beside=True), "time": time})
    tree = run(scene)
    yield measure.name, measure.of(tree, scene, inferred(measure, tree, scene, About())).values


def _exact(reference: Any) -> Iterator[tuple[str, AnyArray]]:
    """Yield all measures that a reference gives of its example."""
    example = getattr(reference, "example", None)
    if not example:
        raise Violation("the attribute 'example' is missing; expected a scene as nested mappings")
    scene = load_scene({key: value for key, value in example.items() if key != "reference"})
    given = {name: reference.exact(scene, name, About(axis="x")) for name in MEASURES}
    if not any(given.values()):
        raise Violation("the reference does not measure its own example")
    for name, exact in given.items():
        if exact is not None:
            yield name, np.asarray(exact.at(np.linspace(0.0, 0.5, 6)), dtype=float)


#: In the order in which they are run.
CHECKS = (repeatable, sent)
