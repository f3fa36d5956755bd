"""A disc dropped on a floor, which goes through contact: for tests of what reads results."""

import mpmfw
from scenes_for_tests import scene_of, solid

RUBBER = {"model": "neo_hookean", "density": 1000, "bulk_modulus": "60 MPa", "shear_modulus": "30 MPa"}


def drop_scene(shape="cpdi", contact="penalty"):
    """The scene: 5 outputs, contact from the second on."""
    disc = {
        "material": "rubber",
        "geometry": {"type": "disc", "centre": [1.45, 1.52], "radius": 0.5},
        "particles": {"layout": "fitted", "size": 0.125},
        "segment": 0.1,
        "velocity": [3, -10],
    }
    held = [{"side": "bottom", "fixed": True}]
    floor = solid([0.5, 0.5], [2.5, 1.0], 0.125, "rubber", segment=0.1, sides=held)
    return scene_of(
        {"upper": disc, "floor": floor},
        *(0.25, [0, 0], [3, 3]),
        end=0.008,
        outputs=4,
        title="A disc dropped on a floor",
        shape={"method": shape},
        contact={"method": contact, "friction": 0.3},
        materials={"rubber": RUBBER},
    )


def drop(shape="cpdi", contact="penalty", output=None):
    """Run it."""
    return mpmfw.run(drop_scene(shape, contact), output=output)
