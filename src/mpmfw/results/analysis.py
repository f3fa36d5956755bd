"""Measures of a motion: accelerations, closed forms, impulses, averages of forces, and round-off.

A quantity that cannot be measured, because a run failed or a series is too short, is NaN.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.state.fields import AnyArray, FloatArray


@dataclass(frozen=True)
class RollingSolution:
    """Rigid cylinder (eq. 13 of [H17]) or sphere on an incline, from rest."""

    acceleration: float  #: of the centre along the plane [m/s²]
    angular_acceleration: float  #: counter-clockwise positive: negative when rolling towards +x [rad/s²]
    slips: bool  #: tan θ > 3 μ, of a sphere 3.5 μ

    def displacement(self, time: FloatArray | float) -> FloatArray:
        """d = a t²/2 [m]."""
        return np.asarray(0.5 * self.acceleration * np.square(time))

    def velocity(self, time: FloatArray | float) -> FloatArray:
        """v = a t [m/s]."""
        return np.asarray(self.acceleration * np.asarray(time))

    def spin(self, time: FloatArray | float) -> FloatArray:
        """ω = -α t [rad/s]."""
        return np.asarray(self.angular_acceleration * np.asarray(time))

    def time_to(self, distance: float) -> float:
        """Time [s] at which the centre has moved by ``distance`` [m]."""
        return float(np.sqrt(2.0 * distance / self.acceleration))


def rolling_solution(
    tilt: float, friction: float, g: float, radius: float, inertia: float = 0.5
) -> RollingSolution:
    """Return the motion of a rigid cylinder or sphere on an inclined plane, released from rest.

    The plane has the ``tilt`` θ [rad], the body the ``radius`` R [m] and the ``inertia`` β = I/(m R²): 1/2
    for a cylinder, 2/5 for a sphere. μ is Coulomb's coefficient. With slip (tan θ > (1 + 1/β) μ): a = g (sin
    θ - μ cos θ), α = μ g cos θ / (β R). Without: a = g sin θ / (1 + β), α = a / R.
    """
    slips = bool(np.tan(tilt) > (1.0 + 1.0 / inertia) * friction)
    if slips:
        acceleration = g * (np.sin(tilt) - friction * np.cos(tilt))
        angular = friction * g * np.cos(tilt) / (inertia * radius)
    else:
        acceleration = g * np.sin(tilt) / (1.0 + inertia)
        angular = acceleration / radius
    return RollingSolution(float(acceleration), -float(angular), slips)


def value_at(time: FloatArray, values: FloatArray, at: float) -> float:
    """Interpolate a series to the time ``at``, by the parabola through the three nearest outputs."""
    known = np.isfinite(values)
    time, values = time[known], values[known]
    slack = 1e-9 * abs(at)
    if len(time) < 3 or at > time[-1] + slack or at < time[0] - slack:
        return float("nan")
    nearest = np.argsort(np.abs(time - at), kind="stable")[:3]
    scale = float(np.ptp(time[nearest]))
    return float(np.polyval(np.polyfit((time[nearest] - at) / scale, values[nearest], 2), 0.0))


def fitted_acceleration(time: FloatArray, displacement: FloatArray, start: float, end: float) -> float:
    """Return a [m/s²] of the least-squares fit d0 + v0 t + a t²/2 between ``start`` and ``end`` [s].

    NaN if the series (time,) ends before ``end``, or has fewer than four outputs in the interval.
    """
    slack = 1e-9 * abs(end)
    known = np.isfinite(displacement)
    inside = known & (time >= start - slack) & (time <= end + slack)
    if inside.sum() < 4 or time[known][-1] < end - float(np.max(np.diff(time[inside]))) - slack:
        return float("nan")
    scaled = (time[inside] - start) / (end - start)
    return float(2.0 * np.polyfit(scaled, displacement[inside], 2)[0] / (end - start) ** 2)


def impulse(time: FloatArray, force: FloatArray) -> FloatArray:
    """Return the impulse (time, …) [N s/m] since the first output of a force (time, …) [N/m].

    ``force[k]`` is the mean between ``time[k - 1]`` and ``time[k]`` [s].
    """
    steps = np.diff(time, prepend=time[0]).reshape(-1, *(1,) * (force.ndim - 1))
    return np.asarray(np.cumsum(np.where(steps > 0.0, force * steps, 0.0), axis=0))


def averaged(time: FloatArray, impulses: FloatArray, window: float) -> FloatArray:
    """Return the centred mean of a force over ``window`` [s] from its impulse."""
    before, after = time - 0.5 * window, np.minimum(time + 0.5 * window, time[-1])
    passed = np.interp(after, time, impulses) - np.interp(before, time, impulses)
    return np.asarray(passed / (after - before))


def running_average(time: FloatArray, force: FloatArray, window: float) -> FloatArray:
    """Return the centred mean over ``window`` [s] of a force."""
    return averaged(time, impulse(time, force), window)


#: Output intervals of the mean that noise is measured against.
NOISE_WINDOW = 20


def force_noise(time: FloatArray, force: FloatArray) -> float:
    """Return the rms deviation of a force (time,) or (time, axis) [N/m] from its mean over
    :data:`NOISE_WINDOW` intervals, over the mean's rms; NaN if the series is shorter than two windows."""
    known = np.isfinite(np.atleast_2d(force.T).T).all(axis=1)
    if known.sum() < 2 * NOISE_WINDOW:
        return float("nan")
    time, force = time[known], force[known].reshape(int(known.sum()), -1)
    span = NOISE_WINDOW * float(np.median(np.diff(time)))
    mean = np.stack([running_average(time, one, span) for one in force.T], axis=1)
    size = float(np.mean(mean**2))
    return float(np.sqrt(np.mean((force - mean) ** 2) / size)) if size > 0.0 else float("nan")


