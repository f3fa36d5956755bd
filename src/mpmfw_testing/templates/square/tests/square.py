"""A square that falls: the scene of the tests."""

SCENE = {
    "grid": {"cell_size": 0.25, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
    "time": {"end": 0.01, "output_interval": 0.005, "step": 1e-4},
    "shape": {"method": "cpdi"},
    "materials": {
        "soft": {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 5e6, "shear_modulus": 3e6}
    },
    "bodies": {
        "block": {
            "material": "soft",
            "geometry": {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
            "particles": {"size": 0.125},
        }
    },
    "gravity": {"vector": [0.0, -10.0]},
}
PLANE = {
    **SCENE["bodies"]["block"],
    "geometry": {"type": "rectangle", "lower": [-1.0, -1.0], "upper": [1.0, -0.5]},
}
