"""Small scenes as nested mappings: each test states what it changes."""

import copy

BULK, SHEAR, DENSITY = 6e6, 3e6, 1000.0
SOFT = {"model": "neo_hookean", "density": DENSITY, "bulk_modulus": BULK, "shear_modulus": SHEAR}


def with_changes(scene, **changes):
    """A copy of ``scene`` in which ``a__b=value`` sets the key ``a.b``."""
    scene = copy.deepcopy(scene)
    for key, value in changes.items():
        *path, last = key.split("__")
        table = scene
        for part in path:
            table = table.setdefault(part, {})
        table[last] = copy.deepcopy(value)
    return scene


def body_of(geometry, size, material="soft", layout="lattice", **keys):
    """A body of points of this size."""
    return {"material": material, "geometry": geometry, "particles": {"layout": layout, "size": size}, **keys}


def solid(lower, upper, size, material="soft", layout="lattice", **keys):
    """A rectangle or a box."""
    geometry = {"type": "rectangle" if len(lower) == 2 else "box", "lower": lower, "upper": upper}
    return body_of(geometry, size, material, layout, **keys)


def scene_of(bodies, cell, lower, upper, end, outputs=1, **tables):
    """Bodies in a grid between two corners, with outputs until the end; ``tables`` replace whole ones."""
    return {
        "grid": {"cell_size": cell, "lower": lower, "upper": upper},
        "time": {"end": end, "output_interval": end / outputs},
        "shape": {"method": "cpdi"},
        "materials": {"soft": SOFT},
        "bodies": bodies,
        **tables,
    }


def one_body(geometry, *, size, layout="lattice", **changes):
    """A free Neo-Hookean body called ``solid``, in cells of 0.25 m round the origin."""
    dim = 2 if geometry["type"] in ("disc", "ring", "rectangle", "polygon", "mesh") else 3
    body = body_of(geometry, size, layout=layout)
    return with_changes(scene_of({"solid": body}, 0.25, [-2.0] * dim, [2.0] * dim, end=0.05), **changes)


def disc(layout="lattice", **changes):
    """A disc of R = 1 m, four cells, its centre off the grid lines."""
    geometry = {"type": "disc", "centre": [0.03, 0.07], "radius": 1.0}
    return one_body(geometry, size=0.125, layout=layout, **changes)


def block(**changes):
    """A square of 1 m, four cells, on grid lines."""
    geometry = {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]}
    return one_body(geometry, size=0.125, **changes)


def box(**changes):
    """A cube of 1 m, four cells, off the grid lines."""
    geometry = {"type": "box", "lower": [-0.47, -0.43, -0.41], "upper": [0.53, 0.57, 0.59]}
    return one_body(geometry, size=0.125, **changes)


def ball(**changes):
    """A ball of R = 0.75 m, three cells, its centre off the grid lines."""
    geometry = {"type": "ball", "centre": [0.03, 0.07, 0.05], "radius": 0.75}
    return one_body(geometry, size=0.125, **changes)


def two_blocks(method, **changes):
    """Two squares of 0.5 m, a hundredth of a metre apart, that meet at 2 m/s within the first steps."""
    scene = block(contact={"method": method, "friction": 0.2})
    scene["bodies"] = {
        name: solid([left, -0.25], [left + 0.5, 0.25], 0.125, velocity=[speed, 0.3 * speed])
        for name, left, speed in (("left", -0.505, 1.0), ("right", 0.005, -1.0))
    }
    return with_changes(scene, **changes)


def ball_on_a_box():
    """A ball pressed 5 mm into a box, and sliding."""
    scene = box(time__end=4e-4, time__output_interval=2e-4)
    scene["bodies"]["solid"]["geometry"] = {"type": "box", "lower": [-0.5] * 3, "upper": [0.5, 0.5, 0.0]}
    scene["bodies"]["ball"] = {
        **scene["bodies"]["solid"],
        "geometry": {"type": "ball", "centre": [0.03, 0.02, 0.495], "radius": 0.5},
        "velocity": [3.0, 0.0, -2.0],
    }
    scene |= {"contact": {"method": "penalty", "friction": 0.3}, "allow_overlap": True}
    return scene
