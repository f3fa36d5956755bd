"""Columns of a comparison's table: headings, units and meanings."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Column:
    """One measure."""

    heading: str  #: on a page
    short: str  #: on a terminal
    unit: str  #: ``1`` for a plain number
    meaning: str
    signed: bool = False  #: whether it is shown with its sign


_IMPULSE = "impulse on the second body, the integral of the contact force"

COLUMNS: dict[str, Column] = {
    "displacement_error": Column(
        "Displacement error", "disp.", "%",
        "displacement of the cylinder's centre of mass along the plane, at the time at which the closed form "
        "has moved by 10 m", True,
    ),
    "acceleration_error": Column(
        "Acceleration error", "accel.", "%",
        "least-squares fit of d0 + v0 t + a t²/2 to the displacement over the last 80 % of that time", True,
    ),
    "spin_error": Column(
        "Spin error", "spin", "%",
        "angular velocity Σ m r × v / Σ m r² over the material points at that time, against the rigid "
        "cylinder's; an elastic one spins a little less", True,
    ),
    "impulse_error": Column(
        "Impulse error", "impulse", "%", f"total {_IMPULSE}; only where the bodies have parted", True
    ),
    "impulse_curve_error": Column(
        "Impulse curve error", "curve", "%",
        f"largest difference over time of the {_IMPULSE}, of the total one"
    ),
    "energy_curve_error": Column(
        "Kinetic energy error", "energy", "%",
        "largest difference over time of the kinetic energy, of the one at the start",
    ),
    "energy_least": Column(
        "Energy kept, least", "E min", "1",
        "kinetic, affine, strain and contact-spring energy plus the work of friction and contact damping, "
        "least over time, of the energy at the start",
    ),
    "energy_most": Column(
        "Energy kept, most", "E max", "1", "the same, most over time: above 1 energy was gained"
    ),
    "force_error_100us": Column(
        "Force, 100 µs", "L2 100", "1", "relative L2 difference of the contact force averaged over 100 µs"
    ),
    "force_error_200us": Column("Force, 200 µs", "L2 200", "1", "the same, averaged over 200 µs"),
    "force_noise": Column(
        "Force noise", "noise", "%",
        "rms of the contact force of the pair that pushes most, less its mean over 20 output intervals, of "
        "the rms of that mean; "
        "a force that changes within that time has it without an error"
    ),
    "dissipation": Column(
        "Dissipation", "lost", "%",
        "energy put in that is neither kinetic, strain, friction nor plastic work at the end: mostly losses "
        "of the transfer; "
        "under gravity, loads and moving sides it needs output.ledger = true", True,
    ),
    "first_contact": Column(
        "First contact", "first", "ms", "start of the first output interval with a contact force"
    ),
    "separation": Column("Separation", "last", "ms", "end of the last output interval with a contact force"),
    "gap": Column(
        "End gap / h", "gap", "h",
        "least distance between the outlines of any two bodies at the last output; negative where they "
        "overlap",
        True,
    ),
    "penetration": Column(
        "Mean penetration / h", "pen.", "h",
        "depth of the outlines within each other, the deepest pair's, mean over the outputs, in cells"
    ),
    "largest_penetration": Column(
        "Largest penetration / h", "pen.max", "h", "the same, largest over the outputs"
    ),
    "cpu_time": Column(
        "CPU time", "CPU", "s", "of the steps alone: no compilation, settling, gap diagnostic or output"
    ),
    "cost": Column(
        "CPU per point and step", "ns", "ns", "CPU time over the number of material points and of steps"
    ),
    "steps": Column("Steps", "steps", "1", "time steps from time zero to the end"),
    "material_points": Column("Material points", "points", "1", "of all bodies"),
    "settle_time": Column("Settling", "settle", "s", "CPU time of settling, before time zero"),
    "cpu_time_spread": Column(
        "Spread of CPU time", "±", "s", "half the range of the repeats of a run"
    ),
}  # fmt: skip

#: Columns of words: what ``auto`` chose for the shape function, which a comparison of shape functions changes
#: with them.
CHOICES = ("scheme", "transfer")

#: Columns of the table of costs.
COSTS = ("cpu_time", "cpu_time_spread", "settle_time", "cost", "steps", "material_points")


def column_of(name: str, long_name: str = "") -> Column:
    """Return the column of a measure."""
    if name in COLUMNS:
        return COLUMNS[name]
    words = name.replace("_", " ")
    return Column(words.capitalize(), words.removesuffix(" error").replace(" ", "\n"), "%", long_name)