def relative_l2(time: FloatArray, values: FloatArray, reference: FloatArray) -> float:
    """Return ‖values - reference‖ / ‖reference‖ in L2 over the time."""
    return float(np.sqrt(np.trapezoid((values - reference) ** 2, time) / np.trapezoid(reference**2, time)))


@dataclass(frozen=True)
class ContactPhases:
    """Start, end and longest break of a pair's contact [s]; NaN if there was none."""

    first: float  #: first contact
    gap_start: float  #: start of the longest interval without force in between
    gap_end: float  #: end of it
    separation: float  #: last contact


def contact_phases(time: FloatArray, force: FloatArray, threshold: float = 1e-6) -> ContactPhases:
    """Find the phases of a force (time,), which is zero below ``threshold`` times its largest value."""
    size, nan = np.abs(np.nan_to_num(force)), float("nan")
    acting = np.flatnonzero(size > threshold * size.max())
    if len(acting) == 0:
        return ContactPhases(nan, nan, nan, nan)
    first = float(time[max(acting[0] - 1, 0)])
    # A force that still acts at the last output has not ended.
    ended = acting[-1] < len(time) - 1 and bool(np.isfinite(force[acting[-1] + 1]))
    separation = float(time[acting[-1]]) if ended else nan
    breaks = np.diff(acting)
    if breaks.max(initial=1) == 1:
        return ContactPhases(first, nan, nan, separation)
    start, end = acting[np.argmax(breaks)], acting[np.argmax(breaks) + 1] - 1
    return ContactPhases(first, float(time[start]), float(time[end]), separation)


def energy_sums(series: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return kinetic, strain and dissipated energy of all bodies over time."""
    sums = {name: series[name].sum("body", skipna=False) for name in ("kinetic_energy", "strain_energy")}
    works = [name for name in ("frictional_work", "damping_work", "spring_work") if name in series]
    if works:
        lost: Any = sum(series[name].fillna(0.0).sum("pair") for name in works)
        sums["dissipated_energy"] = lost.where(sums["kinetic_energy"].notnull())
    return sums


#: Series that make up the energy, by body and by pair.
_ENERGIES = ("kinetic_energy", "strain_energy", "affine_energy")
_WORKS = ("contact_energy", "frictional_work", "damping_work")


def energy_kept(run: xr.Dataset) -> FloatArray:
    """Return energy plus work of friction and damping over the initial energy (time,); absent series are
    zero."""
    total = np.zeros(run.sizes["time"])
    for names, dim in ((_ENERGIES, "body"), (_WORKS, "pair")):
        for name in names:
            if name in run and bool(run[name].notnull().any()):
                total = total + run[name].sum(dim, skipna=dim == "pair").values
    start = total[0] if len(total) else np.nan
    return np.asarray(total / start) if start > 0.0 else np.full(len(total), np.nan)


#: Share of a scene's scale below which a change is the rounding of a run of many steps.
ROUND_OFF = 1e-10

#: Gap in cells below which bodies touch: rounding of positions that are stored in single precision.
GAP_ROUND_OFF = 1e-5


def without_round_off(series: xr.Dataset) -> xr.Dataset:
    """Return the series over time with values below round-off set to zero.

    Each series is compared with the largest magnitude among the series of its unit. For velocities this is at
    least L/T, with the largest coordinate L and the time T; for spins at least one turn in T. For positions
    it is the largest displacement.
    """
    if "time" not in series.dims or series.sizes["time"] < 2:
        return series
    known = {
        str(name): one
        for name, one in series.data_vars.items()
        if "time" in one.dims and one.dtype.kind == "f"
    }
    scales: dict[str, float] = {}
    for array in known.values():
        unit = str(array.attrs.get("units", "1"))
        scales[unit] = max(scales.get(unit, 0.0), _largest(array.values))
    time = float(series["time"].values[-1] - series["time"].values[0])
    length = _largest(known["centre_of_mass"].values) if "centre_of_mass" in known else 0.0
    for name, scale in (("mean_velocity", length / time), ("angular_velocity", 2.0 * np.pi / time)):
        if name in known:
            unit = str(known[name].attrs.get("units", "1"))
            scales[unit] = max(scales[unit], scale)
    clean = {}
    for name, array in known.items():
        floor = ROUND_OFF * scales[str(array.attrs.get("units", "1"))]
        start = array.isel(time=0) if name == "centre_of_mass" else 0.0
        change = array - start
        shown = start + change.where(~(np.abs(change) <= floor), 0.0)
        clean[name] = shown.transpose(*array.dims).assign_attrs(array.attrs)
    return series.assign(clean)


def _largest(values: AnyArray) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
