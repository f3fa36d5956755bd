"""Time steps: one page for each scheme."""

from collections.abc import Callable

from mpmfw.step import musl, usf, usl

#: Scheme by name: update stress last, modified update stress last, update stress first.
SCHEMES: dict[str, Callable[..., float]] = {"usl": usl.step, "musl": musl.step, "usf": usf.step}
