"""What is read off a slide of the block, the same for the material points and the finite elements."""

import math
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import least_squares
from slider_fem.motion import JUDGED, RAMP, Slide, acceleration_of

GRAVITY = 10.0  #: [m/s²]
MASS = 1000.0 * 0.6 * 0.3  #: of the block [kg/m]
#: Time in which the growth of the lowest mode is read: after the tilt, and before the block begins to hop
#: [s].
GROWING = (0.155, 0.2)


class Measured(NamedTuple):
    """One slide, or one block that must stick."""

    friction: float  #: μ
    tilt: float  #: θ [rad]
    acceleration: float  #: fitted [m/s²]
    speed: float  #: mean over the same time [m/s]
    ratio: float  #: mean T over μ times mean N

    @property
    def exact(self) -> float:
        """Acceleration of the rigid block [m/s²]; 0 if it sticks."""
        return max(GRAVITY * (math.sin(self.tilt) - self.friction * math.cos(self.tilt)), 0.0)

    @property
    def slides(self) -> bool:
        """Return True if the rigid block slides."""
        return self.exact > 0.0

    @property
    def error(self) -> float:
        """Of the acceleration of a block that slides [%]."""
        return 100.0 * (self.acceleration / self.exact - 1.0) if self.slides else math.nan


def gravity_table(tilt: float, rows: int = 61) -> list[list[float]]:
    """Rows (t, g_x, g_y) of a gravity that is tilted from 0 to ``tilt`` [rad] in 0.15 s, as a cosine."""
    time = np.linspace(0.0, RAMP, rows)
    turned = tilt * 0.5 * (1.0 - np.cos(np.pi * time / RAMP))
    return np.column_stack([time, GRAVITY * np.sin(turned), -GRAVITY * np.cos(turned)]).tolist()


def of_points(friction: float, tilt: float, series: xr.Dataset) -> Measured:
    """Measure a run of mpmfw."""
    time = series["time"].values
    x = series["centre_of_mass"].sel(body="block", axis="x").values
    force = series["contact_force"].sel(pair="block-plane").values
    return _measured(friction, tilt, time, x, -force[:, 0], force[:, 1])


def of_elements(friction: float, tilt: float, slide: Slide) -> Measured:
    """Measure a run of the finite elements."""
    return _measured(friction, tilt, slide.time, slide.x, slide.tangential, slide.normal)


def _measured(
    friction: float, tilt: float, time: np.ndarray, x: np.ndarray, tangential: np.ndarray, normal: np.ndarray
) -> Measured:
    inside = (time >= JUDGED[0] - 1e-9) & (time <= JUDGED[1] + 1e-9)
    speed = np.ptp(x[inside]) / np.ptp(time[inside])
    return Measured(
        friction,
        tilt,
        acceleration_of(time, x),
        float(speed),
        float(tangential[inside].mean() / (friction * normal[inside].mean())),
    )


def growth_of(time: np.ndarray, y: np.ndarray, near: float) -> tuple[float, float]:
    """Growth rate σ [1/s] and frequency f [Hz] of the block's bounce in :data:`GROWING`.

    Least squares of y = a + b t + c t² + exp(σ t) (d cos 2πf t + e sin 2πf t); ``near`` is where f is looked
    for [Hz]."""
    inside = (time >= GROWING[0]) & (time <= GROWING[1])
    t, y = time[inside] - GROWING[0], y[inside]

    def departure(guess: np.ndarray) -> np.ndarray:
        sigma, f = guess
        swell, phase = np.exp(sigma * t), 2.0 * np.pi * f * t
        terms = np.column_stack([np.ones_like(t), t, t**2, swell * np.cos(phase), swell * np.sin(phase)])
        terms /= np.abs(terms).max(0)
        return np.asarray(terms @ np.linalg.lstsq(terms, y, rcond=None)[0] - y) / y.std()

    fits = [least_squares(departure, (20.0, near + off), x_scale=(10.0, 5.0)) for off in (-8.0, 0.0, 8.0)]
    sigma, f = min(fits, key=lambda fit: fit.cost).x
    return float(sigma), float(f)


def onset(slides: list[Measured], limit: float = 1.0) -> float:
    """Return the least μ beyond which all errors exceed ``limit`` [%]; infinite if the last does not."""
    found = math.inf
    for one in sorted(slides, key=lambda one: one.friction, reverse=True):
        if abs(one.error) <= limit:
            break
        found = one.friction
    return found
