"""Measures by name: quantities that a campaign computes from stored runs, and their exact values.

A measure is a class derived from :class:`mpmfw.api.results.Measure` with an entry point, or a function
``(run, scene, about)`` under ``@measure(…)`` that returns a number or :class:`mpmfw.api.results.Measured`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal, TypeAlias

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import REFERENCES, available, did_you_mean, full_name, load
from mpmfw.plugin.measure import About, Exact, Measure, Measured, Reference
from mpmfw.results.analysis import fitted_acceleration, force_noise, impulse, value_at
from mpmfw.results.conservation import dissipation, energy_error, momentum_change
from mpmfw.results.references import KNOWN, Incline, PressedBlocks, declared
from mpmfw.scene import Scene

Kind: TypeAlias = Literal["number", "curve", "field"]
Extract: TypeAlias = Callable[[xr.DataTree, Scene, About], Measured | float]


#: All measures by name.
MEASURES: dict[str, Measure] = {}


def measure(
    name: str,
    unit: str,
    kind: Kind,
    keys: tuple[str, ...] = (),
    *,
    norm: Literal["largest", "l2"] = "largest",
    particles: bool = False,
    outputs: tuple[str, ...] = (),
) -> Callable[[Extract], Extract]:
    """Register the function below under a name, with the attributes of a :class:`mpmfw.api.results.Measure`;
    the first line of its docstring is the meaning."""

    def register(function: Extract) -> Extract:
        def of(self: Measure, run: xr.DataTree, scene: Scene, about: About) -> Measured:
            found = function(run, scene, inferred(self, run, scene, about))
            return found if isinstance(found, Measured) else Measured(np.array([found]), np.empty(0))

        made = {
            "name": name, "unit": unit, "kind": kind, "keys": keys, "norm": norm, "particles": particles,
            "outputs": outputs, "of": of, "__doc__": function.__doc__,
            # pickle looks for the function under the class's name
            "__reduce__": lambda self: (measure_of, (self.name,)),
        }  # fmt: skip
        MEASURES[name] = type(function.__name__, (Measure,), made)()
        return function

    return register


def measure_of(name: str) -> Measure:
    """Return the measure of a name."""
    if name not in MEASURES:
        if name not in available("measure"):
            raise SceneError(f"'{name}' is unknown; {did_you_mean(name, names_of_measures())}")
        MEASURES[name] = _made("measure", name, Measure)
    return MEASURES[name]


def _made(kind: Literal["measure", "reference"], name: str, base: type[Any]) -> Any:
    plugin = load(kind, name)
    if not issubclass(plugin, base):
        raise SceneError(f"{full_name(plugin)} is no {kind}; expected a subclass of {base.__name__}")
    return plugin()


def outputs_for(measure: Measure) -> dict[str, bool]:
    """Return overrides that record only what a measure reads."""
    read = {f"output.{name}": name in measure.outputs for name in ("gap", "ledger")}
    return {"output.particles": measure.particles, "output.surface": False, **read}


def names_of_measures() -> list[str]:
    """Return the names of all measures."""
    return sorted({*MEASURES, *available("measure")})


def exact_of(measure: Measure, scene: Scene, about: About) -> Exact | None:
    """Return the exact value of a quantity by the scene's ``[reference] kind``, or None."""
    about = known_axis(measure, scene, about)
    return _exact_along(measure, scene, replace(about, axis=about.axis or "x"))


def known_axis(measure: Measure, scene: Scene, about: About) -> About:
    """Return ``about`` with the axis of a known value, if none is named."""
    if "axis" not in measure.keys or about.axis is not None:
        return about
    every = (replace(about, axis=axis) for axis in "xyz"[: scene.dim])
    return next((one for one in every if _exact_along(measure, scene, one) is not None), about)


def _exact_along(measure: Measure, scene: Scene, about: About) -> Exact | None:
    if scene.reference is not None and scene.reference.kind not in REFERENCES:
        made: Reference = _made("reference", scene.reference.kind, Reference)
        return made.exact(scene, measure.name, about)
    known = declared(scene) if measure.name in KNOWN else None  # of the others it may not apply
    return measure.exact(scene, about) if known is None else known.exact(measure.name, about)


