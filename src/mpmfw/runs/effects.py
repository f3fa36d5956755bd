"""All effects, in the order in which their hooks are called and ``mpmfw explain`` lists them.

Each decides in its own file: ``from_setup(setup)`` returns what acts, or the reason why nothing does. That
file is imported only if the scene calls for the effect.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pkgutil import resolve_name

from mpmfw.plugin.setup import Acts, Effect, Setup


@dataclass(frozen=True)
class Entry:
    """One effect, and the function that decides on it."""

    name: str  #: in ``explain``; empty where every run has the effect, or it lists its lines by itself
    decides: str  #: ``module:function``, which returns :class:`mpmfw.plugin.setup.Acts` or why not
    #: why the scene does not call for the effect; empty if it does
    absent: Callable[[Setup], str] = lambda setup: ""  # noqa: ARG005


def _no_gap(setup: Setup) -> str:
    return (
        "output.gap = false" if not setup.scene.output.gap else "one body" if len(setup.bodies) == 1 else ""
    )


def _no_gravity(setup: Setup) -> str:
    settle = setup.scene.settle
    settles = settle is not None and settle.gravity is not None
    return "" if setup.scene.gravity is not None or settles else "no [gravity]"


EFFECTS = (
    Entry("contact", "mpmfw.contact.planning:from_setup"),
    Entry("least gap", "mpmfw.effects.surface:GapDiagnostic.from_setup", _no_gap),
    Entry(
        "surfaces",
        "mpmfw.effects.surface:SurfaceTracker.from_setup",
        lambda setup: "" if setup.surface_users else "nothing needs outlines",
    ),
    Entry("gravity", "mpmfw.effects.gravity:Gravity.from_setup", _no_gravity),
    Entry(
        "settling",
        "mpmfw.effects.settling:from_setup",
        lambda setup: "" if setup.scene.settle is not None else "no [settle]",
    ),
    Entry(
        "prescribed sides",
        "mpmfw.effects.constraint:Constraint.from_setup",
        lambda setup: "" if setup.held_sides else "no fixed or moving side",
    ),
    Entry(
        "loads on sides",
        "mpmfw.effects.side_loads:from_setup",
        lambda setup: "" if setup.loaded_sides else "no side has a pressure, traction or force",
    ),
    Entry("", "mpmfw.plugin.named:from_setup"),
    Entry("", "mpmfw.effects.rotation:from_setup"),
    Entry("", "mpmfw.effects.series:BodySeries.from_setup"),
    Entry(
        "",
        "mpmfw.effects.verdict:Verdict.from_setup",
        lambda setup: "" if setup.whole is None else "all bodies are judged together",
    ),
    Entry(
        "",
        "mpmfw.effects.flutter:Flutter.from_setup",
        lambda setup: "" if setup.records_friction else "no friction force is recorded",
    ),
    Entry(
        "contact moment",
        "mpmfw.effects.contact_moment:ContactMoment.from_setup",
        lambda setup: "no output.contact_moment" if setup.scene.output.contact_moment is None else "",
    ),
    Entry(
        "energy ledger",
        "mpmfw.effects.ledger:EnergyLedger.from_setup",
        lambda setup: "" if setup.scene.output.ledger else "output.ledger = false",
    ),
    Entry(
        "stability series",
        "mpmfw.effects.time_step_series:TimeStepSeries.from_setup",
        lambda setup: "" if setup.scene.output.stability else "output.stability = false",
    ),
    Entry(
        "von Mises stress",
        "mpmfw.effects.series:VonMises.from_setup",
        lambda setup: "" if setup.scene.output.particles else "output.particles = false",
    ),
    Entry(
        "surface frames",
        "mpmfw.runs.frames:surface_frames",
        lambda setup: "" if setup.scene.output.surface else "output.surface = false",
    ),
    Entry(
        "sleep",
        "mpmfw.runs.sleeping:from_setup",
        lambda setup: "no [sleep]" if setup.scene.sleep is None else "",
    ),
)


def decide(setup: Setup) -> None:
    """Ask every effect that the scene calls for whether it acts, and note what it answers."""
    for entry in EFFECTS:
        place = len(setup.effects)
        answer: Acts | str = entry.absent(setup) or resolve_name(entry.decides)(setup)
        if isinstance(answer, Acts):
            setup.plugins += answer.plugins
        if entry.name:
            reason = answer if isinstance(answer, str) else answer.reason
            effect = Effect(entry.name, isinstance(answer, Acts), reason)
            setup.effects.insert(place, effect)  # before lines that it noted itself
