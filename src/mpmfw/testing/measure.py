"""The checks of a measure: what it reads off runs of three blocks, the middle one of which is hit from both sides."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.discovery import available, load
from mpmfw.fields import AnyArray, FloatArray
from mpmfw.measure import About, Exact, Measure, Measured
from mpmfw.runs import run
from mpmfw.scene import Scene, load_scene
from mpmfw.testing.check import Check, Inapplicable, Violation
from mpmfw.testing.contact.similarity import in_units
from mpmfw.testing.other_units import factor_of
from mpmfw.testing.sent import SENT
from mpmfw.testing.subject import Subject
from mpmfw.units import powers_of

#: By what share of its size a value may change where outputs are twice as frequent, and where units are others.
OUTPUTS, UNITS = 0.3, 1e-6
#: What lengths, times and densities are multiplied by.
FACTOR = 4.0
#: Bodies and axes of the runs; a pair is two of the bodies.
BODIES, AXES = ("left", "middle", "right"), ("x", "y")


def blocks(intervals: int = 24) -> dict[str, Any]:
    """Three blocks of different sizes that move and turn, as a scene."""
    places = {
        "left": ([-1.4, -0.5], [-0.6, 0.5]),
        "middle": ([-0.5, -0.4], [0.5, 0.4]),
        "right": ([0.7, -0.3], [1.3, 0.3]),
    }
    motions: dict[str, tuple[list[float], float]] = {
        "left": ([2.0, 0.3], 0.2), "middle": ([0.1, -0.2], -0.1), "right": ([-3.0, 0.1], 0.4)
    }  # fmt: skip
    bodies = {
        name: {
            "material": "soft",
            "geometry": {"type": "rectangle", "lower": lower, "upper": upper},
            "particles": {"size": 0.1},
            "velocity": motions[name][0],
            "angular_velocity": motions[name][1],
        }
        for name, (lower, upper) in places.items()
    }
    soft = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 5e6, "shear_modulus": 3e6}
    return {
        "grid": {"cell_size": 0.2, "lower": [-3.0, -3.0], "upper": [3.0, 3.0]},
        "time": {"end": 0.096, "output_interval": 0.096 / intervals},
        "shape": {"method": "linear"},
        "contact": {"method": _contact(), "friction": 0.2},
        "materials": {"soft": soft},
        "bodies": bodies,
    }


def _contact() -> str:
    """Name of an installed contact that keeps bodies apart and records its forces."""
    for name in available("contact"):
        if load("contact", name).keeps_apart:
            return name
    raise Inapplicable("no installed contact keeps bodies apart")


@functools.lru_cache(maxsize=8)
def results(
    intervals: int = 24, length: float = 1.0, time: float = 1.0, density: float = 1.0
) -> tuple[xr.DataTree, Scene]:
    """A run of the blocks, in other units or with other outputs, and its scene."""
    mapping = in_units(blocks(intervals), length=length, time=time, density=density)
    scene = load_scene(mapping)
    return run(scene), scene


def asked(measure: Measure) -> list[About]:
    """Everything that a measure can be asked about in the runs: every value of its keys, and none."""
    pairs = ["left-middle", "left-right", "middle-right"]
    values: dict[str, list[Any]] = {"body": list(BODIES), "pair": pairs, "axis": list(AXES)}
    found = [About()]
    for key in measure.keys:
        found += [About(**{key: value}) for value in values.get(key, [])]
    return found


def runs(subject: Subject) -> None:
    """Kind, keys, unit and meaning are said; values have the kind's shape, none is infinite, a curve's times increase."""
    measure: Measure = subject.make()
    if measure.kind not in ("number", "curve", "field") or measure.norm not in ("largest", "l2"):
        raise Violation(
            "expected kind number, curve or field, and norm largest or l2", {"kind": measure.kind}
        )
    if wrong := set(measure.keys) - {"body", "pair", "axis"}:
        raise Violation("a key is none of body, pair and axis", {"keys": sorted(wrong)})
    if not type(measure).__doc__:
        raise Violation("a measure says what it means in its docstring")
    try:
        powers_of(measure.unit)
    except ValueError as error:
        raise Violation(str(error), {"unit": measure.unit}) from error
    for about in asked(measure):
        _of(measure, about, *results())


def changes_nothing(subject: Subject) -> None:
    """Every array of the results has the bits that it had before."""
    measure, (tree, scene) = subject.make(), results()
    before = _bits(tree)
    for about in asked(measure):
        measure.of(tree, scene, about)
    if changed := [name for name, bits in _bits(tree).items() if bits != before.get(name)]:
        results.cache_clear()
        raise Violation(f"the measure changes the results: {', '.join(changed)}")


def repeatable(subject: Subject) -> None:
    """Asked again after another run, and of a fresh object, the same bits."""
    measure: Measure = subject.make()
    for about in asked(measure):
        first = _of(measure, about, *results())
        _of(measure, About(), *results(density=FACTOR))
        for other in (measure, subject.make()):
            if not np.array_equal(_of(other, about, *results()).values, first.values, equal_nan=True):
                raise Violation("the same run gives other values when it is asked again", _named(about))


def keys_act(subject: Subject) -> None:
    """A key that it declares changes something, and one that it does not declare changes nothing."""
    measure: Measure = subject.make()
    pairs = ("left-middle", "middle-right")
    for key, values in {"body": BODIES, "pair": pairs, "axis": AXES}.items():
        found = [_of(measure, About(**{key: value}), *results()).values for value in values]
        if not any(np.nan_to_num(each).any() for each in found):
            continue  # of this run it is not known, or nothing
        same = all(np.array_equal(found[0], each, equal_nan=True) for each in found[1:])
        if same and key in measure.keys:
            raise Violation(f"'{key}' is among the keys and changes nothing", {"values": ", ".join(values)})
        if not same and key not in measure.keys:
            raise Violation(
                f"'{key}' changes the values and is not among the keys", {"values": ", ".join(values)}
            )


def unit_is_that_of_the_values(subject: Subject) -> None:
    """The same motion in other units of length, time and density gives the value in these: to 1e-6 of the largest."""
    measure: Measure = subject.make()
    for name in ("length", "time", "density"):
        factor = factor_of(measure.unit, **{name: FACTOR})
        for about in asked(measure):
            one, other = (_of(measure, about, *results(**units)) for units in ({}, {name: FACTOR}))
            _alike(
                one.values * factor,
                other.values,
                UNITS,
                f"with {name}s {FACTOR:g} times as large it is not {factor:g} times as large",
                about,
            )


def outputs(subject: Subject) -> None:
    """With outputs twice as frequent a number changes by at most 30 %, and so a curve at common times, of its largest."""
    measure: Measure = subject.make()
    if measure.kind == "field":
        raise Inapplicable("a field is of one output")
    for about in asked(measure):
        one, other = (_of(measure, about, *results(n)) for n in (24, 48))
        finer = other.values
        if measure.kind == "curve":
            finer = np.interp(one.time, other.time, other.values)
        _alike(one.values, finer, OUTPUTS, "it depends on how often outputs were asked for", about)


def exact(subject: Subject) -> None:
    """What it must be in a scene is None, or of the values' shape, finite, with a kind and a word on what it is."""
    measure: Measure = subject.make()
    for about in asked(measure):
        found = measure.exact(results()[1], about)
        if found is not None:
            require_exact(found, measure.kind, np.linspace(0.0, 0.05, 5), _named(about))


