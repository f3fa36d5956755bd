"""Ten scenes of bodies that meet, without a closed form, and three questions about each."""

from collections.abc import Iterator
from typing import Any, NamedTuple

#: Cell size of the scenes [m]; discs have a radius of 1 m. Waves run at about 10 m/s.
CELL = 0.25
SPEED = 0.2  # m/s, of what approaches


class Question(NamedTuple):
    """An error that is asked for: relative ``target`` of a measure of a body, a pair or all bodies."""

    scene: str
    measure: str
    about: dict[str, str]
    target: float

    def __str__(self) -> str:
        named = " ".join(self.about.values())
        return f"{self.scene}: {self.measure} {named}".rstrip() + f" within {self.target:.0%}"


def disc(x: float, y: float, radius: float = 1.0, **keys: Any) -> dict[str, Any]:
    """Return a disc."""
    return body({"type": "disc", "centre": [x, y], "radius": radius}, **keys)


def block(lower: list[float], upper: list[float], angle: float = 0.0, **keys: Any) -> dict[str, Any]:
    """Return a rectangle."""
    return body({"type": "rectangle", "lower": lower, "upper": upper, "angle": angle}, **keys)


def body(geometry: dict[str, Any], material: str = "soft", **keys: Any) -> dict[str, Any]:
    """Return a body with four points a cell."""
    return {
        "material": material,
        "geometry": geometry,
        "particles": {"layout": "fitted", "size": "0.5 cells"},
        "velocity": [0.0, 0.0],
        **keys,
    }


def scene(friction: float, end: float, bodies: dict[str, Any], **tables: Any) -> dict[str, Any]:
    """Return a scene of two materials, one four times as stiff as the other."""
    stiffness = {"soft": 1.0e5, "stiff": 4.0e5}
    return {
        "grid": {"cell_size": CELL, "lower": [-6.0, -4.0], "upper": [6.0, 5.0]},
        "time": {"end": end, "output_interval": end / 60},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": friction},
        "materials": {
            name: {"model": "neo_hookean", "density": 1000.0, "youngs_modulus": e, "poissons_ratio": 0.3}
            for name, e in stiffness.items()
        },
        "bodies": bodies,
        "output": {"particles": False, "surface": False},
        **tables,
    }


FLOOR = block([-4.03, -1.52], [4.03, 0.01], sides=[{"side": "bottom", "fixed": True}])

#: Every scene with the body and the pair that its questions are about.
SCENES: dict[str, tuple[dict[str, Any], str, str]] = {
    "equal discs": (
        scene(0.0, 2.0, {
            "left": disc(-1.07, 0.03, velocity=[SPEED, 0.0]),
            "right": disc(1.02, 0.03, velocity=[-SPEED, 0.0]),
        }), "left", "left-right",
    ),
    "discs that pass obliquely": (
        scene(0.3, 2.0, {
            "left": disc(-0.93, -0.52, velocity=[SPEED, 0.0]),
            "right": disc(0.91, 0.49, velocity=[-SPEED, 0.0]),
        }), "right", "left-right",
    ),
    "a small stiff disc": (
        scene(0.0, 2.0, {
            "large": disc(-1.3, 0.0, 1.25, velocity=[SPEED, 0.0]),
            "small": disc(0.77, 0.11, 0.75, material="stiff"),
        }), "small", "large-small",
    ),
    "a disc thrown on a floor": (
        scene(0.4, 2.0, {"disc": disc(-0.6, 1.06, velocity=[SPEED, -SPEED]), "floor": FLOOR}),
        "disc", "disc-floor",
    ),
    "a ring on a floor": (
        scene(0.2, 3.0, {
            "ring": body(
                {"type": "ring", "centre": [0.0, 1.06], "inner_radius": 0.5, "outer_radius": 1.0},
                velocity=[0.0, -SPEED],
            ),
            "floor": FLOOR,
        }), "ring", "ring-floor",
    ),
    "a box flat on a floor": (
        scene(0.0, 1.5, {"box": block([-1.0, 0.06], [1.0, 1.56], velocity=[0.0, -SPEED]), "floor": FLOOR}),
        "box", "box-floor",
    ),
    "a box on its corner": (
        scene(0.3, 2.0, {
            "box": block([-0.9, 0.43], [0.9, 2.03], 0.35, velocity=[0.0, -SPEED]), "floor": FLOOR,
        }), "box", "box-floor",
    ),
    "a row of discs": (
        scene(0.0, 3.0, {
            "first": disc(-2.13, 0.0, velocity=[2 * SPEED, 0.0]),
            "second": disc(-0.05, 0.0),
            "third": disc(1.98, 0.0),
        }), "third", "second-third",
    ),
    "a disc in a groove": (
        scene(0.2, 2.0, {
            "disc": disc(0.05, 1.46, velocity=[0.0, -SPEED]),
            "left": block([-2.9, -1.0], [-0.4, 1.0], -0.785, sides=[{"side": "bottom", "fixed": True}]),
            "right": block([0.4, -1.0], [2.9, 1.0], 0.785, sides=[{"side": "bottom", "fixed": True}]),
        }), "disc", "disc-right",
    ),
    "a stack under its weight": (
        scene(0.3, 2.0, {
            "upper": block([-0.8, 1.51], [0.8, 2.51]),
            "lower": block([-1.2, 0.01], [1.2, 1.51], material="stiff"),
            "floor": FLOOR,
        }, gravity={"vector": [0.0, -2.0]}), "upper", "upper-lower",
    ),
}  # fmt: skip


def questions() -> Iterator[Question]:
    """Yield three questions about each scene."""
    for name, (_, body, pair) in SCENES.items():
        yield Question(name, "end-displacement", {"body": body}, 0.05)
        yield Question(name, "end-displacement", {"body": body}, 0.02)
        yield Question(name, "impulse", {"pair": pair}, 0.05)