def _incline(scene: Scene) -> Incline | None:
    try:
        known = declared(scene)
    except SceneError:
        return None
    return known if isinstance(known, Incline) else None


# -- which body, pair and axis


def inferred(measure: Measure, run: xr.DataTree, scene: Scene, about: About) -> About:
    """Return the subject of a measure: as named, else that of the largest motion or impulse."""
    series, keys, known = run["series"].to_dataset(), measure.keys, _incline(scene)
    if known is not None:
        sure = {"body": known.body, "axis": "x"}
        about = replace(
            about, **{key: sure[key] for key in sure if key in keys and getattr(about, key) is None}
        )
    if "pair" in keys and scene.pairs:
        names = [f"{a}-{b}" for a, b, _ in scene.pairs]
        still = xr.DataArray(np.zeros((len(names), 1)), {"pair": names, "axis": ["x"]}, ("pair", "axis"))
        force, dim = series.get("contact_force"), "pair"
        size = still if force is None else abs(force.sum("time"))
    elif "body" in keys or "axis" in keys:
        centre = series["centre_of_mass"]
        if measure.particles:
            centre = centre.sel(
                body=[one for one in centre["body"].values if scene.bodies[str(one)].particles]
            )
        size, dim = abs(centre - centre.isel(time=0)).max("time"), "body"
    else:
        return about
    if dim in keys and getattr(about, dim) is None and (len(keys) > 1 or measure.kind == "number"):
        about = replace(about, **{dim: _largest(size.max("axis"), dim)})
    if "axis" in keys and about.axis is None:
        named = getattr(about, dim)
        about = replace(
            about, axis=_largest(size.max(dim) if named is None else size.sel({dim: named}), "axis")
        )
    return about


def _largest(sizes: xr.DataArray, dim: str) -> str:
    return str(sizes[dim].values[int(np.argmax(sizes.fillna(0.0).values))])


def _displacement(run: xr.DataTree, about: About) -> Measured:
    series = run["series"].to_dataset()
    x = series["centre_of_mass"].sel(body=about.body, axis=about.axis).values
    return Measured(x - x[0], series["time"].values)


def _of_pair(name: str, run: xr.DataTree, about: About) -> xr.DataArray | None:
    series = run["series"].to_dataset()
    return series[name].sel(pair=about.pair) if name in series else None


def _until(scene: Scene) -> float:
    known = _incline(scene)
    return known.until if known else float(scene.time.end)


# -- numbers


@measure("end-displacement", "m", "number", ("body", "axis"))
def end_displacement(run: xr.DataTree, scene: Scene, about: About) -> float:
    """Displacement of a body's centre at the end, or when a rolling one's closed form has moved 10 m."""
    moved = _displacement(run, about)
    return value_at(moved.time, moved.values, _until(scene))


@measure("acceleration", "m s-2", "number", ("body", "axis"))
def acceleration(run: xr.DataTree, scene: Scene, about: About) -> float:
    """Acceleration of a body's centre, from a least-squares parabola over the last 80 % of the time."""
    moved, end = _displacement(run, about), _until(scene)
    return fitted_acceleration(moved.time, moved.values, 0.2 * end, end)


@measure("spin", "rad s-1", "number", ("body",))
def spin(run: xr.DataTree, scene: Scene, about: About) -> float:
    """Angular velocity of a body at the end, or when the closed form of a rolling one has moved by 10 m."""
    series = run["series"].to_dataset()
    omega = series["angular_velocity"].sel(body=about.body).isel(rotation=-1).values
    return value_at(series["time"].values, omega, _until(scene))


@measure("force-noise", "1", "number", ("pair",))
def noise_of_force(run: xr.DataTree, scene: Scene, about: About) -> float:  # noqa: ARG001
    """Rms noise of a pair's contact force about its mean over 20 outputs, over that mean."""
    force = _of_pair("contact_force", run, about)
    if force is None:
        return np.nan
    return force_noise(force["time"].values, force.transpose("time", "axis").values)


