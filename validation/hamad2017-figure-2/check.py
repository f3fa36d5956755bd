"""[H17] figure 2: first and last position of the slipping cylinder, and the gap that the classical contact opens."""

# cost: 40

from __future__ import annotations

import numpy as np
import xarray as xr
from drawing import positions
from rolling import SLIP, motion_of

from mpmfw.fields import FloatArray
from mpmfw.validation import CLASSICAL, Case, Method

SEGMENTS = 517  #: of both bodies, in [H17]
MIRROR_PLANES = 3  #: segments more that the cylinder may have, so that their number is a multiple of four
PARTICLE = 0.2  #: largest edge of a domain [m]
#: Until the rigid cylinder has moved by 10 m; [H17] does not say when its last picture is taken.
TIMES = {"time.end": SLIP.end, "time.output_interval": SLIP.end / 4.0}


def check(case: Case) -> None:
    """Run the slip case with CPDI2 on quadrilaterals, with the penalty contact and with the classical one, which is drawn
    in its plainest form and in its strongest."""
    methods = case.methods(("penalty", "bardenhagen") if case.quick else ("penalty", *CLASSICAL), ("cpdi2",))
    if not case.quick:
        position = {"contact.bardenhagen.criterion": "position"}
        methods += case.methods(("bardenhagen",), ("cpdi2",), {"criterion = position": position})
    drawn: dict[Method, xr.DataTree] = {}
    for method, tree in case.runs(methods, SLIP.scene, TIMES):
        drawn[method] = tree
        if method.recommended:
            _discretisation(case, tree)
        _gap(case, method, float(motion_of(tree).gap[-1]))
    for method in methods:
        if method not in drawn and _classical(method):
            case.failed(method, "no result, and a gate binds it", binds=True)
    case.figure("", positions({m: tree for m, tree in drawn.items() if not m.label}))


def _classical(method: Method) -> bool:
    return method.contact == "bardenhagen" and not method.label


def _discretisation(case: Case, tree: xr.DataTree) -> None:
    """Compare the discretisation with that of [H17]."""
    segments = sum(group.sizes["surface_node"] for group in tree["surface"].children.values())
    about = (SEGMENTS, SEGMENTS + MIRROR_PLANES)
    case.gate("segments of both surfaces", segments, within=about, reference=f"[H17]: {SEGMENTS}")
    for body, group in tree["particles"].children.items():
        corners = np.asarray(group["corners"].isel(time=0))
        case.show(f"material points of the {body}", len(corners))
        edge = _longest_edge(corners)
        # The edges are those after settling: gravity stretches some by a thousandth
        limit = (0.0, 1.005 * PARTICLE)
        case.gate(f"longest edge of a domain of the {body}", edge, within=limit, unit="m", reference=PARTICLE)


def _longest_edge(corners: FloatArray) -> float:
    """Longest edge of quadrilaterals (n, 4, 2) [m]."""
    return float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max())


def _gap(case: Case, method: Method, gap: float) -> None:
    what = f"gap at {SLIP.end:.4g} s"
    if method.contact == "penalty":
        case.judge(method, what, gap, within=(-0.03, 0.0), unit="h", reference="penetrates by ≤ 0.03 h")
    else:
        about, binds = "about a cell ([H17], fig. 2)", _classical(method)
        case.gate(what, gap, within=(0.5, 1.1), reference=about, unit="h", method=method, binds=binds)
