"""What plug-ins answer, judged: declarations of fields once, values of series and fields at outputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, get_args

import numpy as np
import pluggy

from mpmfw.errors import MpmfwError, PluginError, SceneError, SimulationError
from mpmfw.plugin.blame import described
from mpmfw.state.fields import PARTICLE_FIELDS, SURFACE_FIELDS, AnyArray, Field, FloatArray, Group
from mpmfw.state.structs import State


def declared_fields(manager: pluggy.PluginManager) -> tuple[Field, ...]:
    """All declarations, in the order of registration; instances of one class may share theirs.

    Raises
    ------
    SceneError
        An answer is no list of fields, or two plug-ins own a field of one name.
    """
    owners: dict[str, tuple[Any, Field]] = {}
    for impl in manager.hook.declare_fields.get_hookimpls():
        plugin, answer = impl.plugin, impl.function()
        if not isinstance(answer, list | tuple) or not all(isinstance(each, Field) for each in answer):
            raise SceneError(
                f"{described(plugin)} answered declare_fields with {_shown(answer)}; expected a list of mpmfw.api.Field"
            )
        for field in answer:
            _check_declaration(plugin, field)
            first, known = owners.setdefault(field.name, (plugin, field))
            if first is not plugin and (type(first) is not type(plugin) or known != field):
                raise SceneError(
                    f"{described(first)} and {described(plugin)} both declare a field '{field.name}'; expected another name "
                    "for one of them"
                )
            if first is plugin and known != field:
                raise SceneError(f"{described(plugin)} declares two fields '{field.name}'")
    return tuple(field for _, field in owners.values())


def _check_declaration(plugin: Any, field: Any) -> None:
    """Refuse a declaration that cannot be allocated or stored, or that takes the place of a field of the core."""
    wrong = ""
    if not isinstance(field.name, str) or not field.name.replace("_", "").isalnum():
        wrong = "has a name of letters, digits and '_'"
    elif field.group not in get_args(Group):
        wrong = f"has one of the groups {', '.join(get_args(Group))}, not {_shown(field.group)}"
    elif not isinstance(field.dims, tuple) or not all(isinstance(dim, str) for dim in field.dims):
        wrong = f"has a tuple of names as dims, not {_shown(field.dims)}"
    elif not _is_number_type(field.dtype):
        wrong = f"has a NumPy type of numbers, not {_shown(field.dtype)}"
    elif field.name in {own.name for own in (*PARTICLE_FIELDS, *SURFACE_FIELDS) if own.group == field.group}:
        wrong = f"does not take the place of the core's own {field.group}/{field.name}"
    if wrong:
        raise SceneError(
            f"{described(plugin)} declares a field {_shown(field.name)}; expected one that {wrong}"
        )


def _is_number_type(dtype: Any) -> bool:
    try:
        return np.dtype(dtype).kind in "fiub"
    except TypeError:
        return False


def values_of(
    plugin: Any, answer: Any, declared: Mapping[str, Field], error: Callable[[str], MpmfwError]
) -> dict[str, AnyArray]:
    """The arrays that a plug-in answered ``diagnostics`` with.

    Parameters
    ----------
    plugin
        Whose answer it is.
    declared
        All declarations by name.
    error
        Makes the error of a message.

    Raises
    ------
    MpmfwError
        The answer is no table of numbers, or a name in it was not declared.
    """
    if not isinstance(answer, Mapping):
        raise error(
            f"{described(plugin)} answered diagnostics with {_shown(answer)}; expected a dict of arrays by name"
        )
    values = {}
    for name, given in answer.items():
        if name not in declared:
            raise error(
                f"{described(plugin)} answered diagnostics with '{name}', which nobody declared in declare_fields"
            )
        try:
            values[name] = np.asarray(given, dtype=declared[name].dtype)
        except (TypeError, ValueError):
            raise error(
                f"{described(plugin)} answered diagnostics with {_shown(given)} for '{name}'; expected numbers"
            ) from None
        if values[name].ndim != len(declared[name].dims):
            raise error(
                f"{described(plugin)} answered diagnostics with an array of shape {values[name].shape} for '{name}'; expected "
                f"the dims {declared[name].dims} that it declared"
            )
    return values


def of_points(method: str, material: Any, state: State, own: slice) -> FloatArray:
    """Return what a method of a material answers for the points ``own``: a number each, of stress a tensor (3, 3).

    Raises
    ------
    PluginError
        The answer has another shape.
    """
    answer = getattr(material, method)(state.particles, own)
    shape = (own.stop - own.start, *((3, 3) if method == "stress_of_points" else ()))
    if np.shape(answer) != shape:
        text = f"{described(material)} answered {method} with {_shown(answer)}; expected an array of shape {shape}"
        raise PluginError(text, step=state.steps, time=state.time)
    return np.asarray(answer)


def check_limits(plugins: Sequence[Any], answers: Sequence[Any], error: Callable[[str], MpmfwError]) -> None:
    """Refuse an answer to ``stable_timestep`` that is no positive time and its owner.

    Parameters
    ----------
    plugins
        Those that implement the hook, in the order of the calls; not all of them may have answered.
    answers
        None left out.

    Raises
    ------
    MpmfwError
        One is.
    """
    for k, answer in enumerate(answers):
        try:
            value, owner = answer
            sound = isinstance(owner, str) and float(value) > 0.0
        except (TypeError, ValueError):
            sound = False
        if not sound:
            who = described(plugins[k]) if len(plugins) == len(answers) else "a plug-in"
            raise error(
                f"{who} answered stable_timestep with {_shown(answer)}; expected a time in seconds above 0 and its owner, or "
                "None"
            )


def check_state_finite(state: State) -> None:
    """Refuse to record a state that holds NaN or infinity.

    Raises
    ------
    SimulationError
        It does: the body, the point and the array are named.
    """
    p = state.particles
    for name in ("position", "velocity", "deformation_gradient", "stress"):
        values = getattr(p, name)
        # A finite sum is one of finite numbers, and takes a fifth of the time
        if not np.isfinite(values.sum()) and not np.isfinite(values).all():
            index = int(np.flatnonzero(~np.isfinite(values.reshape(p.count, -1)).all(axis=1))[0])
            body = next(b for b in state.bodies if b.particles.start <= index < b.particles.stop)
            raise SimulationError(
                f"the {name.replace('_', ' ')} of a material point is not finite",
                body=body.name,
                index=index - body.particles.start,
                position=p.position[index].tolist(),
                time=state.time,
                advice="a smaller time.safety",
            )


def check_finite(plugin: Any, field: Field, values: AnyArray, time: float) -> None:
    """Refuse to record a value that is not finite; NaN is allowed where the declaration gives it a meaning.

    Raises
    ------
    SimulationError
        There is one.
    """
    if values.dtype.kind != "f" or np.isfinite(values).all():
        return
    if field.missing and not np.isinf(values).any():
        return
    text = f"{field.group}/{field.name} of {described(plugin)} is not finite"
    raise SimulationError(text, time=time, advice="a smaller time.safety")


def _shown(value: Any) -> str:
    """A value of a stranger's, shortened; its own ``repr`` may fail."""
    try:
        text = repr(value)
    except Exception:
        text = f"a {type(value).__name__}"
    return text if len(text) <= 80 else text[:77] + "…"
