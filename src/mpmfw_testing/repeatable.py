"""The one check of boundaries, outputs, measures and references: they run, and give the same values again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmfw.campaigns.measures import MEASURES, inferred
from mpmfw.plugin.measure import About
from mpmfw.results import Frame
from mpmfw.runs.run import run
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import AnyArray
from mpmfw_testing.check import Inapplicable, Violation
from mpmfw_testing.generic import require_repeatable
from mpmfw_testing.load.bench import dims_of, scene
from mpmfw_testing.saving import remember
from mpmfw_testing.sent import sent
from mpmfw_testing.subject import Subject

#: Steps of a run, with an output after each.
STEPS = 4
#: Tables of a scene that name plug-ins of a kind.
TABLES = {"boundary": "boundaries", "output": "outputs"}


def repeatable(subject: Subject) -> None:
    """Two fresh objects give the same values. The same bits, none of them infinite."""
    require_repeatable(lambda: _values(subject))


def _values(subject: Subject) -> Iterator[tuple[str, AnyArray]]:
    """All values that an object gives in a small scene, by name."""
    if subject.kind in TABLES:
        for dim in dims_of(subject):
            yield from _series(subject, dim)
    elif subject.kind == "measure":
        measure, blocks = subject.make(), load_scene(_blocks())
        tree = run(blocks)
        yield measure.name, measure.of(tree, blocks, inferred(measure, tree, blocks, About())).values
    else:
        made, example = subject.make(), _example(subject)
        known = {name: made.exact(example, name, About(axis="x")) for name in MEASURES}
        if not any(known.values()):
            raise Violation("the reference gives no measure of its own example")
        for name, exact in known.items():
            if exact is not None:
                yield name, np.asarray(exact.at(np.linspace(0.0, 0.5, 6)), dtype=float)


def _series(subject: Subject, dim: int) -> Iterator[tuple[str, AnyArray]]:
    """Series at the start and after each step, and the points' positions at the end."""
    plugin = subject.plugin
    if plugin is None or "<" in plugin.__qualname__:
        raise Inapplicable("a scene cannot name it: expected a class of a module")
    bodies = {"bodies": ["loaded"]} if subject.kind == "boundary" else {}
    table = {"model": f"{plugin.__module__}:{plugin.__qualname__}", **bodies, **subject.options}
    mapping = {**scene(dim, 0.25, beside=True), TABLES[subject.kind]: {"checked": table}}
    remember(mapping, STEPS)
    simulation, frames = Simulation(load_scene(mapping)), list[Frame]()
    simulation.start()
    simulation.advance(STEPS, frames.append)
    for step, frame in enumerate(frames):
        for name, values in frame.series.items():
            yield f"{name} in {dim}D after {step} steps", np.array(values, dtype=float)
    yield f"positions in {dim}D", simulation.state.particles.position


def _blocks() -> dict[str, Any]:
    """Two bodies, one of which moves, with four outputs."""
    return {**scene(2, 0.25, beside=True), "time": {"end": 4e-4, "output_interval": 1e-4, "step": 1e-5}}


def _example(subject: Subject) -> Any:
    example = getattr(subject.plugin or type(subject.make()), "example", None)
    if not example:
        raise Violation("the attribute 'example' is missing; expected a scene as nested mappings")
    return load_scene({key: value for key, value in example.items() if key != "reference"})


#: In the order in which they are run.
CHECKS = (repeatable, sent)
