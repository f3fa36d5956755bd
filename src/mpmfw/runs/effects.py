"""All effects, in the order in which their hooks are called and ``mpmfw explain`` lists them."""

from __future__ import annotations

from collections.abc import Iterator
from pkgutil import resolve_name

from mpmfw.plugin.setup import Acts, Effect, Setup


def decide(setup: Setup) -> None:
    """Decide which effects act, and note why.

    Each decides in its own file, by a function that returns :class:`mpmfw.plugin.setup.Acts`, or the reason
    why nothing acts. The file is imported only if the scene calls for the effect."""
    _note_methods(setup)
    for name, decides, absent in _effects(setup):
        place = len(setup.effects)
        answer: Acts | str = absent or resolve_name(f"mpmfw.{decides}")(setup)
        acts = not isinstance(answer, str)
        if isinstance(answer, Acts):
            setup.plugins += answer.plugins
        if name:  # before lines that it noted itself
            setup.effects.insert(place, Effect(name, acts, answer.reason if acts else answer))


def _effects(setup: Setup) -> Iterator[tuple[str, str, str]]:
    """Yield name, ``module:function`` that decides, and why the scene does not call for it, empty if it does.

    The name is empty of effects that every run has, and of those that note their lines by themselves."""
    scene, output, settle = setup.scene, setup.scene.output, setup.scene.settle
    gravity = scene.gravity is not None or (settle is not None and settle.gravity is not None)
    whole = setup.whole is not None

    def unless(called_for: object, reason: str) -> str:
        return "" if called_for else reason

    no_gap = unless(output.gap, "output.gap = false") or unless(len(setup.bodies) > 1, "one body")
    surfaces = unless(setup.surface_users, "nothing needs outlines")
    held = unless(setup.held_sides, "no fixed or moving side")
    loaded = unless(setup.loaded_sides, "no side has a pressure, traction or force")
    moment = unless(output.contact_moment is not None, "no output.contact_moment")
    yield "contact", "contact.planning:from_setup", ""
    yield "least gap", "effects.surface:GapDiagnostic.from_setup", no_gap
    yield "surfaces", "effects.surface:SurfaceTracker.from_setup", surfaces
    yield "gravity", "effects.gravity:Gravity.from_setup", unless(gravity, "no [gravity]")
    yield "settling", "effects.settling:from_setup", unless(settle is not None, "no [settle]")
    yield "prescribed sides", "effects.constraint:Constraint.from_setup", held
    yield "loads on sides", "effects.side_loads:from_setup", loaded
    yield "", "plugin.named:from_setup", ""
    yield "", "effects.rotation:from_setup", ""
    yield "", "effects.series:BodySeries.from_setup", ""
    yield "", "effects.verdict:Verdict.from_setup", unless(not whole, "all are judged together")
    yield "", "effects.flutter:Flutter.from_setup", unless(setup.records_friction, "no friction")
    yield "contact moment", "effects.contact_moment:ContactMoment.from_setup", moment
    for name, decides, key in (
        ("energy ledger", "effects.ledger:EnergyLedger.from_setup", "ledger"),
        ("stability series", "effects.time_step_series:TimeStepSeries.from_setup", "stability"),
        ("von Mises stress", "effects.series:VonMises.from_setup", "particles"),
        ("surface frames", "runs.frames:surface_frames", "surface"),
    ):
        yield name, decides, unless(getattr(output, key), f"output.{key} = false")
    yield "sleep", "runs.sleeping:from_setup", unless(scene.sleep is not None, "no [sleep]")


def _note_methods(setup: Setup) -> None:
    """Note effects that are part of the transfer and of the shape function."""
    transfer, shape = setup.exchange, setup.shape
    affine, stored = transfer.affine is not None, transfer.affine == "moment"
    moves = hasattr(setup.shape_function, "update_particle_domains")
    chosen = "as auto for" if setup.scene.stepping.transfer == "auto" else "given, with"
    how = "C is carried along with the motion" if transfer.transported else "C stays as gathered"
    stores = "stores B, D⁻¹ comes at the next projection" if stored else "does not store B"
    tracks = "moves its domains in every step" if moves else "has no domains that it would move"
    setup.note("affine field", affine, f"transfer {transfer.name}, {chosen} shape {shape}")
    if affine:
        setup.note("transported affine gradient", transfer.transported, how)
    setup.note("affine moments", stored, f"transfer {transfer.name} {stores}")
    setup.note("domain tracking", moves, f"shape {shape} {tracks}")
