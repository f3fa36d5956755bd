"""Rolling cylinder, figure 1 of [H17]: displacement, velocity and spin, with slip and without."""
# cost: 195

from math import inf

import rolling
from common import LITERAL, MASTER, POSITION, specified
from matplotlib.lines import Line2D
from rolling import EXACT, NO_SLIP, SLIP, motion_of

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods, together

#: Looks by contact, all with CPDI and no other change.
COLOURS = dict(zip(CONTACTS, ("#009E73", "#D55E00", "#117733", "#0072B2"), strict=True))
LOOKS = {
    contact: {"color": colour, "linestyle": ":" if contact == "none" else "-", "linewidth": 1.2}
    for contact, colour in COLOURS.items()
}
DASHED = {**EXACT, "linestyle": (0, (4, 3))}


def draw(runs):
    """[H17] fig. 1: displacement and velocity, slip above and no slip below."""
    figure = new_figure(2, 2)
    panels = figure.subplots(2, 2, sharex="row")
    shown = [run for run in runs if run.method.shape == "cpdi" and not run.method.label]
    for (left, right), roll in zip(panels, (SLIP, NO_SLIP), strict=True):
        motions = {run.method.contact: motion_of(run.results) for run in shown if run.runs == roll.name}
        for contact in LOOKS:
            if contact in motions:
                motion = motions[contact]
                left.plot(motion.time, motion.displacement, **LOOKS[contact])
                right.plot(motion.time, motion.velocity, **LOOKS[contact])
        time = max((motion.time for motion in motions.values()), key=lambda time: time[-1])
        left.plot(time, roll.solution.displacement(time), **DASHED)
        right.plot(time, roll.solution.velocity(time), **DASHED)
        dress(left, "time [s]", "displacement [m]", f"{roll.name}: displacement")
        dress(right, "time [s]", "velocity [m/s]", f"{roll.name}: velocity")
        for axes in (left, right):
            axes.set_xlim(0.0, time[-1])
            axes.set_ylim(bottom=-0.09 * axes.get_ylim()[1])  # what sticks swings back and forth
    drawn = {run.method.contact for run in shown}
    keys = [Line2D([], [], **LOOKS[contact], label=contact) for contact in LOOKS if contact in drawn]
    legend_below(figure, [[Line2D([], [], **DASHED, label="closed form"), *keys]])
    return figure


LUMPED = "*, rotation = lumped"
SETTLED = {"settled under the tilted normal load": {"settle.gravity": {"vector": [0.0, -5.0]}}}
REAL = {**POSITION, **specified(0.0, -1.0)}
METHODS = [
    *methods(CONTACTS, SHAPES, when="full"),
    *methods(shape=RECOMMENDED, settings={"rotation = lumped": rolling.LUMPED}, when="full"),
    # [H17] with increments that add up below Coulomb's cap, and to the letter.
    *methods(["hamad2017"], settings={"": {}, "literal": LITERAL}, when="full"),
    *methods(["bardenhagen"], SHAPES, {"criterion = position": POSITION}, when="full"),
    # Specified: out of the cylinder, the pair's first body, the normal that the two surfaces really have.
    *methods(["bardenhagen"], settings={"normal = master": MASTER}, when="full"),
    *methods(["bardenhagen"], settings={"position and specified normal": REAL}, when="full"),
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
        ("slip: mean penetration", "penetration", "", (0.0, 0.03), "h"),
        binds=bound(run),
        roll="slip",
    )
    as_published(run, "slip")


@settled
def test_settled(run):
    value, binds = run.of(rolling.errors, "displacement", roll="slip"), run.method.matches("penalty, *")
    run.gate("slip: displacement at 10 m, error", value, 0.0, 1.0, "%", binds=binds)


@no_slip
def test_no_slip(run):
    displacement = 2.5 if run.method.matches(LUMPED) else 0.5
    value = run.of(rolling.errors, "displacement", roll="no slip")
    run.gate("no slip: displacement at 10 m, error", value, 0.0, displacement, "%", binds=bound(run))
    as_published(run, "no slip")


def as_published(run, roll):
    """Record what [H17] reports of the classical contact in its plain form."""
    if run.method.matches("bardenhagen, cpdi"):
        gap, behind = (run.of(rolling.errors, key, roll=roll) for key in ("gap", "displacement"))
        said = "fig. 1, 2 of [H17]"
        run.gate(f"{roll}: gap at the end", gap, said, (0.5, 1.1), "h", binds=True)
        run.gate(f"{roll}: displacement behind, as published", behind, said, (-inf, -3.0), "%", binds=True)


@together(slip, no_slip)
def test_figure(case, runs):
    case.figure("", draw(runs))
