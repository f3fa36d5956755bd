"""Contact makes neither momentum nor moment nor energy, and reports correctly what it does."""

from __future__ import annotations

import numpy as np

from mpmfw_testing.check import Inapplicable, within
from mpmfw_testing.contact.impact import CELL, TURNS, UNEQUAL, Impact, three_blocks
from mpmfw_testing.contact.motion import STEPS, Motion, impacts, moment, simulate
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Share of the impulses' sum: some hundred roundings of numbers of the same size.
ROUNDING = 1e-12
#: Lever arm of the net moment [cells].
LEVER = 1e-3
#: Steps that exchange less than this share of the largest are not asked: their quotients are roundings.
FAINT = 1e-6
#: Difference of reported and measured impulse, as a share of what was exchanged.
REPORTED = 1e-9
#: Fall of an accumulated work, as a share of the largest value or of the energy that the bodies bring.
FALLEN = 1e-12


@impacts(
    "discs", turn=TURNS, slide=(0.0, 1.0, 5), friction=(0.0, 1.0, 5), **UNEQUAL, lasting=0.6, partial=True
)
def equal_and_opposite(impact: Impact, motion: Motion) -> None:
    """What one body gets the other loses, in every step. In every step |Σ J_i| over all nodes is at most
    1e-12 of the largest Σ |J_i|; so is the points' change of momentum.

    The second is counted in the momentum m v that the bodies bring: the transfer keeps it to rounding, so
    that a difference was made by contact in a place that the grid's hooks do not show.
    """
    require_balance(motion)
    total = motion.momentum.sum(axis=1)
    brought = sum(impact.mass) * (abs(impact.speed) + abs(impact.slide))
    change = np.abs(np.diff(total, axis=0, append=total[-1:])).max(axis=1)
    text = "the momentum of all bodies together changes in a step without external force"
    within(change.max() / brought, ROUNDING, text, {"step": int(change.argmax()) + 1})


def require_balance(motion: Motion) -> None:
    """Raise a violation unless the impulses of every step add up to zero."""
    nodal, text = motion.nodal, "the impulses on the two bodies do not add up to zero"
    left = [np.abs(each.total()).max() for each in nodal]
    step = int(np.argmax(left or [0.0]))
    case = {"step": step + 1, "impulses on the bodies [N s/m]": motion.impulse[step].round(9).tolist()}
    within(left[step], ROUNDING * max(each.magnitude() for each in nodal), text, case)


@impacts(
    "discs", slide=(1.0, 0.0, 3), friction=(0.5, 0.0, 3), turn=TURNS, **UNEQUAL, lasting=0.6, partial=True
)
def moment_balance(_impact: Impact, motion: Motion) -> None:
    """The impulses on two bodies have one line of action. Over the impact, Σ |M| / Σ |J| is at most a
    thousandth of a cell, M the net moment of a step's nodal impulses.

    Contact at common nodes keeps that exactly; forces of surface points spread by N_i keep it where Σ N_i x_i
    = x_s, which fails by less than a thousandth of a cell in the few steps in which a point touches a node
    without mass. A couple left out, such as gap times friction, is ten times the bound.
    """
    require_one_line(motion)


def require_one_line(motion: Motion) -> None:
    """Raise a violation unless the steps' moments are those of forces on one line of action."""
    magnitudes = np.array([nodal.magnitude() for nodal in motion.nodal])
    acting = np.flatnonzero(magnitudes > FAINT * magnitudes.max(initial=0.0))
    if len(acting) == 0:
        return
    moments = np.zeros(len(magnitudes))
    for step in acting:
        x = motion.nodal[step].position
        moments[step] = np.abs(moment(x - x.mean(axis=0), motion.nodal[step].impulse)).max()
    worst = int(np.argmax(moments))
    text = "the impulses on the two bodies leave a moment: its lever arm, in cells, is beyond the bound"
    case = {"step": worst + 1, "moment in it [N s]": float(moments[worst])}
    within(moments.sum() / magnitudes[acting].sum() / CELL, LEVER, text, case)


@impacts(
    "discs", **UNEQUAL, turn=TURNS, slide=(0.0, 1.0, 3), friction=(0.0, 1.0, 3), partial=True, examples=10
)
def energy(_impact: Impact, motion: Motion) -> None:
    """Contact gives two bodies no energy. Kinetic and strain energy of all bodies never exceed those at the
    start by more than 0.5 %.

    Springs hold energy for a while, never less than nothing. Half a per cent is left for the time
    integration. Bodies of unequal mass and stiffness meet at an angle, with friction.
    """
    motion.require_no_gain("the bodies")


def three_bodies(subject: Subject) -> None:
    """Three bodies get no energy from contact. Three that meet at one spot gain at most 0.5 %: a node that
    two others touch has one mass to give."""

    def trial(slide: float, heavier: float) -> None:
        motion = simulate(subject, three_blocks(slide, heavier, heavier), 3 * STEPS, partial=True)
        motion.require_no_gain("three bodies that meet")
        motion.require_whole()

    try_all({"slide": (0.5, 0.0), "heavier": (1.0, 4.0)}, trial)


@impacts(
    "discs",
    friction=(0.3, 0.9, 3),
    slide=(0.5, 0.0, 3),
    heavier=(1.0, 9.0, 3),
    turn=TURNS,
    steps=40,
    examples=4,
)
def reports(_impact: Impact, motion: Motion) -> None:
    """The reported contact force is the momentum exchanged. The series ``contact_force`` times the interval
    is the impulse on the pair's first body, to 1e-9 of all exchanged.

    And ``frictional_work`` never falls: from one output to the next by at most 1e-12 of its largest value or
    of the energy that the bodies bring, which is rounding. Laws that declare neither series are not asked.
    """
    if not {"contact_force", "frictional_work"} & set(motion.series):
        raise Inapplicable("the law declares neither of the series contact_force and frictional_work")
    if "contact_force" in motion.series:
        said, did = motion.of("contact_force")[1:, 0] * np.array(motion.dt)[:, None], motion.impulse[:, 0]
        step = int(np.abs(said - did).max(axis=1).argmax())
        case = {
            "step": step + 1, "reported [N s/m]": said[step].tolist(), "measured [N s/m]": did[step].tolist()
        }  # fmt: skip
        text = "the reported contact_force is not the momentum that the first body gets"
        within(np.abs(said - did).max() / max(np.abs(did).sum(), 1e-300), REPORTED, text, case)
    if "frictional_work" in motion.series:
        work = motion.of("frictional_work")[:, 0]
        change = np.diff(work, prepend=0.0)
        case = {"step": int(change.argmin()), "largest work [J/m]": float(work.max())}
        scale = max(np.abs(work).max(), motion.of("total_energy")[0].sum())
        text = "frictional_work falls: friction gives energy [J/m]"
        within(-change.min(), FALLEN * scale, text, case)
