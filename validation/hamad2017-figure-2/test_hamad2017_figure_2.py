"""Rolling cylinder, figure 2 of [H17]."""
# cost: 40

# [H17] figure 2: first and last position of the slipping cylinder, and the gap that the classical
# contact opens, with CPDI2 on quadrilaterals, until the rigid cylinder has moved by 10 m; [H17] does not
# say when its last picture is taken. The discretisation of penalty contact against that of [H17], which
# has 517 segments on both surfaces, and edges to 0.2 m. The cylinder may have three more, so that their
# number is a multiple of four; gravity stretches edges by a thousandth in settling.

import domains
import rolling

from mpmfw.validation import Runs, methods, together

runs_runs = Runs(
    "runs",
    scene="rolling-cylinder-slip",
    methods=[
        *methods(["penalty", "bardenhagen"], ["cpdi2"]),
        *methods(["bardenhagen(criterion=position, normal=master)"], ["cpdi2"], when="full"),
        *methods(
            ["bardenhagen"],
            ["cpdi2"],
            settings={"criterion = position": {"contact.bardenhagen.criterion": "position"}},
            when="full",
        ),
    ],
    set={"time.end": 1.6631760386547367, "time.output_interval": 0.4157940096636842},
    binds=["bardenhagen, cpdi2"],
)


@runs_runs
def test_runs_runs(run):
    if run.method.matches("penalty, *"):
        run.gate(
            "gap at 1.663 s",
            run.of(rolling.errors, "gap", roll="slip"),
            "penetrates by ≤ 0.03 h",
            (-0.03, 0.0),
            "h",
        )
    if not run.method.matches("penalty, *"):
        run.gate(
            "gap at 1.663 s",
            run.of(rolling.errors, "gap", roll="slip"),
            "about a cell ([H17], fig. 2)",
            (0.5, 1.1),
            "h",
            binds=run.method.matches("bardenhagen, cpdi2"),
        )


@together(runs_runs)
def test_together_1(case, runs):
    case.gate("segments of both surfaces", runs.of(domains.counted, "segments"), "[H17]: 517", (517.0, 520.0))
    case.gate("material points of the cylinder", runs.of(domains.counted, "points cylinder"))
    case.gate(
        "longest edge of a domain of the cylinder",
        runs.of(domains.counted, "edge cylinder"),
        0.2,
        (0.0, 0.20099999999999998),
        "m",
    )
    case.gate("material points of the plane", runs.of(domains.counted, "points plane"))
    case.gate(
        "longest edge of a domain of the plane",
        runs.of(domains.counted, "edge plane"),
        0.2,
        (0.0, 0.20099999999999998),
        "m",
    )


@together(runs_runs)
def test_figure(case, runs):
    case.figure("", domains.draw(runs))
