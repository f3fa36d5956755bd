"""What checks a case, a table or its ``check.py``, works with: runs, rows and figures."""

from __future__ import annotations

import itertools
import math
import time
import tomllib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpmfw.errors import ResultsWarning, SceneError, SimulationError
from mpmfw.scene import Scene, load_scene
from mpmfw.validation.rows import Row

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_METHODS = tomllib.loads((files("mpmfw.validation") / "methods.toml").read_text(encoding="utf-8"))
#: Contacts and shapes that the gates are for.
RECOMMENDED = _METHODS["recommended"]

CLASSICAL, CONTACTS, SHAPES = (tuple(_METHODS[name]) for name in ("classical", "contacts", "shapes"))


@dataclass(frozen=True)
class Method:
    """One way to run a scene.

    Attributes
    ----------
    contact, shape
        Names, with options as in ``penalty(kappa=2)``; an empty contact is a scene without.
    set
        Values by dotted key, set over the scene's own.
    label
        What ``set`` is about, in words; empty if it need not be said.
    bound
        Whether its case says that gates are for it as well.
    """

    contact: str
    shape: str
    set: Mapping[str, Any] = field(default_factory=dict, hash=False)
    label: str = ""
    bound: bool = field(default=False, compare=False)

    @property
    def recommended(self) -> bool:
        """Whether it is a combination that the gates are for (``methods.toml``), all else as given by the scene; or bound."""
        contacts = ("", *RECOMMENDED["contacts"])
        return self.bound or (
            self.contact in contacts and self.shape in RECOMMENDED["shapes"] and not self.label
        )

    def __str__(self) -> str:
        return ", ".join(filter(None, (self.contact, self.shape, self.label)))


@dataclass
class Case:
    """A case while it is checked; a ``check.py`` receives one.

    Attributes
    ----------
    folder
        Of the case; its name is the case's.
    quick
        Whether the reduced version runs.
    rows, figures
        What was recorded.
    """

    folder: Path
    quick: bool = False
    rows: list[Row] = field(default_factory=list)
    figures: dict[str, Figure] = field(default_factory=dict)
    _cpu_time: float = math.nan

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.name

    def methods(
        self,
        contact: Sequence[str] = tuple(RECOMMENDED["contacts"]),
        shape: Sequence[str] = tuple(RECOMMENDED["shapes"][:1]),
        settings: Mapping[str, Mapping[str, Any]] | None = None,
    ) -> list[Method]:
        """Every combination; ``settings`` are values by dotted key, under the label that says what they are."""
        given = {"": {}} if settings is None else settings
        return [
            Method(c, s, dict(values), label)
            for c, s, (label, values) in itertools.product(contact, shape, given.items())
        ]

    def scene(self, given: str | Mapping[str, Any], method: Method | None, set: Mapping[str, Any]) -> Scene:
        """What a run runs: a file of the case, a shipped scene or nested mappings, all values set."""
        chosen = {"contact.method": method.contact, "shape.method": method.shape} if method else {}
        values = {key: one for key, one in chosen.items() if one}
        if isinstance(given, str) and (self.folder / given).exists():
            given = str(self.folder / given)
        return load_scene(given, set={**values, **set, **(method.set if method else {})})

    def run(
        self,
        scene: str | Scene = "scene.toml",
        method: Method | None = None,
        set: Mapping[str, Any] | None = None,
    ) -> xr.DataTree:
        """Run a scene, or a file of the case or a shipped scene by name.

        Raises
        ------
        SimulationError, SceneError
            As :func:`mpmfw.run`; :meth:`runs` records them instead.
        """
        from mpmfw.runs.run import run

        loaded = scene if isinstance(scene, Scene) else self.scene(scene, method, set or {})
        with warnings.catch_warnings():
            # Methods that creep at rest end their settling with a warning; what they then do is in the rows.
            warnings.simplefilter("ignore", ResultsWarning)
            tree = run(loaded)
        self._cpu_time = float(tree.attrs["cpu_time"]) + float(tree.attrs.get("settle_time", 0.0))
        return tree

    def runs(
        self,
        methods: Sequence[Method],
        scene: str = "scene.toml",
        set: Mapping[str, Any] | None = None,
        binds: bool | None = None,
    ) -> Iterator[tuple[Method, xr.DataTree]]:
        """Run a scene with each method; one that fails keeps its row and is not yielded.

        The row is red if the method is the recommended one, or as ``binds`` says.
        """
        for method in methods:
            try:
                tree = self.run(scene, method, set)
            except (SimulationError, SceneError) as error:
                self._cpu_time = math.nan
                self.failed(method, str(error), binds)
            else:
                yield method, tree

    def failed(self, method: Method | str, why: str, binds: bool | None = None, at: str = "") -> None:
        """Record that a method got no result at a place, and why."""
        if binds is None:
            binds = isinstance(method, Method) and method.recommended
        name = f"{at}: run" if at else "run"
        row = Row(self.name, str(method), name, math.nan, reference="ends", least=0.0, binds=binds, note=why)
        self.rows.append(row)

    def gate(
        self,
        quantity: str,
        value: float,
        *,
        within: tuple[float, float] | None,
        reference: float | str = "",
        unit: str = "",
        method: Method | str = "",
        binds: bool = True,
    ) -> None:
        """Record a value that must lie within limits, if there are any, or, if it does not bind, a value that may."""
        least, most = (-math.inf, math.inf) if within is None else (float(limit) for limit in within)
        row = Row(
            self.name,
            str(method),
            quantity,
            float(value),
            unit,
            reference,
            least,
            most,
            binds,
            self._cpu_time,
        )
        self.rows.append(row)

    def judge(self, method: Method, quantity: str, value: float, **limits: Any) -> None:
        """Record a value whose gate binds the recommended method only."""
        self.gate(quantity, value, method=method, binds=method.recommended, **limits)

    def show(
        self, quantity: str, value: float, *, within: tuple[float, float] | None = None, **said: Any
    ) -> None:
        """Record a value that decides nothing."""
        self.gate(quantity, value, within=within, binds=False, **said)

    def figure(self, name: str, figure: Figure) -> None:
        """Keep a figure, to be saved as ``<case>-<name>.png``, or ``<case>.png`` without a name."""
        self.figures[f"{self.name}-{name}" if name else self.name] = figure

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Take the CPU time of what is inside as that of the rows recorded afterwards."""
        start = time.process_time()
        try:
            yield
        finally:
            self._cpu_time = time.process_time() - start
