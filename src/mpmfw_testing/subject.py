"""The plug-in under test, however it was named, as a maker of fresh objects."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ValidationError

from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import refuse_incomplete
from mpmfw.plugin.discovery import (
    Kind,
    did_you_mean,
    full_name,
    load,
    options_of,
    refuse_class,
    refuse_nameless,
)
from mpmfw.plugin.hooks import make_manager, register
from mpmfw.scene.specification import parse_specification, specification_of
from mpmfw_testing.check import Inapplicable
from mpmfw_testing.parts import PARTS, part_of, whole


@dataclass(frozen=True)
class Subject:
    """A plug-in under test: every call of :meth:`make` gives a fresh object.

    A strategy object keeps state of the simulation that it serves, so that a check makes one for each
    simulation.
    """

    kind: Kind  #: one of those that there are checks for
    label: str  #: name and options, for messages
    plugin: type[Any] | None  #: the class; None where a function makes the objects
    factory: Callable[..., Any]  #: takes options as keywords
    options: Mapping[str, Any] = field(default_factory=dict)  #: those that were given

    def make(self, **options: Any) -> Any:
        """A fresh plug-in with the given options, and these in their place.

        Raises
        ------
        pydantic.ValidationError
            The plug-in's own model refuses the options.
        """
        return self.factory(**{**self.options, **options})

    def options_model(self) -> type[BaseModel]:
        """The plug-in's ``Options``.

        Raises
        ------
        Inapplicable
            The plug-in has no options that could be set.
        """
        if self.plugin is None or not options_of(self.plugin):
            raise Inapplicable("the plug-in has no options")
        return getattr(self.plugin, "Options", self.plugin)


def subject_of(plugin: Any, kind: Kind, options: Mapping[str, Any] | None = None) -> Subject:
    """The subject of a class, a configured object, a function without arguments, or a name.

    Parameters
    ----------
    plugin
        A plug-in class, of a detection or a law as well; an object, of whose options fresh ones are made; a
        function that makes objects; the name of an installed plug-in; or ``module:Class``; names may be
        followed by options, as in ``penalty(kappa=2)``.
    kind
        One of those that there are checks for.
    options
        Options over those of the plug-in.

    Raises
    ------
    SceneError
        There is no such plug-in, it is of another kind, it refuses the options, or cannot be made from them
        alone, or it has no name, or hooks that would never be called.
    """
    given = dict(options or {})
    if isinstance(plugin, str):
        text = parse_specification(plugin)
        twice = sorted(set(text.options) & set(given))
        if twice:
            raise SceneError(
                f"{plugin}: the option '{twice[0]}' is given beside it as well; leave one of them out"
            )
        given = {**text.options, **given}
        plugin = _named(kind, text.name)
    if kind == "contact":
        kind = part_of(plugin) or kind
    if kind in PARTS:
        plugin, kind, given = _whole(plugin, kind, given)
    if isinstance(plugin, type):
        _check_kind(plugin, kind)
        refuse_class(plugin)
        _refuse_unusable(plugin, kind)
        _one(plugin, given)
        return Subject(kind, _label(plugin, given), plugin, plugin, given)
    if isinstance(plugin, tuple(bases_of_kinds().values())):
        return subject_of(type(plugin), kind, {**_options_set(plugin), **given})
    if callable(plugin):
        made = _one(plugin, given)
        _check_kind(type(made), kind)
        refuse_nameless(type(made))
        _refuse_unusable(type(made), kind)
        return Subject(kind, _label(type(made), given), None, plugin, given)
    raise SceneError(
        f"cannot check {plugin!r}: expected a plug-in class, an object of one, a function that makes one, or "
        "a name"
    )


def _whole(plugin: Any, kind: Kind, given: dict[str, Any]) -> tuple[type[Any], Kind, dict[str, Any]]:
    """The contact strategy of a detection or a law, or of an object of one, with its options.

    Raises
    ------
    SceneError
        It is none, or goes with no other part.
    """
    if isinstance(plugin, type):
        refuse_class(plugin)
        return whole(plugin, kind, given), "contact", given
    if part_of(plugin) is None:
        raise SceneError(
            f"cannot check {plugin!r}: expected a {kind} plug-in's class, an object of one, or a name"
        )
    given = {**_options_set(plugin), **given}
    return whole(type(plugin), kind, given), "contact", given


def _named(kind: Kind, name: str) -> type[Any]:
    """The class of a name; bundled measures are registered, not announced."""
    if kind == "measure":
        from mpmfw.campaigns.measures import measure_of

        return type(measure_of(name))
    return load(kind, name)


def _refuse_unusable(plugin: type[Any], kind: Kind) -> None:
    """Refuse a class with hooks that nobody would call, or a geometry that does not say what it must."""
    if kind == "geometry":
        refuse_incomplete(plugin)
    elif kind not in ("measure", "reference"):
        register(make_manager(), object.__new__(plugin), full_name(plugin))


def bases_of_kinds() -> dict[Kind, type[Any]]:
    """Base classes of the kinds that there are checks for."""
    from mpmfw.runs.build import BASES

    return dict(BASES)


def _check_kind(plugin: type[Any], kind: Kind) -> None:
    bases = bases_of_kinds()
    if not issubclass(plugin, bases[kind]):
        raise SceneError(
            f"{full_name(plugin)} is no {kind} plug-in; expected a subclass of "
            f"mpmfw.api.{bases[kind].__name__}"
        )


def _one(factory: Callable[..., Any], options: Mapping[str, Any]) -> Any:
    """One object, to see that it can be made; a stranger's constructor may raise anything."""
    name = str(getattr(factory, "name", getattr(factory, "__qualname__", factory)))
    try:
        return factory(**options)
    except ValidationError as error:
        text = "; ".join(_problem_text(factory, problem) for problem in error.errors())
        raise SceneError(f"{name}: {text}") from error
    except SceneError:
        raise
    except Exception as error:
        if isinstance(error, TypeError) and not isinstance(
            factory, type
        ):  # of a class the signature has been read
            raise SceneError(f"{name}(…) must be made from its options alone: {error}") from error
        raise SceneError(f"{name}(…) cannot be made: {type(error).__name__}: {error}") from error


def _problem_text(plugin: Any, problem: Any) -> str:
    where = ".".join(map(str, problem["loc"])) or "options"
    if problem["type"] == "extra_forbidden" and options_of(plugin):
        return f"no such option '{where}'; {did_you_mean(where, options_of(plugin))}"
    if problem["type"] == "missing":
        return f"{where}: missing; give it as in '{getattr(plugin, 'name', 'NAME')}({where}=…)'"
    return f"{where}: {problem['msg']}"


def _label(plugin: type[Any], options: Mapping[str, Any]) -> str:
    return specification_of(str(getattr(plugin, "name", plugin.__name__)), options)


def _options_set(plugin: Any) -> dict[str, Any]:
    options = getattr(plugin, "options", plugin)
    return {key: getattr(options, key) for key in getattr(options, "model_fields_set", ())}
