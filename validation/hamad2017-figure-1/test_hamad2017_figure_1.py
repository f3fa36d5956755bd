"""Rolling cylinder, figure 1 of [H17]: displacement, velocity and spin, with slip and without."""
# cost: 195

from math import inf

import drawing
import rolling
from classical import LITERAL, MASTER, POSITION, specified

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods, together

LUMPED = "*, rotation = lumped"
SETTLED = {"settled under the tilted normal load": {"settle.gravity": {"vector": [0.0, -5.0]}}}
METHODS = [
    *methods(CONTACTS, SHAPES, when="full"),
    *methods(
        shape=RECOMMENDED, settings={"rotation = lumped": {"bodies.cylinder.rotation": "lumped"}}, when="full"
    ),
    # [H17] with increments that add up below Coulomb's cap, and to the letter.
    *methods(["hamad2017"], settings={"": {}, "literal": LITERAL}, when="full"),
    *methods(["bardenhagen"], SHAPES, {"criterion = position": POSITION}, when="full"),
    # Specified: out of the cylinder, the pair's first body, the normal that the two surfaces really have.
    *methods(
        ["bardenhagen"],
        settings={
            "normal = master": MASTER,
            "position and specified normal": {**POSITION, **specified(0.0, -1.0)},
        },
        when="full",
    ),
    *methods(["penalty", "bardenhagen"], when="quick"),
]
BINDS = ["bardenhagen, cpdi", "penalty, cpdi, rotation = lumped", "penalty, cpdi2, rotation = lumped"]

slip = Runs("slip", "rolling-cylinder-slip", METHODS, set=rolling.SERIES_ONLY, binds=BINDS)
no_slip = Runs("no slip", "rolling-cylinder-no-slip", METHODS, set=rolling.SERIES_ONLY, binds=BINDS)
#: Where the sudden tilt changes nothing normal to the plane: the cylinder settles under g cos 60° towards it.
settled = Runs(
    "settled",
    "rolling-cylinder-slip",
    [*methods(shape=RECOMMENDED, settings=SETTLED), *methods(["bardenhagen"], settings=SETTLED)],
    set=rolling.SERIES_ONLY,
    binds=["penalty, *"],
    when="full",
)


def bound(run):
    """Return whether gates bind a run: penalty contact, with the rotation corrected and without."""
    return run.method.recommended or run.method.matches(*BINDS[1:])


@slip
def test_slip(run):
    spin = 12.0 if run.method.matches(LUMPED) else 5.0
    run.gates(
        rolling.errors,
        ("slip: displacement at 10 m, error", "displacement", 0.0, 2.0, "%"),
        ("slip: fitted acceleration, error", "acceleration", 0.0, 0.2, "%"),
        ("slip: spin at 10 m, error", "spin", 0.0, spin, "%"),
        ("slip: fitted angular acceleration, error", "angular acceleration", 0.0, None, "%"),
        ("slip: mean penetration", "penetration", "", (0.0, 0.03), "h"),
        binds=bound(run),
        roll="slip",
    )
    as_published(run, "slip")


@settled
def test_settled(run):
    run.gates(
        rolling.errors,
        ("slip: displacement at 10 m, error", "displacement", 0.0, 1.0, "%"),
        ("slip: fitted angular acceleration, error", "angular acceleration", 0.0, None, "%"),
        binds=run.method.matches("penalty, *"),
        roll="slip",
    )


@no_slip
def test_no_slip(run):
    displacement = 2.5 if run.method.matches(LUMPED) else 0.5
    run.gates(
        rolling.errors,
        ("no slip: displacement at 10 m, error", "displacement", 0.0, displacement, "%"),
        ("no slip: fitted acceleration, error", "acceleration", 0.0, None, "%"),
        ("no slip: spin at 10 m, error", "spin", 0.0, None, "%"),
        ("no slip: fitted angular acceleration, error", "angular acceleration", 0.0, None, "%"),
        binds=bound(run),
        roll="no slip",
    )
    as_published(run, "no slip")


def as_published(run, roll):
    """Record the gap, and what [H17] reports of the classical contact in its plain form."""
    gap, behind = (run.of(rolling.errors, key, roll=roll) for key in ("gap", "displacement"))
    if not run.method.matches("bardenhagen, cpdi"):
        run.gate(f"{roll}: gap at the end", gap, unit="h")
        return
    said = "fig. 1, 2 of [H17]"
    run.gate(f"{roll}: gap at the end", gap, said, (0.5, 1.1), "h", binds=True)
    run.gate(f"{roll}: displacement behind, as published", behind, said, (-inf, -3.0), "%", binds=True)


@together(slip, no_slip)
def test_figure(case, runs):
    case.figure("", drawing.as_published(runs))
