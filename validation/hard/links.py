"""A chain in the plane, of links with a knob in the socket of the one before."""

import math
from typing import Any

from common import polygon
from made import BELOW, scene

#: Radii of knob, socket and of the socket's outside, and half the width of the bar between them [m].
KNOB, SOCKET, OUTSIDE, BAR = 0.1, 0.105, 0.18, 0.035
#: Half the angle of a socket's mouth: a link turns in it by 25° to each side, and a knob is 1.3 mouths wide.
MOUTH = math.radians(45)
PITCH = 0.4

Point = tuple[float, float]


def chain(links: int, cell: float = 0.025) -> dict[str, Any]:
    """A chain falls from the level at which it is held; the first socket is cut into a block that is fixed
    below.

    In the plane closed links cannot be linked: these have a knob of 0.1 m in a socket that is 0.005 m wider,
    and are 0.4 m apart."""
    bodies: dict[str, dict[str, Any]] = {"block": polygon(_block(), sides=BELOW, E=1e7)}
    for k in range(links):
        bodies[f"link_{k}"] = polygon([(x + PITCH * k, y) for x, y in _link()], E=1e7)
    return scene(cell, 0.4, room=0.6, **bodies)


def _block() -> list[Point]:
    face = SOCKET * math.cos(MOUTH)
    corners = [(face, 0.3), (-0.3, 0.3), (-0.3, -0.3), (face, -0.3)]
    return [*corners, *_arc(0.0, SOCKET, 2.0 * math.pi - MOUTH, MOUTH)]


def _link() -> list[Point]:
    """Outline of a link with its knob about the origin, anticlockwise."""
    neck, back = math.asin(BAR / KNOB), math.pi + math.asin(BAR / OUTSIDE)
    points = _arc(0.0, KNOB, neck, 2.0 * math.pi - neck)
    points += _arc(PITCH, OUTSIDE, back, 2.0 * math.pi - MOUTH)
    points += _arc(PITCH, SOCKET, 2.0 * math.pi - MOUTH, MOUTH)
    return points + _arc(PITCH, OUTSIDE, MOUTH, 2.0 * math.pi - back)


def _arc(x: float, radius: float, first: float, last: float, sides: int = 16) -> list[Point]:
    angles = [first + (last - first) * k / sides for k in range(sides + 1)]
    return [(x + radius * math.cos(a), radius * math.sin(a)) for a in angles]
