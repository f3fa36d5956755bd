import numpy as np
from square import PLANE, SCENE

import mpmfw


def test_a_factor_of_two_is_twice_the_friction():
    plane = {**PLANE, "sides": [{"side": "bottom", "fixed": True}]}
    block = {**SCENE["bodies"]["block"], "velocity": [1.0, -0.5]}

    def end(friction, law):
        contact = {"method": "penalty", "friction": friction, **law}
        scene = {**SCENE, "bodies": {"block": block, "plane": plane}, "contact": contact}
        return mpmfw.run(scene)["series"]["mean_velocity"].sel(body="block").values[-1]

    ours = end(0.1, {"friction_law": "template", "template": {"factor": 2.0}})
    np.testing.assert_allclose(ours, end(0.2, {}), rtol=1e-12)
