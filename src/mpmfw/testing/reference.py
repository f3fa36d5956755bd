"""The checks of a reference: what it says of its example is what a run of the example does."""

from __future__ import annotations

import copy
import functools
import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.measures import MEASURES
from mpmfw.fields import FloatArray
from mpmfw.measure import About, Exact, Measure, Reference
from mpmfw.runs import run
from mpmfw.scene import Scene, load_scene
from mpmfw.testing.check import Check, Violation
from mpmfw.testing.measure import blocks, require_exact
from mpmfw.testing.sent import SENT
from mpmfw.testing.subject import Subject

#: How far a run of the example may be from what is known of it, as a share of its largest.
AGREES = 0.1


def runs(subject: Subject) -> None:
    """Of its example it knows a bundled measure: finite values of the right shape, with kind and words."""
    known = list(_known(subject.make(), _example(subject)))
    if not known:
        raise Violation("it knows no measure of its own example", {"measures": ", ".join(MEASURES)})
    for measure, about, found in known:
        require_exact(found, measure.kind, np.linspace(0.0, 0.5, 6), _case(measure, about))


def agrees(subject: Subject) -> None:
    """A run of the example is what it says, for every body, pair and axis of which it says anything, to 10 % of the largest."""
    scene = _example(subject)
    for measure, about, found in _known(subject.make(), scene):
        measured = measure.of(_run(json.dumps(_mapping(subject))), scene, about)
        times = measured.time if measure.kind == "curve" else np.zeros(1)
        wanted: FloatArray = np.asarray(found.at(times), dtype=float)
        scale = float(np.abs(wanted).max())
        apart = float(np.abs(measured.values - wanted).max())
        if not apart <= AGREES * scale:
            raise Violation(
                "a run of the example is not what the reference says (off by a share of the largest)",
                _case(measure, about), measured=apart / scale if scale else np.inf, bound=AGREES,
            )  # fmt: skip


def others(subject: Subject) -> None:
    """Of three blocks that collide, of which nothing is known, it says None: a scene that is not of its kind has no reference."""
    made, scene = subject.make(), load_scene(blocks())
    for measure, about, _ in _known(made, scene):
        raise Violation(
            "it claims to know a scene that is not of its kind: three blocks that collide",
            _case(measure, about),
        )


def repeatable(subject: Subject) -> None:
    """Asked again after another scene, and of a fresh object, it says the same to the bit; the scene stays as it is."""
    made, scene = subject.make(), _example(subject)
    before = scene.model_dump()
    first = _values(made, scene)
    list(_known(made, load_scene(blocks())))
    if _values(made, scene) != first or _values(subject.make(), scene) != first:
        raise Violation("it says something else when it is asked again")
    if scene.model_dump() != before:
        raise Violation("it changes the scene")


def _mapping(subject: Subject) -> dict[str, Any]:
    """A copy of the example."""
    example = getattr(subject.plugin or type(subject.make()), "example", None)
    if not example:
        raise Violation(
            "it has no example; expected a scene of its kind as nested mappings, in the attribute 'example'"
        )
    return {key: value for key, value in copy.deepcopy(dict(example)).items() if key != "reference"}


def _example(subject: Subject) -> Scene:
    return load_scene(_mapping(subject))


@functools.lru_cache(maxsize=2)
def _run(example: str) -> xr.DataTree:
    return run(load_scene(json.loads(example)))


def _known(made: Reference, scene: Scene) -> Iterator[tuple[Measure, About, Exact]]:
    """All that is known of a scene: bundled measures, and what of."""
    pairs = [f"{a}-{b}" for a, b, _ in scene.pairs]
    values: dict[str, list[Any]] = {
        "body": list(scene.bodies),
        "pair": pairs,
        "axis": list("xyz"[: scene.dim]),
    }
    for measure in list(MEASURES.values()):
        abouts = [About()]
        for key in measure.keys:
            abouts = [About(**{**vars(about), key: value}) for about in abouts for value in values[key]]
        for about in abouts:
            if (found := made.exact(scene, measure.name, about)) is not None:
                yield measure, about, found


def _values(made: Reference, scene: Scene) -> list[bytes]:
    times = np.linspace(0.0, 0.5, 6)
    return [np.asarray(found.at(times), dtype=float).tobytes() for _, _, found in _known(made, scene)]


def _case(measure: Measure, about: About) -> dict[str, object]:
    return {
        "measure": measure.name,
        **{key: value for key, value in vars(about).items() if value is not None},
    }


def reference_checks() -> list[Check]:
    """All checks of a reference: those first whose failure makes others fail as well."""
    return [
        Check("runs", "It knows something of its own example.", runs),
        Check("agrees", "A run of the example is what it says.", agrees),
        Check("others", "It claims nothing of a scene that is not of its kind.", others),
        Check("repeatable", "The same scene gives the same answer.", repeatable),
        SENT,
    ]