@measure("penetration", "1", "number", ("pair",), outputs=("gap",))
def deepest_penetration(run: xr.DataTree, scene: Scene, about: About) -> float:
    """Deepest penetration of a pair at any output, in cells."""
    gap = _of_pair("min_gap", run, about)
    if gap is None or not np.isfinite(gap).any():
        return np.nan
    return max(0.0, -float(gap.min())) / float(scene.grid.cell_size)


@measure("energy-error", "1", "number", outputs=("ledger",))
def error_of_energy(run: xr.DataTree, scene: Scene, about: About) -> float:  # noqa: ARG001
    """Largest error of strain and contact energy over the energy put in (``output.ledger``)."""
    return energy_error(run, scene)


@measure("dissipation", "1", "number", outputs=("ledger",))
def dissipated_energy(run: xr.DataTree, scene: Scene, about: About) -> float:  # noqa: ARG001
    """Share of the energy put in that is neither kinetic, strain, friction nor plastic work at the end."""
    return dissipation(run, scene)


@measure("momentum-change", "1", "number")
def change_of_momentum(run: xr.DataTree, scene: Scene, about: About) -> float:  # noqa: ARG001
    """Largest change of the total linear momentum over the bodies' own; of scenes without loads."""
    return momentum_change(run, scene)


def _end_of(run: xr.DataTree, scene: Scene, about: About, side: float) -> float:
    """Return the coordinate of a body's farthest point, ahead (``side`` 1) or behind (−1), and half its size.

    In a body that has flowed F does not describe the shape of its domains."""
    points = scene.bodies[str(about.body)].particles
    if points is None:
        text = f"'{about.body}' is rigid, and has no material points; expected a body that deforms"
        raise SceneError(text, key="error.body")
    place = run[f"particles/{about.body}"]["position"].isel(time=-1).sel(axis=about.axis)
    return side * (float((side * place).max()) + 0.5 * float(points.size))


@measure("front", "m", "number", ("body", "axis"), particles=True)
def front(run: xr.DataTree, scene: Scene, about: About) -> float:
    """Largest coordinate of a body along an axis at the end, such as a run-out or an outer radius."""
    return _end_of(run, scene, about, 1.0)


@measure("rear", "m", "number", ("body", "axis"), particles=True)
def rear(run: xr.DataTree, scene: Scene, about: About) -> float:
    """Least coordinate of a body along an axis at the end, such as an inner radius."""
    return _end_of(run, scene, about, -1.0)


# -- curves


@measure("displacement", "m", "curve", ("body", "axis"))
def displacement(run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG001
    """Displacement of a body's centre over time."""
    return _displacement(run, about)


@measure("impulse", "N s m-1", "curve", ("pair", "axis"))
def impulse_curve(run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG001
    """Impulse of the contact force on the second body of a pair over time."""
    time = run["series"].to_dataset()["time"].values
    force = _of_pair("contact_force", run, about)
    if force is None:
        return Measured(np.full(time.size, np.nan), time)
    return Measured(impulse(time, -force.sel(axis=about.axis).values), time)


@measure("kinetic-energy", "J m-1", "curve", ("body",))
def kinetic_energy(run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG001
    """Kinetic energy of all bodies, or of the named one, over time."""
    series = run["series"].to_dataset()
    energy = series["kinetic_energy"]
    chosen = energy.sel(body=about.body) if about.body else energy.sum("body", skipna=False)
    return Measured(chosen.values, series["time"].values)


# -- fields


@measure("interface-stress", "Pa", "field", norm="l2", particles=True)
def interface_stress(run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG001
    """Vertical stress after settling of the material points within a cell of two blocks' interface."""
    known = declared(scene)
    names = (known.lower, known.upper) if isinstance(known, PressedBlocks) else tuple(scene.bodies)[:2]
    found = [run[f"particles/{name}"].to_dataset().isel(time=0) for name in names]
    heights = [one["position"].sel(axis="y").values for one in found]
    middle = 0.5 * (heights[0].max() + heights[1].min())
    stress = [one["stress"].sel(axis="y", axis2="y").values for one in found]
    near = [np.abs(y - middle) <= float(scene.grid.cell_size) for y in heights]
    return Measured(np.concatenate([s[n] for s, n in zip(stress, near, strict=True)]), np.empty(0))
