"""The same in three dimensions."""

from __future__ import annotations

import functools

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.contact.conservation import require_balance, require_one_line
from mpmfw_testing.contact.drawing import impulse_history
from mpmfw_testing.contact.meeting import CELL, NAMES, body, material, scene
from mpmfw_testing.contact.motion import Motion, simulate
from mpmfw_testing.contact.separation import LEFT
from mpmfw_testing.contact.symmetry import difference
from mpmfw_testing.searching import hypothesis, ladder, search
from mpmfw_testing.subject import Subject

EDGE = 0.3  #: of the cubes [m]
EXTENT = 0.6  #: half the edge of the grid [m]
#: Difference of motions along two axes [cells, and share of the largest momentum]: triangles halve a face one
#: way or the other.
TRIANGLES = 0.01
STEPS, TURNED = 45, 25  #: of a meeting, and of one along each axis
AXES = {"x": 0, "y": 1, "z": 2}


def three_dimensions(subject: Subject) -> None:
    """In three dimensions too, impulses balance and bodies stop. Two cubes that meet along any axis: impulses
    equal and opposite (1e-12), on one line (1e-3 cells), and they stop.

    The bounds are those of ``equal-and-opposite``, ``moment-balance`` and ``pushes-apart``. With friction
    along both tangents the motion is the same along each axis, to 1 %. Asked of laws that work in three
    dimensions.
    """
    if 3 not in subject.make().dimensions:
        raise Inapplicable("the law does not work in three dimensions, and says so")

    def trial(axis: str, speed: float, slide: float, heavier: float, friction: float) -> None:
        normal, tangent = np.eye(3)[AXES[axis]], np.eye(3)[(AXES[axis] + 1) % 3]
        scene_of = _cubes(normal, speed * normal + slide * tangent, heavier, friction)
        motion = simulate(subject, scene_of, STEPS)
        picture = impulse_history(motion, -normal * np.sign(speed), "push on the first")
        if not motion.nodal or not motion.nodal[motion.largest_step].magnitude():
            raise Violation("cubes that meet do not exchange anything", None, picture)
        require_balance(motion, picture)
        require_one_line(motion, picture)
        left = (motion.velocity[-1, 0] - motion.velocity[-1, 1]) @ normal / speed
        within(float(left), LEFT, "cubes that meet are not stopped: share of their speed left", None, picture)

    for axis in AXES:
        search(
            {
                "axis": hypothesis().strategies.just(axis),
                "speed": hypothesis().strategies.sampled_from([1.0, -1.0]),
                "slide": ladder(0.3, 0.0, 2),
                "heavier": ladder(1.0, 4.0, 2),
                "friction": ladder(0.0, 0.5, 2),
            },
            trial,
            examples=2,
            most=10,
            names={
                **NAMES,
                "axis": "axis along which they meet",
                "speed": "speed of the first along it [m/s]",
            },
        )
    _same_along_each_axis(subject)


def _same_along_each_axis(subject: Subject) -> None:
    """Compare cubes that meet and slide along y and z with those along x, to 1 %."""
    reference: Motion | None = None
    for axis, k in AXES.items():
        normal = np.eye(3)[k]
        velocity = normal + 0.3 * np.roll(normal, 1) + 0.15 * np.roll(normal, 2)
        motion = simulate(subject, _cubes(normal, velocity, 4.0, 0.5), TURNED)
        reference = reference or motion
        within(
            difference(reference, motion, functools.partial(np.roll, shift=-k, axis=-1)),
            TRIANGLES,
            "cubes that meet along another axis move in another way",
            {"axis along which they meet": axis, "instead of": "x"},
            impulse_history(motion, -normal, "push on the first"),
        )


def _cubes(normal: FloatArray, velocity: FloatArray, heavier: float, friction: float) -> dict[str, object]:
    """Two cubes a tenth of a cell apart; the first comes with ``velocity`` along ``normal``."""
    side = np.sign(velocity @ normal)
    apart = 0.5 * (EDGE + 0.1 * CELL) * normal * side
    at = CELL * sum(share * np.roll(np.abs(normal), k) for k, share in enumerate((0.3, 0.2, 0.1)))
    bodies = {}
    for name, sign in (("first", -1.0), ("second", 1.0)):
        middle = at + sign * apart
        corners = {"lower": (middle - 0.5 * EDGE).tolist(), "upper": (middle + 0.5 * EDGE).tolist()}
        bodies[name] = body({"type": "box", **corners}, name, -0.5 * sign * velocity)
    grid = {"grid": {"cell_size": CELL, "lower": [-EXTENT] * 3, "upper": [EXTENT] * 3}}
    return scene(bodies, {"first": material(), "second": material(1.0, heavier)}, friction, **grid)