def require_exact(found: Any, kind: str, times: FloatArray, case: dict[str, object]) -> FloatArray:
    """The values at ``times`` (n,) [s] if they are in order.

    Raises
    ------
    Violation
        They are not.
    """
    if not isinstance(found, Exact) or found.kind not in ("closed-form", "reference") or not found.says:
        raise Violation(
            "expected None or an Exact with the kind closed-form or reference, and what it is in words", case
        )
    values = np.asarray(found.at(times.copy()), dtype=float)
    shape = times.shape if kind == "curve" else (1,)
    if values.shape != shape or not np.isfinite(values).all():
        raise Violation(
            "expected finite values, one for each time of a curve, else one", {**case, "shape": values.shape}
        )
    if kind == "curve" and not np.allclose(
        [float(found.at(times[k : k + 1])[0]) for k in range(len(times))], values, rtol=1e-12
    ):
        raise Violation("the value at a time depends on which other times are asked for", case)
    return values


def _of(measure: Measure, about: About, tree: xr.DataTree, scene: Scene) -> Measured:
    """What it measures, if it is in order."""
    found, case = measure.of(tree, scene, about), _named(about)
    if not isinstance(found, Measured):
        raise Violation("expected a Measured of values and times", {**case, "found": type(found).__name__})
    values, time = np.asarray(found.values), np.asarray(found.time)
    case |= {"values": values.shape, "time": time.shape}
    wanted = {"number": values.shape == (1,), "curve": values.shape == time.shape, "field": values.ndim == 1}
    if not wanted[measure.kind] or values.dtype.kind != "f" or np.isinf(values).any():
        raise Violation(
            f"values are not those of a {measure.kind}: floats, none infinite, one for each time of a curve",
            case,
        )
    if measure.kind == "curve" and not (len(time) and (np.diff(time) > 0.0).all()):
        raise Violation("the times of a curve do not increase", case)
    return found


def _alike(expected: FloatArray, found: FloatArray, share: float, text: str, about: About) -> None:
    scale = float(np.nanmax(np.abs(expected), initial=0.0))
    if expected.shape != found.shape or not np.allclose(
        found, expected, rtol=0.0, atol=share * scale, equal_nan=True
    ):
        off = (
            float(np.nanmax(np.abs(found - expected))) / scale
            if expected.shape == found.shape and scale
            else np.inf
        )
        raise Violation(f"{text} (off by a share of it)", _named(about), measured=off, bound=share)


def _bits(tree: xr.DataTree) -> dict[str, bytes]:
    return {
        f"{path}/{name}": np.ascontiguousarray(_plain(array.values)).tobytes()
        for path, node in tree.subtree_with_keys
        for name, array in node.to_dataset().variables.items()
    }


def _plain(values: AnyArray) -> AnyArray:
    return values.astype(str) if values.dtype == object else values


def _named(about: About) -> dict[str, object]:
    return {key: value for key, value in vars(about).items() if value is not None}


def measure_checks() -> list[Check]:
    """All checks of a measure: those first whose failure makes others fail as well."""
    return [
        Check("runs", "It reads values of its kind off a run.", runs),
        Check("changes-nothing", "It leaves the results as they are.", changes_nothing),
        Check("repeatable", "The same run gives the same values.", repeatable),
        Check("keys", "It looks at the keys that it declares, and at no other.", keys_act),
        Check("unit", "Its unit is that of its values.", unit_is_that_of_the_values),
        Check("outputs", "It is of the motion, not of how often outputs were asked for.", outputs),
        Check("exact", "What it must be is None, or values of its kind.", exact),
        SENT,
    ]
