"""The planted faults of every kind of plug-in, by the check that is meant for each.

Most are one change of the text of a sound plug-in; the others are classes in the modules beside this one."""

from functools import partial

from faulty_plugins.change import fault
from faulty_plugins.contact import keeping
from faulty_plugins.contact.plain import PlainContact
from faulty_plugins.load import faults as load
from faulty_plugins.material import faults as material
from faulty_plugins.material.sound import Sound as SoundMaterial
from faulty_plugins.shape import faults as shape
from faulty_plugins.shape.sound import Sound as SoundShape
from faulty_plugins.small import friction, geometry

law, splines, solid = partial(fault, PlainContact), partial(fault, SoundShape), partial(fault, SoundMaterial)
force, limit = partial(fault, load.Sound), partial(fault, friction.Sound)
plane = partial(fault, geometry.Sound)

NORMAL = "outward_a - outward_b"
CONE = "np.minimum(mu * normal, sticking)"
ALL = "np.ones(len(base), dtype=bool)"
TABLE = "return self.table(particles.position, particles.first, grid)"
WEIGHTS = "0.5 * (1.5 - t) ** 2, 0.75 - (t - 1.0) ** 2, 0.5 * (t - 0.5) ** 2"
SLOPES = "t - 1.5, -2.0 * (t - 1.0), t - 0.5"

