"""A disc dropped on a floor, which goes through contact: for tests of what reads results."""

import mpmfw

RUBBER = {"model": "neo_hookean", "density": 1000, "bulk_modulus": "60 MPa", "shear_modulus": "30 MPa"}


def drop_scene(shape="cpdi", contact="penalty"):
    """The scene: 5 outputs, contact from the second on."""
    return {
        "title": "A disc dropped on a floor",
        "grid": {"cell_size": 0.25, "lower": [0, 0], "upper": [3, 3]},
        "time": {"end": 0.008, "output_interval": 0.002},
        "shape": {"method": shape},
        "contact": {"method": contact, "friction": 0.3},
        "materials": {"rubber": RUBBER},
        "bodies": {
            "upper": {
                "material": "rubber",
                "geometry": {"type": "disc", "centre": [1.45, 1.52], "radius": 0.5},
                "particles": {"layout": "fitted", "size": 0.125},
                "segment": 0.1,
                "velocity": [3, -10],
            },
            "floor": {
                "material": "rubber",
                "geometry": {"type": "rectangle", "lower": [0.5, 0.5], "upper": [2.5, 1.0]},
                "particles": {"size": 0.125},
                "segment": 0.1,
                "sides": [{"side": "bottom", "fixed": True}],
            },
        },
    }


def drop(shape="cpdi", contact="penalty", output=None):
    """Run it."""
    return mpmfw.run(drop_scene(shape, contact), output=output)
