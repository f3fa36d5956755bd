"""Many equal discs on a square lattice: how cost and results grow with the number of bodies."""

import math

from scenes_for_tests import SOFT, with_changes

#: Radius in cells: a disc has some 220 material points and 76 surface nodes at the sizes of a real scene.
RADIUS = 3.0


def many_discs(count, contact="penalty", *, radius=RADIUS, pitch=2.0, **changes):
    """A scene of ``count`` discs in cells of a metre, ``pitch`` radii from centre to centre: 2 is touching.

    Every second row and column moves against the others at a tenth of a metre a second.
    """
    side = math.ceil(math.sqrt(count))
    bodies = {}
    for k in range(count):
        i, j = divmod(k, side)
        centre = [pitch * radius * i + 0.03, pitch * radius * j + 0.07]
        bodies[f"d{k}"] = {
            "material": "soft",
            "geometry": {"type": "disc", "centre": centre, "radius": radius},
            "particles": {"layout": "fitted", "size": 0.5},
            "velocity": [0.1 * (1 - 2 * (i % 2)), 0.1 * (1 - 2 * (j % 2))],
        }
    edge = pitch * radius * side + 2.0 * radius
    scene = {
        "grid": {"cell_size": 1.0, "lower": [-3.0 * radius - 3.0] * 2, "upper": [edge + 3.0] * 2},
        "time": {"end": 1.0, "output_interval": 0.5},
        "shape": {"method": "cpdi"},
        "contact": {"method": contact, "friction": 0.3},
        "materials": {"soft": SOFT},
        "bodies": bodies,
    }
    return with_changes(scene, **changes)
