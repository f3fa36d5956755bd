"""Question: the Q term in C_n."""
# cost: 40

# C_n with and without the Q term of [H17], eq. 7: what it changes in rolling and in the rings. A shorter
# time step should change nothing: what it changes is the scatter of a run. Largest effect on a
# displacement at the end of the roll, from the list of benchmarks' notes.

import differences
import rings
import rolling

from mpmfw.validation import Runs, full, methods, together

no_slip = Runs(
    "no slip",
    scene="rolling-cylinder-no-slip",
    methods=[
        *methods(
            settings={
                "": {},
                "with Q": {"contact.penalty.normal_variation": "hamad2017"},
                "shorter step": {"time.safety": 0.35},
            }
        ),
        *methods(
            settings={
                "kappa 0.1": {"contact.penalty.kappa": 0.1},
                "kappa 0.1, with Q": {
                    "contact.penalty.kappa": 0.1,
                    "contact.penalty.normal_variation": "hamad2017",
                },
            },
            when="full",
        ),
    ],
    set={"output.particles": False, "output.surface": False, "output.ledger": False},
    quick={"grid.cell_size": 0.8},
)


@no_slip
def test_no_slip(run):
    for quantity, key, reference, unit in (
        ("no slip: displacement, error", "displacement", 0.0, "%"),
        ("no slip: spin, error", "spin", 0.0, "%"),
        ("no slip: mean penetration", "penetration", "", "h"),
    ):
        run.gate(quantity, run.of(rolling.errors, key, roll="no slip"), reference, None, unit)


slip = Runs(
    "slip",
    scene="rolling-cylinder-slip",
    methods=methods(
        settings={
            "": {},
            "with Q": {"contact.penalty.normal_variation": "hamad2017"},
            "shorter step": {"time.safety": 0.35},
        }
    ),
    set={"output.particles": False, "output.surface": False, "output.ledger": False},
    when="full",
)


@slip
def test_slip(run):
    for quantity, key, reference, unit in (
        ("slip: displacement, error", "displacement", 0.0, "%"),
        ("slip: spin, error", "spin", 0.0, "%"),
        ("slip: mean penetration", "penetration", "", "h"),
    ):
        run.gate(quantity, run.of(rolling.errors, key, roll="slip"), reference, None, unit)


rings_runs = Runs(
    "rings",
    scene="colliding-rings",
    methods=methods(
        settings={
            "": {},
            "with Q": {"contact.penalty.normal_variation": "hamad2017"},
            "shorter step": {"time.safety": 0.35},
        }
    ),
    set={
        "output.particles": False,
        "output.ledger": False,
        "bodies.left.particles.size": "0.5 cells",
        "bodies.right.particles.size": "0.5 cells",
    },
    when="full",
)


@rings_runs
def test_rings_runs(run):
    run.gate(
        "rings: impulse curve, largest error", run.of(rings.measures_of, "impulse_curve_error"), unit="%"
    )
    run.gate("rings: largest penetration", run.of(rings.measures_of, "largest_penetration"), unit="h")


@together(no_slip)
def test_together_1(case, runs):
    case.gate(
        "no slip: change of the displacement at 10 m",
        runs.of(differences.at_end, label="with Q", beside=""),
        method="penalty, cpdi, with Q",
        tolerance=0.06,
        unit="%",
    )
    case.gate(
        "no slip: change of the displacement at 10 m",
        runs.of(differences.at_end, label="shorter step", beside=""),
        method="penalty, cpdi, shorter step",
        binds=False,
        tolerance=0.06,
        unit="%",
    )


@full
@together(no_slip)
def test_together_2(case, runs):
    case.gate(
        "no slip: change of the displacement at 10 m",
        runs.of(differences.at_end, label="kappa 0.1, with Q", beside="kappa 0.1"),
        method="penalty, cpdi, kappa 0.1, with Q",
        binds=False,
        tolerance=0.06,
        unit="%",
    )


@full
@together(slip)
def test_together_3(case, runs):
    case.gate(
        "slip: change of the displacement at 10 m",
        runs.of(differences.at_end, label="with Q", beside=""),
        method="penalty, cpdi, with Q",
        tolerance=0.06,
        unit="%",
    )
    case.gate(
        "slip: change of the displacement at 10 m",
        runs.of(differences.at_end, label="shorter step", beside=""),
        method="penalty, cpdi, shorter step",
        binds=False,
        tolerance=0.06,
        unit="%",
    )


@full
@together(rings_runs)
def test_together_4(case, runs):
    case.gate(
        "rings: largest change of the impulse curve",
        runs.of(differences.largest, label="with Q"),
        method="penalty, cpdi, with Q",
        unit="%",
    )
    case.gate(
        "rings: largest change of the impulse curve",
        runs.of(differences.largest, label="shorter step"),
        method="penalty, cpdi, shorter step",
        unit="%",
    )
