"""Rolling cylinder, figure 2 of [H17]: the gap that the classical contact opens, with CPDI2.

The rigid cylinder moves by 10 m; [H17] does not say when its last picture is taken. The discretisation is
that of [H17], which has 517 segments on both surfaces, and edges to 0.2 m. The cylinder may have three
more, so that their number is a multiple of four; gravity stretches edges by a thousandth in settling.
"""
# cost: 40

import drawing
import rolling
from classical import POSITION

from mpmfw.validation import CLASSICAL, Runs, methods, together

END = rolling.SLIP.end
slip = Runs(
    "slip",
    "rolling-cylinder-slip",
    [
        *methods(["penalty", "bardenhagen"], ["cpdi2"]),
        *methods(CLASSICAL[1:], ["cpdi2"], when="full"),
        *methods(["bardenhagen"], ["cpdi2"], {"criterion = position": POSITION}, when="full"),
    ],
    set={"time.end": END, "time.output_interval": END / 4},
    binds=["bardenhagen, cpdi2"],
)


@slip
def test_slip(run):
    gap = run.of(rolling.errors, "gap", roll="slip")
    if run.method.matches("penalty, *"):
        run.gate("gap at 1.663 s", gap, "penetrates by ≤ 0.03 h", (-0.03, 0.0), "h")
    else:
        binds = run.method.matches("bardenhagen, cpdi2")
        run.gate("gap at 1.663 s", gap, "about a cell ([H17], fig. 2)", (0.5, 1.1), "h", binds=binds)


@together(slip)
def test_discretisation(case, runs):
    case.gate("segments of both surfaces", runs.of(drawing.counted, "segments"), "[H17]: 517", (517, 520))
    for body in ("cylinder", "plane"):
        points, edge = (runs.of(drawing.counted, f"{key} {body}") for key in ("points", "edge"))
        case.gate(f"material points of the {body}", points)
        case.gate(f"longest edge of a domain of the {body}", edge, 0.2, (0.0, 0.2 * 1.005), "m")


@together(slip)
def test_figure(case, runs):
    case.figure("", drawing.draw(runs))
