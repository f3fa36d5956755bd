"""The planted faults of every kind of plug-in, by the check that is meant for each."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from faulty_plugins.contact import keeping, momentum, several
from faulty_plugins.load import faults as load
from faulty_plugins.material import faults as material
from faulty_plugins.shape import faults as shape
from faulty_plugins.small import friction, geometry

PLANTED: dict[str, dict[str, tuple[Any, ...]]] = {
    "contact": {
        "equal-and-opposite": (momentum.UnequalImpulse,),
        "moment-balance": (momentum.MissingMoment,),
        "pushes-apart": (momentum.ReversedNormal,),
        "no-adhesion": (momentum.Adhesion,),
        "energy": (momentum.MassRatio,),
        "isolation": (momentum.DampsEverybody,),
        "reports": (momentum.Misreported, keeping.WorkOfOneInterval),
        "coulomb-cone": (momentum.NoCone,),
        "slip-on-the-cone": (momentum.NoFriction,),
        "sticking": (momentum.KineticOnly,),
        "frictionless": (momentum.AlwaysFriction,),
        "relabelling": (momentum.FirstIsMaster,),
        "shift": (momentum.FeelsOrigin,),
        "rotation": (momentum.AlongAxes,),
        "shapes": (momentum.NineEntries,),
        "three-dimensions": (momentum.Flat,),
        "similarity": (momentum.SpeedTolerance, momentum.LengthTolerance),
        "three-bodies": (momentum.UnsharedMass,),
        "friction-of-pairs": (several.FirstBodysFriction,),
        "outputs": (momentum.SeesOutputs,),
        "met-again": (several.OneTouch,),
        "many-contacts": (several.FullBuffer,),
        "moving-frame": (several.AbsoluteSpeed,),
        "changes-nothing-else": (several.WritesStress,),
        "no-growth": (several.Remembers,),
        "refinement": (keeping.PerPoint,),
        "step-length": (several.EveryOtherStep,),
        "unequal": (several.LightIsNothing,),
        "options": (keeping.IgnoredOption, keeping.IgnoredBehindRefusals),
        "time-step": (keeping.TooLongStep,),
        "repeatable": (keeping.WearsOut,),
        "saved": (keeping.CountsElsewhere,),
        "restart": (keeping.RemembersWork,),
        "sent": (keeping.Closed,),
    },
    "shape": {
        "partition-of-unity": (shape.NotNormalisedIn3D,),
        "linear-reproduction": (shape.HalfCellOff,),
        "non-negative": (shape.Interpolating,),
        "continuity": (shape.WrongPiece,),
        "regular-spread": (shape.UndeclaredSpread,),
        "gradient-sums": (shape.WrongSign,),
        "gradient-is-derivative": (shape.GradientOfLinear,),
        "support-inside": (shape.NeverOutside, shape.WrongIndex, shape.OneField),
        "surface-inside": (shape.SurfaceNeverOutside, shape.SurfaceNotNormalised),
        "reach": (shape.ReachAtTheStart,),
        "constant-stress": (shape.LeakyFaces,),
        "constant-stress-deformed": (shape.TransposedDeformation,),
        "deformed-sums": (shape.CornersLeftBehind,),
        "irregular-domains": (shape.CornersMean,),
        "divergence-theorem": (shape.LinearSurface,),
        "boundary-mass": (shape.UndeclaredBoundary,),
        "structure": (shape.Descending,),
        "repeatable": (shape.Remembering,),
        "saved": (shape.KeepsElsewhere,),
        "changes-nothing-else": (shape.Clamping,),
        "no-growth": (shape.Hoarding,),
        "options": (shape.Deaf,),
        "dimensions": (shape.Flatland,),
        "sent": (shape.Closed,),
    },
    "material": {
        "rest": (material.PreStressed, material.SmallStrain),
        "moduli": (material.TwiceTheShear,),
        "objectivity": (material.RightForLeft,),
        "full-stress": (material.Lopsided,),
        "work": (material.KirchhoffForCauchy, material.Damaged),
        "plane-strain": (material.OutputsInThePlane,),
        "sent": (material.Closed,),
        "changes-nothing-else": (material.EverybodysStress,),
        "each-for-itself": (material.MeanPressure,),
        "saved": (material.Counting,),
        "repeatable": (material.Noisy,),
        "loss": (material.LosingInSilence, material.GivingBack),
        "runs": (material.NotANumber,),
    },
    "load": {
        "runs": (load.WrongShape,),
        "changes-nothing-else": (load.Braking,),
        "own-body": (load.Everybody,),
        "repeatable": (load.Latching,),
        "impulse": (load.Pushing,),
        "power": (load.Shaking,),
        "refinement": (load.EachPoint,),
        "sent": (load.Closed,),
    },
    "friction": {
        "runs": (friction.DividesByNothing,),
        "changes-nothing-else": (friction.TurnsNormals,),
        "each-for-itself": (friction.FirstPair,),
        "repeatable": (friction.WearsOut,),
        "frame": (friction.AlongX,),
        "units": (friction.ByTheStep,),
        "options": (friction.Dropped,),
        "slip": (friction.WholeMotion,),
        "share": (friction.ByArea,),
        "sent": (friction.Closed,),
    },
    "geometry": {
        "runs": (geometry.FlatBounds,),
        "closed": (geometry.Hole, geometry.Eight),
        "oriented": (geometry.FilledHole,),
        "sides": (geometry.Coarse,),
        "in-bounds": (geometry.Narrow,),
        "volume": (geometry.Rough,),
        "centroid": (geometry.Origin,),
        "points": (geometry.SmallDomains,),
        "repeatable": (geometry.Shared,),
        "saved": (geometry.Hidden,),
        "moves": (geometry.Swelling,),
        "axes": (geometry.LeftHanded,),
    },
}

#: Checks without a fault: an error of the plug-in's own breaks them.
WITHOUT = {"contact": {"runs"}, "shape": {"runs"}}

#: Faults of contact laws that pass: the slip of a face is not measured, and sound laws report half to all of
#: friction times the bodies' slip.
MISSED = (keeping.HalfTheWork,)


def planted(*kinds: str) -> Iterator[tuple[str, Any, str]]:
    """Yield kind, fault and check of all faults of these kinds, or of all kinds."""
    for kind in kinds or PLANTED:
        for check, faults in PLANTED[kind].items():
            yield from ((kind, fault, check) for fault in faults)