PLANTED = {
    "contact": {
        "equal-and-opposite": (law("UnequalImpulse", "apply", "-= j", "-= 0.99 * j"),),
        "moment-balance": (law("OneNodeOn", "apply", "-= j", "-= np.roll(j, 1, axis=0)"),),
        "pushes-apart": (law("ReversedNormal", "normal", NORMAL, "outward_b - outward_a"),),
        "no-adhesion": (law("Adhesion", "acts", "approach > 0.0", "approach != 0.0"),),
        "energy": (keeping.MassRatio,),
        "isolation": (
            law("DampsEverybody", "apply", "grid.momentum[a] +=",
                "grid.momentum *= 1.0 - 1e-6 * (len(a) > 0)\ngrid.momentum[a] +="),
        ),
        "reports": (
            law("Misreported", "correct", "+= j.sum(axis=0)", "-= j.sum(axis=0)"),
        ),
        "coulomb-cone": (law("NoCone", "friction", CONE, "sticking if mu > 0.0 else 0.0 * sticking"),),
        "slip-on-the-cone": (law("NoFriction", "friction", CONE, "0.0 * sticking"),),
        "sticking": (law("KineticOnly", "friction", CONE, "mu * normal"),),
        "frictionless": (
            law("AlwaysFriction", "friction", CONE, "np.minimum(max(mu, 0.2) * normal, sticking)"),
        ),
        "relabelling": (law("FirstIsMaster", "normal", NORMAL, "outward_a"),),
        "shift": (
            law("FeelsOrigin", "normal", NORMAL,
                "(n := outward_a - outward_b) + 0.1 * np.linalg.norm(n, axis=1, keepdims=True) * _position"),
        ),
        "rotation": (
            law("AlongAxes", "normal", NORMAL,
                "np.where(np.abs(n := outward_a - outward_b) == np.abs(n).max(1, keepdims=True), n, 0.0)"),
        ),
        "shapes": (keeping.NineEntries,),
        "three-dimensions": (
            law("Flat", "normal", NORMAL, f"({NORMAL}) * (np.arange(outward_a.shape[1]) < 2)"),
        ),
        "similarity": (
            law("SpeedTolerance", "acts", "approach > 0.0", "approach > 1e-3"),
            law("LengthTolerance", "effective_mass", "m_a * m_b", "min(1.0, self.h / 0.1) * m_a * m_b"),
        ),
        "three-bodies": (
            law("UnsharedMass", "correct",
                "grid.mass[a] / sharers[a], grid.mass[b] / sharers[b]", "grid.mass[a], grid.mass[b]"),
        ),
        "friction-of-pairs": (
            law("FirstBodysFriction", "exchanged", "pair.friction",
                "next(p.friction for p in self.pairs if pair.first in (p.first, p.second))"),
        ),
        "outputs": (
            law("SeesOutputs",
                "diagnostics", "self.impulse = np", "self.asked = True\nself.impulse = np",
                "effective_mass", "m_a * m_b", "(0.9 if hasattr(self, 'asked') else 1.0) * m_a * m_b"),
        ),
        "met-again": (keeping.OneTouch,),
        "many-contacts": (
            law("FullBuffer", "shared_nodes", "a[both], b[both]", "a[both][:64], b[both][:64]"),
        ),
        "moving-frame": (
            law("AbsoluteSpeed", "effective_mass", "m_a * m_b",
                "m_a * m_b / (1.0 + np.linalg.norm(self.state.particles.velocity.mean(axis=0)) / 10.0)"),
        ),
        "changes-nothing-else": (
            law("WritesStress", "after_momentum_projection", "self.correct(grid)",
                "self.correct(grid)\nparticles.stress *= 1.0 - 1e-3 * any(len(a) for _, a, _, _ in self.shared)"),  # noqa: E501
        ),
        "no-growth": (
            law("Remembers", "correct", "found = []",
                "self.log = [*getattr(self, 'log', []), grid.momentum.copy()]\nfound = []"),
        ),
        "refinement": (keeping.PerPoint,),
        "step-length": (
            law("EveryOtherStep",
                "correct", "found = []", "self.asked = getattr(self, 'asked', 0) + 1\nfound = []",
                "correct", "in self.shared", "in self.shared * (self.asked // 4 % 2 == 0)"),
        ),
        "unequal": (
            law("LightIsNothing", "shared_nodes", "(grid.mass[a] > 0.0) & (grid.mass[b] > 0.0)",
                "np.minimum(grid.mass[a], grid.mass[b]) > 0.01 * grid.mass.max()"),
        ),
        "options": (keeping.IgnoredOption, keeping.IgnoredBehindRefusals),
        "time-step": (keeping.TooLongStep,),
        "repeatable": (keeping.WearsOut,),
        "saved": (keeping.CountsElsewhere,),
        "restart": (keeping.RemembersWork,),
        "sent": (keeping.Closed,),
    },
    "shape": {
        "partition-of-unity": (
            splines("NotNormalisedIn3D", "table", "weight=phi", "weight=(1.01 if dim == 3 else 1.0) * phi"),
        ),
        "linear-reproduction": (
            splines("HalfCellOff",
                "base", "xi - 0.5", "xi - 1.0",
                "table", "self.weights(xi - base)", "self.weights(xi - base - 0.5)",
                "table", "self.slopes(xi - base)", "self.slopes(xi - base - 0.5)"),
        ),
        "non-negative": (
            splines("Interpolating", "weights", WEIGHTS,
                "0.5 * (t - 1.0) * (t - 2.0), t * (2.0 - t), 0.5 * t * (t - 1.0)"),
        ),
        "continuity": (splines("WrongPiece", "base", "np.floor(xi - 0.5)", "np.floor(xi) - 1.0"),),
        "regular-spread": (shape.UndeclaredSpread,),
        "gradient-sums": (splines("WrongSign", "slopes", "axis=-1)", "axis=-1) * -1.0"),),
        "gradient-is-derivative": (
            splines("GradientOfLinear", "slopes", SLOPES,
                "-1.0 * (t < 1.0), 2.0 * (t < 1.0) - 1.0, 1.0 * (t >= 1.0)"),
        ),
        "support-inside": (
            splines("NeverOutside", "inside", "((base >= 0.0) & (base + WIDTH <= shape)).all(axis=1)", ALL),
            splines("WrongIndex", "reported", "return index", "return 0 * index"),
            splines("OneField", "offset", "grid.offset[field]", "grid.offset[0 * field]"),
        ),
        "surface-inside": (
            splines("SurfaceNeverOutside",
                "interpolate_surface", "table = self", f"self.inside = lambda base, shape: {ALL}\ntable = self",  # noqa: E501
                "interpolate_surface", "return table", "del self.inside\nreturn table"),
            splines("SurfaceNotNormalised", "interpolate_surface", "gradient=",
                "weight=0.99 * table.weight, gradient="),
        ),
        "reach": (shape.ReachAtTheStart,),
        "constant-stress": (shape.LeakyFaces,),
        "constant-stress-deformed": (shape.TransposedDeformation,),
        "deformed-sums": (shape.CornersLeftBehind,),
        "irregular-domains": (shape.CornersMean,),
        "divergence-theorem": (shape.LinearSurface,),
        "boundary-mass": (shape.UndeclaredBoundary,),
        "structure": (shape.Descending,),
        "changes-nothing-else": (
            splines("Clamping", "interpolate", TABLE,
                f"particles.position[:] = np.round(particles.position, 6)\n{TABLE}"),
        ),
        "dimensions": (shape.Flatland,),
    },
    "material": {
        "rest": (
            solid("PreStressed", "stress", "return found", "return found + 1e-6 * K * one"),
            solid("SmallStrain", "stress", "return found",
                "e = 0.5 * (f + np.swapaxes(f, 1, 2)) - one\n"
                "return lame * np.einsum('nii->n', e)[:, None, None] * one + 2.0 * G * e"),
        ),
        "moduli": (material.TwiceTheShear,),
        "objectivity": (
            solid("RightForLeft", "left", "f @ np.swapaxes(f, 1, 2)", "np.swapaxes(f, 1, 2) @ f"),
        ),
        "full-stress": (
            solid("Lopsided", "stress", "return found", "found[:, 0, 1] *= 1.0 + 1e-6\nreturn found"),
        ),
        "work": (
            solid("KirchhoffForCauchy",
                "stress", "return found", "return found * jacobian",
                "cauchy_stress", "Sound.stress(self, f)", "self.stress(f)"),
            material.Damaged,
        ),
        "plane-strain": (
            solid("OutputsInThePlane", "cauchy_stress", "return Sound.stress(self, f)",
                "found = Sound.stress(self, f)\nfound[:, 2, 2] *= dim == 3\nreturn found"),
        ),
        "changes-nothing-else": (
            solid("EverybodysStress", "update_stress", "self.slices", "[slice(None)]"),
        ),
        "volume": (
            solid("ShrinksUnsaid", "update_stress",
                "particles.stress[own]",
                "far = np.linalg.det(particles.deformation_gradient[own]) > 2.0\n"
                "particles.deformation_gradient[own][far] *= 0.99\nparticles.stress[own]"),
        ),
        "each-for-itself": (
            solid("MeanPressure", "stress", "return found",
                "p = np.einsum('nii->n', found)[:, None, None] / f.shape[1]\n"
                "return found + (p.mean() - p) * one"),
        ),
        "saved": (
            solid("Counting",
                "update_stress", "for own", "self.steps = getattr(self, 'steps', 0) + 1\nfor own",
                "update_stress", "self.stress(", "(1.0 + 1e-9 * self.steps) * self.stress("),
        ),
        "repeatable": (
            solid("Noisy", "stress", "return found",
                "return found * (1.0 + 1e-10 * np.random.default_rng().uniform())"),
        ),
        "loss": (material.LosingInSilence, material.GivingBack),
        "runs": (
            solid("NotANumber", "stress", "return found",
                "with np.errstate(invalid='ignore'):\n    return found + 0.0 * np.sqrt(jacobian - 1.0)"),
        ),
    },
    "load": {
        "runs": (force("WrongShape", "forces", "return force", "return force[:, 0]"),),
        "changes-nothing-else": (
            force("Braking", "forces", "to_the_place =", "particles.velocity[own] *= 0.999\nto_the_place ="),
        ),
        "own-body": (load.Everybody,),
        "repeatable": (
            force("Latching", "forces", "return force",
                "self.on = getattr(self, 'on', False) or time > 1.0\nreturn force * (1.0 + self.on)"),
        ),
        "impulse": (load.Pushing,),
        "power": (load.Shaking,),
        "refinement": (load.EachPoint,),
    },
    "friction": {
        "runs": (
            limit("DividesByNothing", "speed", "return slip / dt if dt > 0.0 else 0.0 * slip",
                "with np.errstate(all='ignore'):\n    return slip / dt"),
        ),
        "changes-nothing-else": (
            limit("TurnsNormals", "slip_limit", "n = rows.count", "n = rows.count\nrows.normal[:n] *= 1.0 + 1e-9"),  # noqa: E501
        ),
        "each-for-itself": (
            limit("FirstPair", "slip_limit", ".slip_limit(rows, friction,", ".slip_limit(rows, 0.0 * friction + friction[0],"),  # noqa: E501
        ),
        "repeatable": (
            limit("WearsOut", "slip_limit", "super(base, self).slip_limit(rows, friction,",
                "self.calls = getattr(self, 'calls', 0) + 1\n"
                "super(base, self).slip_limit(rows, friction / self.calls,"),
        ),
        "frame": (
            limit("AlongX", "speed", "np.linalg.norm(rows.motion[:n] - along, axis=1)",
                "np.abs(rows.motion[:n, 0])"),
        ),
        "units": (limit("ByTheStep", "speed", "slip / dt if dt > 0.0 else 0.0 * slip", "slip / 1e-4"),),
        "slip": (limit("WholeMotion", "speed", "rows.motion[:n] - along", "rows.motion[:n]"),),
        "share": (
            limit("ByArea", "slip_limit", "1.0 + self.speed(rows, dt)",
                "(1.0 + self.speed(rows, dt)) / (1.0 + rows.area[:n])"),
        ),
    },
    "geometry": {
        "runs": (
            plane("FlatBounds", "bounds", "return np.array(self.centre) + np.array([-half, half])",
                "return np.concatenate([self.centre - half, self.centre + half])"),
        ),
        "closed": (
            plane("Eight", "outlines", "return outer,", "outer[[3, 4]] = outer[[4, 3]]\nreturn outer,"),
        ),
        "oriented": (plane("FilledHole", "outlines", "inner[::-1].copy()", "inner"),),
        "sides": (plane("Coarse", "outlines", "max(half) / segment", "max(half) / 0.4"),),
        "in-bounds": (plane("Narrow", "bounds", "np.array(self.semi_axes)", "np.array([0.9, 0.6])"),),
        "volume": (plane("Rough", "region", "FINE, larger)", "24)"),),
        "centroid": (plane("Origin", "centroid", "np.array(self.centre)", "np.zeros(2)"),),
        "points": (geometry.SmallDomains,),
        "repeatable": (geometry.Shared,),
        "saved": (geometry.Hidden,),
        "moves": (
            plane("Swelling", "halves", "(self.hole, self.hole)",
                "2 * (self.hole * (1.0 + 0.1 * abs(self.centre[0])),)"),
        ),
        "axes": (geometry.LeftHanded,),
    },
}  # fmt: skip

#: Checks without a fault: an error of the plug-in's own breaks ``runs``; the others are written once for all
#: kinds, and have their fault among contacts.
WITHOUT = {
    "contact": {"runs"},
    "shape": {"runs", "repeatable", "saved", "sent", "options", "no-growth"},
    "material": {"sent"},
    "load": {"sent"},
    "friction": {"sent", "options"},
}


def planted(*kinds):
    """Yield kind, fault and check of all faults of these kinds, or of all kinds."""
    for kind in kinds or PLANTED:
        for check, faults in PLANTED[kind].items():
            yield from ((kind, each, check) for each in faults)
