"""All effects, in the order in which their hooks are called and ``mpmfw explain`` lists them."""

from __future__ import annotations

from pkgutil import resolve_name

from mpmfw.plugin.setup import Acts, Effect, Setup


def decide(setup: Setup) -> None:
    """Decide which effects act, and note why.

    Each decides in its own file, by a function that returns :class:`mpmfw.plugin.setup.Acts`, or the reason
    why nothing acts. The file is imported only if the scene calls for the effect."""
    setup.effects += _of_methods(setup)
    for name, decides, absent in _effects(setup):
        answer: Acts | str = absent or resolve_name(f"mpmfw.{decides}")(setup)
        acts = answer if isinstance(answer, Acts) else Acts(answer)
        if name:
            setup.effects.append(Effect(name, acts is answer, acts.reason))
        setup.plugins += acts.plugins
        setup.effects += acts.lines


def _effects(setup: Setup) -> list[tuple[str, str, str]]:
    """Return name, ``module:function`` that decides, and why the scene does not call for it, if it does not.

    The name is empty of effects that every run has, and of those that have their own lines."""
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
    settled = unless(settle is not None, "no [settle]")
    friction = unless(setup.records_friction, "no friction")
    sleep = unless(scene.sleep is not None, "no [sleep]")
    by_output = (
        ("energy ledger", "effects.ledger:EnergyLedger.from_setup", "ledger"),
        ("stability series", "effects.time_step_series:TimeStepSeries.from_setup", "stability"),
        ("von Mises stress", "effects.series:VonMises.from_setup", "particles"),
        ("surface frames", "runs.frames:surface_frames", "surface"),
    )
    return [
        ("contact", "contact.strategy:from_setup", ""),
        ("least gap", "effects.surface:GapDiagnostic.from_setup", no_gap),
        ("surfaces", "effects.surface:SurfaceTracker.from_setup", surfaces),
        ("gravity", "effects.gravity:Gravity.from_setup", unless(gravity, "no [gravity]")),
        ("settling", "effects.settling:from_setup", settled),
        ("prescribed sides", "effects.constraint:Constraint.from_setup", held),
        ("loads on sides", "effects.side_loads:from_setup", loaded),
        ("", "plugin.named:from_setup", ""),
        ("", "effects.rotation:from_setup", ""),
        ("", "effects.series:BodySeries.from_setup", ""),
        ("", "effects.verdict:Verdict.from_setup", unless(not whole, "all are judged together")),
        ("", "effects.flutter:Flutter.from_setup", friction),
        ("contact moment", "effects.contact_moment:ContactMoment.from_setup", moment),
        *((n, at, unless(getattr(output, key), f"output.{key} = false")) for n, at, key in by_output),
        ("sleep", "runs.sleeping:from_setup", sleep),
    ]


def _of_methods(setup: Setup) -> list[Effect]:
    """Return effects that are part of the transfer and of the shape function."""
    transfer, shape = setup.exchange, setup.shape
    affine, stored = transfer.affine is not None, transfer.affine == "moment"
    moves = hasattr(setup.shape_function, "update_particle_domains")
    chosen = "as auto for" if setup.scene.stepping.transfer == "auto" else "given, with"
    how = "C is carried along with the motion" if transfer.transported else "C stays as gathered"
    stores = "stores B, D⁻¹ comes at the next projection" if stored else "does not store B"
    tracks = "moves its domains in every step" if moves else "has no domains that it would move"
    return [
        Effect("affine field", affine, f"transfer {transfer.name}, {chosen} shape {shape}"),
        *([Effect("transported affine gradient", transfer.transported, how)] if affine else []),
        Effect("affine moments", stored, f"transfer {transfer.name} {stores}"),
        Effect("domain tracking", moves, f"shape {shape} {tracks}"),
    ]
