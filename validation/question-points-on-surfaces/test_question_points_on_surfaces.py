"""Question: contact at surface nodes or at quadrature points; the energy that impacts gain with nodes."""
# cost: 60

import numpy as np
from impacts import energy_gained

from mpmfw.validation import Method

IMPACTS, FEW = 200, 6  #: random impacts, and in the quick version
GAIN = 0.3  #: of energy by an impact, at most [%]


def test_impacts(case):
    gained = np.array([energy_gained(seed) for seed in range(FEW if case.quick else IMPACTS)])
    met, method = gained[np.isfinite(gained)], Method("penalty", "cpdi")
    case.gate("impacts: pairs that met", len(met), method=method)
    case.gate("impacts: pairs that gain more", (met > GAIN).sum(), method=method)
    case.gate("impacts: largest gain of energy", met.max(), "", (-100.0, GAIN), "%", method)
