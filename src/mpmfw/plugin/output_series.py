"""Series of a user's own: declared with name, unit and dimensions, computed at outputs, stored like the
built-in ones."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from mpmfw.errors import PluginError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.named import NamedPlugIn
from mpmfw.state.fields import AnyArray, Field
from mpmfw.state.structs import State


class OutputSeries(NamedPlugIn):
    """Base of diagnostics: one instance for each table ``[outputs.NAME]`` of the scene, with that table's
    options.

    Subclasses say which series they have, :meth:`series`, and what these are, :meth:`values`. In the results
    each is called after the scene's name of the table, ``NAME_series``.
    """

    stage = "output"

    def series(self) -> list[Field]:
        """Declarations: name, dims, unit and meaning; may be asked more than once.

        Dims ``body``, ``pair``, ``axis`` and ``rotation`` have their lengths and labels from the scene,
        others from the values.
        """
        raise NotImplementedError

    def values(self, state: State, interval: float) -> Mapping[str, Any]:
        """Return the numbers of every declared series, by its name, at an output.

        ``state`` may not be changed. ``interval`` [s] is the time since the last output, 0 at the first:
        there a sum over the run begins."""
        raise NotImplementedError

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The series, under the names that the results have for them."""
        return [
            dataclasses.replace(field, name=f"{self.title}_{field.name}", group="series", output=True)
            for field in self.series()
        ]

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Return the values of all declared series; raise PluginError for other ones."""
        values = self.values(state, interval)
        declared = {field.name for field in self.series()}
        given = set(dict(values))
        if given != declared:
            found, expected = (", ".join(sorted(names)) for names in (given, declared))
            message = (
                f"'{self.title}' ({self.name}) answered with values of {found or 'nothing'}; "
                f"expected {expected}"
            )
            raise PluginError(message, step=state.steps, time=state.time)
        return {f"{self.title}_{name}": value for name, value in values.items()}
