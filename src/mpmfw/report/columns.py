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


COLUMNS: dict[str, Column] = {
    "displacement_error": Column(
        "Displacement error", "disp.", "%", "along the plane, when the closed form has moved by 10 m", True
    ),
    "acceleration_error": Column(
        "Acceleration error", "accel.", "%", "fit of a parabola over the last 80 % of that time", True
    ),
    "spin_error": Column(
        "Spin error", "spin", "%", "Σ m r × v / Σ m r² at that time, against the rigid cylinder's", True
    ),
    "impulse_error": Column(
        "Impulse error", "impulse", "%", "total impulse on the second body, once the bodies have parted", True
    ),
    "impulse_curve_error": Column(
        "Impulse curve error", "curve", "%", "largest difference of the impulse over time, of the total"
    ),
    "energy_curve_error": Column(
        "Kinetic energy error", "energy", "%", "largest difference over time, of the energy at the start"
    ),
    "energy_least": Column(
        "Energy kept, least", "E min", "1", "with the work of friction and damping, of that at the start"
    ),
    "energy_most": Column("Energy kept, most", "E max", "1", "the same: above 1 energy was gained"),
    "force_error_100us": Column(
        "Force, 100 µs", "L2 100", "1", "relative L2 difference of the contact force averaged over 100 µs"
    ),
    "force_error_200us": Column("Force, 200 µs", "L2 200", "1", "the same, averaged over 200 µs"),
    "force_noise": Column(
        "Force noise", "noise", "%", "rms of the largest force about its mean over 20 outputs, of that mean"
    ),
    "dissipation": Column(
        "Dissipation", "lost", "%", "energy put in that no account has, mostly lost by the transfer", True
    ),
    "first_contact": Column("First contact", "first", "ms", "start of the first output with a contact force"),
    "separation": Column("Separation", "last", "ms", "end of the last output with a contact force"),
    "gap": Column(
        "End gap / h", "gap", "h", "between any two outlines at the end; negative where they overlap", True
    ),
    "penetration": Column("Mean penetration / h", "pen.", "h", "of the deepest pair, mean over the outputs"),
    "largest_penetration": Column("Largest penetration / h", "pen.max", "h", "the same, largest"),
    "cpu_time": Column("CPU time", "CPU", "s", "of the steps, without compilation, settling and output"),
    "cost": Column("CPU per point and step", "ns", "ns", "CPU time over material points and steps"),
    "steps": Column("Steps", "steps", "1", "time steps from time zero to the end"),
    "material_points": Column("Material points", "points", "1", "of all bodies"),
    "settle_time": Column("Settling", "settle", "s", "CPU time before time zero"),
    "cpu_time_spread": Column("Spread of CPU time", "±", "s", "half the range of the repeats"),
}

#: Columns of words, which ``auto`` leaves to the shape function.
CHOICES = ("scheme", "transfer")

#: Columns of the table of costs.
COSTS = ("cpu_time", "cpu_time_spread", "settle_time", "cost", "steps", "material_points")


def column_of(name: str, long_name: str = "") -> Column:
    """Return the column of a measure."""
    if name in COLUMNS:
        return COLUMNS[name]
    words = name.replace("_", " ")
    return Column(words.capitalize(), words.removesuffix(" error").replace(" ", "\n"), "%", long_name)
