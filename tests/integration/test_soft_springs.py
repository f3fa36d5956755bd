"""Soft springs between flush blocks: nodes beside the corner are deeper than they are away from the other
block's side.
"""

import numpy as np
import pytest

import mpmfw

KAPPA = 0.03162277660168379


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize("k", [0, 3])
def test_the_last_digits_of_the_stiffness_do_not_decide_which_nodes_bear(k):
    """Every node of the lower face carries p times its length, within 1 %: those next to the corners as
    well.
    """
    scene = mpmfw.load_scene("contact-stress", set={"contact.penalty.kappa": KAPPA * (1.0 + k * 1e-9)})
    surface = mpmfw.run(scene)["surface/upper"]
    force, place = surface["force"].values[-1], surface["position"].values[-1]
    face = (place[:, 1] < place[:, 1].min() + 0.01) & (place[:, 0] > 0.01) & (place[:, 0] < 0.99)
    np.testing.assert_allclose(force[face, 1] / force[face, 1].mean(), 1.0, atol=0.01)
