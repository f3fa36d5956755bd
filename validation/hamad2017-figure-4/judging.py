"""The rows of one run: every quantity of the benchmark with its limits."""

from __future__ import annotations

from dataclasses import dataclass

from rings import FIRST_CONTACT, GAP_END, GAP_START, REBOUND, SEPARATION, SLACK

from mpmfw.validation import Case, Method

#: By which the first contact may be off [ms]: 0.005 ms and the way through a cell of 2 mm at 60 m/s.
FIRST_SLACK = 0.005 + 2.0 / 60.0


@dataclass(frozen=True)
class Limit:
    """A measure of :func:`rings.measures_of` and what is asked of it."""

    name: str
    quantity: str
    least: float
    most: float
    unit: str = ""
    reference: float | str = 0.0


def _time(name: str, quantity: str, exact: float, slack: float = SLACK) -> Limit:
    return Limit(name, quantity, exact - slack, exact + slack, "ms", round(exact, 4))


LIMITS = (
    Limit("impulse_error", "total impulse, error", -1.5, 1.5, "%"),
    Limit("impulse_curve_error", "impulse curve, largest error", 0.0, 5.0, "%"),
    Limit("force_error_100us", "force over 100 us, L2 error", 0.0, 0.45),
    Limit("force_error_200us", "force over 200 us, L2 error", 0.0, 0.20),
    Limit("energy_curve_error", "kinetic energy, largest error", 0.0, 8.0, "%"),
    _time("first_contact", "first contact", FIRST_CONTACT, FIRST_SLACK),
    _time("gap_start", "start of the interval without contact", GAP_START),
    _time("gap_end", "end of the interval without contact", GAP_END),
    _time("separation", "final separation", SEPARATION),
    Limit("energy_least", "(energy + dissipation) / E0, least", 0.88, 1.005, reference=1.0),
    Limit("energy_most", "(energy + dissipation) / E0, most", 0.88, 1.005, reference=1.0),
    Limit("momentum", "drift of linear momentum", 0.0, 1e-12),
    Limit("largest_penetration", "largest penetration", 0.0, 0.15, "h"),
    Limit("mirror", "mirror error", 0.0, 0.01, "h"),
)
#: The plateau of the impulse of the fine reference, by :func:`rings.plateau` [ms].
PLATEAU = (
    _time("plateau_start", "impulse within 0.5 % of its plateau, from", 1.432),
    _time("plateau_end", "impulse within 0.5 % of its plateau, until", 1.760),
)
BRIEF = (
    "impulse_error",
    "impulse_curve_error",
    "force_error_100us",
    "energy_curve_error",
    "separation",
    "energy_least",
    "largest_penetration",
)


def judge(case: Case, method: Method, found: dict[str, float]) -> None:
    """Every limit, a gate for the recommended methods; what has none is shown."""
    for limit in LIMITS:
        _row(case, method, limit, found, binds=method.recommended)
    for limit in PLATEAU:
        _row(case, method, limit, found, binds=False)
    case.show("force over 50 us, L2 error", found["force_error_50us"], reference=0.0, method=method)
    case.show("mean penetration", found["penetration"], unit="h", method=method)
    case.show("rebound velocity", found["rebound"], reference=REBOUND, unit="m/s", method=method)
    case.show("energy lost in the transfer / E0", found["transfer"], reference=0.0, method=method)


def show_briefly(case: Case, method: Method, found: dict[str, float]) -> None:
    """The limits that tell methods apart."""
    for limit in LIMITS:
        if limit.name in BRIEF:
            _row(case, method, limit, found, binds=False)
    case.show("rebound velocity", found["rebound"], reference=REBOUND, unit="m/s", method=method)


def _row(case: Case, method: Method, limit: Limit, found: dict[str, float], binds: bool) -> None:
    case.gate(
        limit.quantity,
        found[limit.name],
        within=(limit.least, limit.most),
        reference=limit.reference,
        unit=limit.unit,
        method=method,
        binds=binds,
    )
