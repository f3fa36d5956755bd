"""The rule that no option is without effect, for plug-ins of either kind."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeAlias

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from mpmfw.errors import SceneError
from mpmfw_testing.check import Violation
from mpmfw_testing.option_values import candidates, choices
from mpmfw_testing.subject import Subject

#: What the plug-in makes of options, to the bit. Options are refused with a ``ValidationError`` or
#: ``SceneError``.
Experiment: TypeAlias = Callable[[dict[str, Any]], str]


def every_option_acts(subject: Subject, experiments: Sequence[Experiment]) -> None:
    """Ask of every option whether two of its values, the one that it has among them, differ in one of the
    experiments.

    Values are tried alone, and together with each choice or another number of the other options, since an
    option may need one. A refused value says nothing for or against the option.

    Raises
    ------
    Violation
        All values that are accepted do the same, or there are no two to be compared, or none could be made
        up.
    Inapplicable
        The plug-in has no options.
    """
    model = subject.options_model()
    asked = [_remembered(experiment) for experiment in experiments]
    for name, field in model.model_fields.items():
        _check_option(subject, model, name, field, asked)


def _check_option(
    subject: Subject,
    model: type[BaseModel],
    name: str,
    field: FieldInfo,
    experiments: Sequence[Callable[[dict[str, Any]], str | None]],
) -> None:
    values, has = candidates(field), field.get_default(call_default_factory=True)
    configured = name in subject.options
    if configured:  # the default is then a value like others
        values += [] if field.is_required() else [has]
        has = subject.options[name]
    if not values:
        raise Violation(
            f"no value of the option '{name}' could be made up; give its field examples=[…]",
            {"option": name, "type": str(field.annotation)},
        )
    other_values = [value for value in values if value != has]
    silent: list[tuple[Any, dict[str, Any]]] = []
    for others, experiment in itertools.product(_others(model, name), experiments):
        first = experiment(others)
        for value in other_values:
            found = experiment({**others, name: value})
            if first is None or found is None:
                first = first or found
            elif found != first:
                return
            else:
                silent.append((value, others))
    if not silent:
        what = "the configured one" if configured else "the default"
        raise Violation(
            f"every value made up for '{name}' is refused or {what}; give its field examples=[…]",
            {"option": name, what: has, "values": values},
        )
    value, others = silent[0]
    raise Violation(
        "an option is accepted and has no effect",
        {"option": name, "value": value, **({"together with": others} if others else {})},
    )


def _remembered(experiment: Experiment) -> Callable[[dict[str, Any]], str | None]:
    """The experiment, made once for the same options; None where they are refused."""
    found: dict[str, str | None] = {}

    def remembered(options: dict[str, Any]) -> str | None:
        key = repr(sorted(options.items()))
        if key not in found:
            try:
                found[key] = experiment(options)
            except (ValidationError, SceneError):
                found[key] = None
        return found[key]

    return remembered


def _others(model: type[BaseModel], name: str) -> Iterator[dict[str, Any]]:
    """No other option, then each choice, or another number, of each other option."""
    yield {}
    fields = [(other, field) for other, field in model.model_fields.items() if other != name]
    for other, field in sorted(fields, key=lambda one: not choices(one[1].annotation)):
        default = field.get_default(call_default_factory=True)
        values = choices(field.annotation) or candidates(field)
        different = [value for value in values if value != default]
        for value in different if choices(field.annotation) else different[:1]:
            yield {other: value}
