import numpy as np
from square import PLANE, SCENE

import mpmfw


def test_without_a_leading_body_it_is_what_nodes_are():
    bodies = {"block": {**SCENE["bodies"]["block"], "velocity": [1.0, -0.5]}, "plane": PLANE}

    def end(contact):
        scene = {**SCENE, "bodies": bodies, "contact": {"friction": 0.2, **contact}}
        return mpmfw.run(scene)["series"]["mean_velocity"].values[-1]

    ours = end({"method": "template+impulse", "template": {"exponent": 0.0}})
    np.testing.assert_allclose(ours, end({"method": "nodes+impulse"}), rtol=1e-12)
