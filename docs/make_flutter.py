"""Print the table of docs/guide/stability.md on flutter over friction and time: ``python docs/make_flutter.py
[MU …]``.

The block of ``validation/steep-friction`` lies on a plane that is tilted in 0.15 s to just above the angle of
friction, or to just below it. Beside mpmfw run the finite elements of ``validation/finite-elements``. A few
minutes of CPU time."""

from __future__ import annotations

import math
import sys
import warnings
from pathlib import Path

import numpy as np

import mpmfw
from mpmfw.errors import ResultsWarning

VALIDATION = Path(__file__).parents[1] / "validation"
for folder in ("finite-elements", "steep-friction"):
    sys.path.insert(0, str(VALIDATION / folder))

from measures import GRAVITY, gravity_table  # noqa: E402
from slider_fem.bodies import incline  # noqa: E402
from slider_fem.flutter import growth, slide_steadily  # noqa: E402
from slider_fem.motion import RAMP, slide  # noqa: E402

FRICTIONS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
ABOVE, BELOW = 1.06, 0.999  # tan θ over μ
TIMES = (0.6, 1.5)  # [s]
#: Of critical at c_s / 4 H, the lowest frequency of the block in shear.
DAMPING = {"critical": 0.16, "frequency": 64.5}
METHODS = {
    "penalty": {},
    "penalty, 5 % PIC": {"stepping.transfer": "flip", "stepping.pic_fraction": 0.05},
    "penalty, damped": {f"materials.{name}.damping": DAMPING for name in ("block", "plane")},
}


def rigid_way(friction: float, tilt: float) -> np.ndarray:
    """Way of the rigid block until each of :data:`TIMES` [m]."""
    time = np.linspace(0.0, TIMES[-1], 15001)
    angle = tilt * 0.5 * (1.0 - np.cos(np.pi * np.minimum(time / RAMP, 1.0)))
    pull = GRAVITY * np.maximum(np.sin(angle) - friction * np.cos(angle), 0.0)
    speed = np.cumsum(pull) * time[1]
    return np.asarray(np.interp(TIMES, time, np.cumsum(speed) * time[1]))


def way_of_points(friction: float, tilt: float, **changes: object) -> np.ndarray:
    """Way of the block of material points until each of :data:`TIMES` [m]."""
    scene = mpmfw.load_scene(
        VALIDATION / "steep-friction" / "scene.toml",
        set={
            "contact.friction": friction,
            "contact.penalty.kappa": 4.0,
            "gravity.table": gravity_table(tilt),
            "time.end": TIMES[-1],
            "time.output_interval": 0.02,
            "output": {"particles": False, "gap": False},
            **changes,
        },
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)
        series = mpmfw.run(scene)["series"].to_dataset()
    x = series["centre_of_mass"].sel(body="block", axis="x").values
    return np.asarray(np.interp(TIMES, series["time"].values, x - x[0]))


def way_of_elements(friction: float, tilt: float) -> np.ndarray:
    """Way of the finite elements until each of :data:`TIMES` [m]."""
    found = slide(0.1, friction, tilt, end=TIMES[-1])
    return np.asarray(np.interp(TIMES, found.time, found.x - found.x[0]))


def least_damping(friction: float) -> float:
    """Return the share of critical at the frequency of :data:`DAMPING` with which no mode of the finite
    elements grows: the time τ = 2σ/ω² of a mode that grows by exp σt, largest of all, times π f."""
    bodies = incline(0.1)
    pressed = slide_steadily(bodies, friction, rigid_contact=False).pressed
    modes = growth(bodies, friction, rigid_contact=False, pressed=pressed)
    time = max((2.0 * rate / (2.0 * np.pi * frequency) ** 2 for rate, frequency in modes), default=0.0)
    return float(np.pi * DAMPING["frequency"] * time)


def main() -> None:
    """Print a row for every friction and method, and the damping that flutter needs."""
    spans = " | ".join(f"{time:g} s" for time in TIMES)
    print(f"| μ | method | above, way: {spans} | below, way [mm]: {spans} |")
    print("| --- | --- |" + " ---: |" * 2 * len(TIMES))
    for friction in map(float, sys.argv[1:] or FRICTIONS):
        ways = {"finite elements": way_of_elements}
        ways |= {name: lambda *at, more=more: way_of_points(*at, **more) for name, more in METHODS.items()}
        above, below = (math.atan(ratio * friction) for ratio in (ABOVE, BELOW))
        exact = rigid_way(friction, above)
        print(f"| {friction:g} | no growth with | {100.0 * least_damping(friction):.2g} % of critical |")
        for name, way in ways.items():
            errors = 100.0 * (way(friction, above) / exact - 1.0)
            walked = 1000.0 * way(friction, below)  # [mm]
            cells = [f"{error:+.1f} %" for error in errors] + [f"{float(f'{way:.2g}'):g}" for way in walked]
            print(f"| {friction:g} | {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
