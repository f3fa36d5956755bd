"""The rule that no option is without effect, and the values of options that are tried."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Annotated, Any, Literal, TypeAlias, get_args, get_origin

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from mpmfw.errors import SceneError
from mpmfw_testing.check import Violation
from mpmfw_testing.subject import Subject

#: A function that returns the digest of what the plug-in does with options; None where they are refused.
Experiment: TypeAlias = Callable[[dict[str, Any]], str | None]


def every_option_acts(subject: Subject, experiments: Sequence[Callable[[dict[str, Any]], str]]) -> None:
    """Require of every option that two of its values, its own among them, differ in one of the experiments.

    Values are tried alone, and together with each choice or another number of the other options, since an
    option may need one. A refused value says nothing for or against the option. It is a violation as well if
    there are no two values to be compared.
    """
    model = subject.options_model()
    remembered = [_remembered(experiment) for experiment in experiments]
    for name, field in model.model_fields.items():
        _check_option(subject, model, name, field, remembered)


def _check_option(
    subject: Subject, model: type[BaseModel], name: str, field: FieldInfo, experiments: Sequence[Experiment]
) -> None:
    values, own = candidates(field), field.get_default(call_default_factory=True)
    configured = name in subject.options
    if configured:  # the default is then a value like others
        values += [] if field.is_required() else [own]
        own = subject.options[name]
    if not values:
        raise Violation(
            f"no value of the option '{name}' could be made up; give its field examples=[…]",
            {"option": name, "type": str(field.annotation)},
        )
    silent: list[tuple[Any, dict[str, Any]]] = []
    for others, experiment in itertools.product(_others(model, name), experiments):
        first = experiment(others)
        for value in (value for value in values if value != own):
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
            {"option": name, what: own, "values": values},
        )
    value, others = silent[0]
    raise Violation(
        "an option is accepted and has no effect",
        {"option": name, "value": value, **({"together with": others} if others else {})},
    )


def _remembered(experiment: Callable[[dict[str, Any]], str]) -> Experiment:
    """Return the experiment, made once for the same options."""
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
    """Yield no other option, then each choice, or another number, of each other option."""
    yield {}
    fields = [(other, field) for other, field in model.model_fields.items() if other != name]
    for other, field in sorted(fields, key=lambda one: not _choices(one[1].annotation)):
        default = field.get_default(call_default_factory=True)
        choices = _choices(field.annotation)
        different = [value for value in choices or candidates(field) if value != default]
        for value in different if choices else different[:1]:
            yield {other: value}


def candidates(field: FieldInfo) -> list[Any]:
    """Return values to try of an option: the field's examples, then values that its type accepts.

    A value may still be refused by a validator of the model. An example may be the value that the plug-in
    under test was given, so that examples alone would leave nothing to compare it with.
    """
    default = field.get_default(call_default_factory=True)
    leaves = list(_leaves(field.annotation)) + [leaf for each in field.metadata for leaf in _leaves(each)]
    bounds = [getattr(leaf, name, None) for leaf in leaves for name in ("gt", "ge", "lt", "le")]
    ends = sorted(float(bound) for bound in bounds if bound is not None)
    numbers: list[float] = [0.01, 1.0, 0.1, 0.0, 2.0]
    if isinstance(default, int | float) and not isinstance(default, bool):
        numbers = [2.0 * default, default / 2.0, *numbers]
    numbers += [end + step for end in ends for step in (1.0, -1.0, 0.0)]
    numbers += [ends[0] + (ends[-1] - ends[0]) * share for share in (0.25, 0.75) if len(ends) > 1]
    vectors = ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0, 1.0))
    made_up = [*_choices(field.annotation), *numbers, *map(math.floor, numbers), "second", "first", *vectors]
    annotation: Any = Annotated[field.annotation, *field.metadata, None]
    accepted: TypeAdapter[Any] = TypeAdapter(annotation)
    tried = list(field.examples or ())
    for value in made_up:
        try:
            accepted.validate_python(value, strict=not isinstance(value, tuple))
        except Exception:  # a stranger's validator may raise anything
            continue
        if value not in tried:  # no set: values need not be hashable
            tried.append(value)
    return tried


def _leaves(annotation: Any) -> Iterator[Any]:
    """Yield the parts of a type, and the constraints in it."""
    yield annotation
    parts = (*get_args(annotation), *getattr(annotation, "metadata", ()))
    for part in parts if get_origin(annotation) is not Literal else ():
        yield from _leaves(part)


def _choices(annotation: Any) -> list[Any]:
    """Return all values of a type that has a few: a ``Literal`` or bool, or a union with one."""
    choices = [
        [False, True] if leaf is bool else get_args(leaf)
        for leaf in _leaves(annotation)
        if leaf is bool or get_origin(leaf) is Literal
    ]
    return [value for values in choices for value in values]
