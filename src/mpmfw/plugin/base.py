"""Base of all plug-ins: a name, and options validated by a model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict


class NoOptions(BaseModel):
    """Options of a plug-in that has none."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class PlugIn:
    """Base of plug-ins: a name, and options validated by the plug-in's own model.

    Parameters
    ----------
    options
        Values of the plug-in's ``Options``; those left out have the model's defaults.

    Raises
    ------
    pydantic.ValidationError
        An option is unknown, or its value is refused by the model.
    """

    #: What scenes and the entry point call the plug-in. Beside it a class may say ``interface = 1``, the
    #: version of the plug-in interface (``mpmfw.api.INTERFACE``) that it is written for; without it that is
    #: 1.
    name: ClassVar[str]
    #: Model of the options; :class:`NoOptions` takes none. The validated instance is ``self.options``.
    Options: ClassVar[type[BaseModel]] = NoOptions
    #: Dimensions that it works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Reason for these dimensions, for the message that refuses others.
    dimensions_note: ClassVar[str] = ""
    #: Stage of the clock that its hooks are charged to; None leaves them with the stage of the core that
    #: calls them.
    stage: ClassVar[str | None] = None
    #: Names of the attributes that it keeps from step to step (``mpmfw.state.history``), beside those of its
    #: bases.
    history: ClassVar[tuple[str, ...]] = ()

    def __init__(self, **options: Any) -> None:
        self.options = self.Options(**options)

    @classmethod
    def from_options(cls, options: BaseModel) -> Self:
        """Make the plug-in from an instance of its model, keeping which options were set."""
        return cls(**{key: getattr(options, key) for key in options.model_fields_set})

    @property
    def label(self) -> str:
        """Name and the options that were set, for tables and coordinates; wherever a method is named, it
        names this one."""
        return self.label_with({key: getattr(self.options, key) for key in self.options.model_fields_set})

    def label_with(self, options: Mapping[str, Any]) -> str:
        """The plug-in's name and these options as one text, ``NAME(option=value, …)``.

        ``options`` are values by name; those that are None are not said.
        """
        from mpmfw.scene.specification import specification_of

        return specification_of(self.name, options)
