"""The plug-in under test, however it was named, as a maker of fresh objects."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ValidationError

from mpmfw.campaigns.measures import measure_of
from mpmfw.contact.law import ContactLaw
from mpmfw.contact.rows import Detection
from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import refuse_incomplete
from mpmfw.plugin.discovery import Kind, full_name, load, options_of, refuse_class
from mpmfw.plugin.hooks import implemented
from mpmfw.runs.build import BASES
from mpmfw.scene.specification import parse_specification, specification_of
from mpmfw.scene.wording import problems_of
from mpmfw_testing.check import Inapplicable

#: Base classes of the parts of a contact, and of all kinds that there are checks for.
PARTS: dict[Kind, type[Any]] = {"detection": Detection, "law": ContactLaw}
ALL_BASES: dict[Kind, type[Any]] = {**BASES, **PARTS}
#: Parts that others are joined with, in the order of the trials.
PARTNERS: dict[Kind, tuple[str, ...]] = {"detection": ("surfaces", "nodes"), "law": ("penalty", "impulse")}


@dataclass(frozen=True)
class Subject:
    """A plug-in under test: every call of :meth:`make` gives a fresh object.

    A strategy object keeps state of the simulation that it serves, so that a check makes one for each
    simulation.
    """

    kind: Kind  #: one of those that there are checks for
    plugin: type[Any]
    options: Mapping[str, Any] = field(default_factory=dict)  #: those that were given

    @property
    def label(self) -> str:
        """Return name and options, for messages."""
        return specification_of(str(getattr(self.plugin, "name", self.plugin.__name__)), self.options)

    def make(self, **options: Any) -> Any:
        """Return a fresh plug-in with the given options, of which these take the place.

        Raises
        ------
        pydantic.ValidationError
            The plug-in's own model refuses the options.
        """
        return self.plugin(**{**self.options, **options})

    def options_model(self) -> type[BaseModel]:
        """Return the plug-in's ``Options``; ``Inapplicable`` is raised of one without."""
        if not options_of(self.plugin):
            raise Inapplicable("the plug-in has no options")
        return getattr(self.plugin, "Options", self.plugin)


def subject_of(plugin: Any, kind: Kind, options: Mapping[str, Any] | None = None) -> Subject:
    """Return the subject of a class, a configured object, or a name.

    Parameters
    ----------
    plugin
        A plug-in class, also of a detection or a law; an object, whose options are taken for new ones; the
        name of an installed plug-in; or ``module:Class``. Options may follow a name: ``penalty(kappa=2)``.
    kind
        One of those that there are checks for.
    options
        Options over those of the plug-in.

    Raises
    ------
    SceneError
        There is no such plug-in. It is of another kind, refuses the options, cannot be made from them alone,
        has no name, or has hooks that would never be called.
    """
    given = dict(options or {})
    if isinstance(plugin, str):
        text = parse_specification(plugin)
        if twice := sorted(set(text.options) & set(given)):
            raise SceneError(
                f"{plugin}: the option '{twice[0]}' is given beside it as well; leave one of them out"
            )
        # bundled measures have no entry point
        plugin = type(measure_of(text.name)) if kind == "measure" else load(kind, text.name)
        given = {**text.options, **given}
    elif isinstance(plugin, tuple(ALL_BASES.values())):
        made = getattr(plugin, "options", plugin)
        own = {key: getattr(made, key) for key in getattr(made, "model_fields_set", ())}
        plugin, given = type(plugin), {**own, **given}
    elif not isinstance(plugin, type):
        raise SceneError(f"cannot check {plugin!r}: expected a plug-in class, an object of one, or a name")
    if kind == "contact":
        kind = _part_of(plugin) or kind
    if kind in PARTS:
        plugin, kind = _joined(plugin, kind, given), "contact"
    if not issubclass(plugin, ALL_BASES[kind]):
        raise _of_another_kind(plugin, kind)
    refuse_class(plugin)
    if kind == "geometry":
        refuse_incomplete(plugin)
    elif kind not in ("measure", "reference"):
        implemented(object.__new__(plugin))  # refuses hooks that are never called
    _try_to_make(plugin, given)
    return Subject(kind, plugin, given)


def kind_of(plugin: Any) -> Kind:
    """Return the kind of a plug-in's class or object, by its base class; refuse one that has none."""
    kind = plugin if isinstance(plugin, type) else type(plugin)
    for name, base in ALL_BASES.items():
        if issubclass(kind, base):
            return name
    expected = ", ".join(f"mpmfw.api.{base.__name__}" for base in ALL_BASES.values())
    raise SceneError(
        f"cannot check {plugin!r}: expected a class, or an object of one, derived from {expected}"
    )


def _of_another_kind(plugin: type[Any], kind: Kind) -> SceneError:
    expected = f"expected a subclass of mpmfw.api.{ALL_BASES[kind].__name__}"
    return SceneError(f"{full_name(plugin)} is not of the kind {kind}; {expected}")


def _part_of(plugin: type[Any]) -> Kind | None:
    """Return whether a class is a detection or a law; None if it is neither."""
    found = (part for part, base in PARTS.items() if issubclass(plugin, base))
    return None if hasattr(plugin, "Detection") else next(found, None)


def _joined(part: type[Any], kind: Kind, options: Mapping[str, Any]) -> type[Any]:
    """Return the contact strategy of a detection or a law, with the first of ``PARTNERS`` that it goes with.

    Refuse a part of another kind, or that goes with none of them.
    """
    if _part_of(part) != kind:
        raise _of_another_kind(part, kind)
    refuse_class(part)
    partner: Kind = "detection" if kind == "law" else "law"
    refusals = []
    for other in (load(partner, name) for name in PARTNERS[partner]):
        law, detection = (part, other) if kind == "law" else (other, part)
        try:
            joined: type[Any] = law.joined_with(detection)
            with suppress(ValidationError):  # a later call names what is wrong with the options
                joined(**options)
            return joined
        except SceneError as error:
            refusals.append(str(error))
    raise SceneError(f"{kind} '{part.name}' cannot be checked alone: {'; '.join(refusals)}")


def _try_to_make(plugin: type[Any], options: Mapping[str, Any]) -> None:
    """Make one object; constructors of plug-ins may raise any exception."""
    try:
        plugin(**options)
    except SceneError:
        raise
    except ValidationError as error:
        problems = problems_of(error, getattr(plugin, "Options", plugin), options)
        text = "; ".join(f"{'.'.join(map(str, one.path))}: {one.message}" for one in problems)
        raise SceneError(f"{plugin.name}: {text}") from error
    except Exception as error:
        raise SceneError(f"{plugin.name}(…) cannot be made: {type(error).__name__}: {error}") from error
