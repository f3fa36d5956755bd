"""Material points, plug-ins and small scenes for checks."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.plugin.base import NamedPlugIn
from mpmfw.plugin.discovery import available, load
from mpmfw.plugin.hooks import BoundHooks, Registry
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.structs import Particles, State
from mpmfw.step.timestep import Clock
from mpmfw_testing.check import Inapplicable
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Length of a step of :func:`square` [s].
STEP = 1e-5


@dataclass
class Opened:
    """A session with constant results."""

    results: Callable[[Any], Iterable[tuple[str, AnyArray]]]
    made: Any  #: object of the plug-in

    def advance(self) -> Iterable[tuple[str, AnyArray]]:
        """Return the results."""
        return self.results(self.made)


def points_at_rest(position: FloatArray, volume: FloatArray, first: Any, stress: float = 0.0) -> Particles:
    """Return points of unit density with a ``stress`` [Pa] in all components.

    ``position`` is (n, dim) [m], ``volume`` (n,) [m^dim]; ``first`` begins the velocity fields, as in
    ``Particles``.
    """
    n, dim = position.shape
    tensor = (n, dim, dim)
    return Particles(
        position=position.copy(),
        velocity=np.zeros((n, dim)),
        mass=volume.copy(),
        initial_volume=volume.copy(),
        volume=volume.copy(),
        deformation_gradient=np.tile(np.eye(dim), (n, 1, 1)),
        velocity_gradient=np.zeros(tensor),
        stress=np.full(tensor, stress),
        affine=np.zeros(tensor),
        moment=None,
        first=np.asarray(first, dtype=np.int64),
    )


def set_up(plugin: Any, state: State, **facts: Any) -> tuple[Setup, BoundHooks]:
    """Set a plug-in up alone; ``facts`` replace or add to those of the setup. Return it and the hooks."""
    frequency = 2.0 * state.bodies[0].wave_speed / state.grid.cell_size
    setup = Setup(state=state, **{"bulk_frequency": frequency, **facts})
    registry = Registry()
    registry.register(plugin, "alone")
    hook = BoundHooks(registry, Clock())
    hook.declare_fields()
    hook.setup(setup=setup)
    return setup, hook


def square(dim: int, size: float = 0.25, *, beside: bool) -> dict[str, Any]:
    """Return the scene of a moving square or cube, "loaded", of points of a ``size`` [m] in cells of 0.5 m.

    ``beside`` it lies one at rest, "other", with a contact that does nothing.
    """
    bodies: dict[str, dict[str, Any]] = {}
    for name, left in ({"other": -2.5, "loaded": -0.5} if beside else {"loaded": -0.5}).items():
        lower = [left, -0.5, -0.5][:dim]
        upper = [x + 1.0 for x in lower]
        bodies[name] = {
            "material": "soft",
            "geometry": {"type": "rectangle" if dim == 2 else "box", "lower": lower, "upper": upper},
            "particles": {"size": size},
            "rotation": "lumped",
        }
    bodies["loaded"]["velocity"] = [1.0, -0.5, 0.25][:dim]
    return {
        "grid": {"cell_size": 0.5, "lower": [-4.0] * dim, "upper": [4.0] * dim},
        "time": {"end": 1.0, "output_interval": 1.0, "step": STEP},
        "shape": {"method": "linear"},
        "stepping": {"scheme": "usl", "transfer": "flip"},
        "materials": {
            "soft": {"model": "linear_elastic", "density": 1000.0, "bulk_modulus": 5e6, "shear_modulus": 3e6}
        },
        "bodies": bodies,
        "output": {"gap": False},
        **({"contact": {"method": _no_contact()}} if beside else {}),
    }


def _no_contact() -> str:
    """Return the name of a contact that gives every body its own velocity field and does nothing else."""
    for name in available("contact"):
        strategy = load("contact", name)
        if strategy.velocity_fields == "per_body" and not strategy.keeps_apart:
            return name
    raise Inapplicable("no installed contact lets bodies pass through each other")


def dims_of(subject: Subject) -> tuple[int, ...]:
    """Return the dimensions that a plug-in works in, with its options."""
    made = subject.make()
    dims: tuple[int, ...] = tuple(getattr(made, "dimensions", (2, 3)))
    if isinstance(made, NamedPlugIn):
        dims = tuple(dim for dim in dims if not list(type(made).problems(made.options, dim)))
    if not dims:
        raise Inapplicable(f"the {subject.kind} works in no dimension with its options")
    return dims


def in_each_dimension(check: Callable[[Subject, int], None]) -> Callable[[Subject], None]:
    """Make a check of a function of a subject and a dimension that it works in."""

    @functools.wraps(check)
    def run(subject: Subject) -> None:
        try_all({"dim": dims_of(subject)}, functools.partial(check, subject))

    return run
