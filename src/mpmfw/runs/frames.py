"""Frames of output: declared fields and diagnostics of plug-ins, sorted by group."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.errors import PluginError, SimulationError
from mpmfw.plugin.checks import described, naming
from mpmfw.results import Frame, RunHeader, provenance
from mpmfw.results.timeline import STATIC
from mpmfw.scene.bodies import side_labels
from mpmfw.state.fields import PARTICLE_FIELDS, SURFACE_FIELDS, AnyArray, Field
from mpmfw.state.structs import State
from mpmfw.state.windows import update_pairs

if TYPE_CHECKING:
    from mpmfw.scene import Scene


class Recorder:
    """Makes the header and the frames of one run."""

    history = ("_intervals",)

    def __init__(
        self, scene: Scene, state: State, declared: tuple[Field, ...], hook: Any, recording: Sequence[Any]
    ) -> None:
        self.state, self.hook, self.recording = state, hook, recording
        groups = {"series", "contact"}
        groups |= {group for group in ("particles", "surface") if getattr(scene.output, group)}
        core = PARTICLE_FIELDS if state.surface is None else (*PARTICLE_FIELDS, *SURFACE_FIELDS)
        recorded = [field for field in (*core, *declared) if field.output and field.group in groups]
        self.fields = {(field.group, field.name): field for field in recorded}
        rounding = np.finfo(np.float32).eps * max(map(abs, (*scene.grid.lower, *scene.grid.upper)))
        far = rounding > 1e-3 * scene.grid.cell_size  # from the origin
        for key, field in self.fields.items():
            if field.group != "particles" or key in STATIC or (far and field.unit == "m"):
                continue
            if np.dtype(field.dtype) == np.float64:
                self.fields[key] = dataclasses.replace(field, dtype="f4")
        self._particle_interval = scene.output.particle_interval
        self._output_interval = scene.time.output_interval
        self._intervals = 0  #: of the material points, up to their last frame
        self._by_name = {field.name: field for field in declared}
        self._constant = self._sums()
        self.sides = side_labels(scene)

    def header(self, attributes: Mapping[str, Any]) -> RunHeader:
        """Return the data of the run before the first step."""
        state, surface, counts, connectivity = self.state, self.state.surface, {}, {}
        if surface is not None and any(group == "surface" for group, _ in self.fields):
            for body in state.bodies:
                own = surface.of(body.index)
                counts[body.name] = own.stop - own.start
                facets = surface.facets[surface.facets_of(body.index)] - own.start
                connectivity[body.name] = facets[:, 1] if state.grid.dim == 2 else facets
        return RunHeader(
            dim=state.grid.dim,
            bodies=tuple(body.name for body in state.bodies),
            pairs=tuple(pair.label for pair in state.pairs),
            sides=self.sides,
            more_pairs=state.near is not None,
            per_metre=state.particles.thickness is None,
            particle_count={b.name: b.particles.stop - b.particles.start for b in state.bodies},
            fields=tuple(self.fields.values()),
            surface_count=counts,
            connectivity=connectivity,
            attributes={**attributes, **provenance()},
        )

    def frame(self, interval: float, *, points: bool = True) -> Frame:
        """Return the present arrays, ``interval`` [s] after the last output."""
        state = self.state
        update_pairs(state, self.hook)
        check_state_finite(state)
        if self._sums() != self._constant:
            text = "a plug-in changed the material points' masses or initial volumes (docs/hooks.md)"
            raise PluginError(text, step=state.steps, time=state.time)
        groups = ("particles", "surface", "series", "contact") if points else ("surface", "series", "contact")
        found: dict[str, dict[str, AnyArray]] = {group: {} for group in groups}
        for group, name in self.fields:
            if group in found and name not in self._by_name:
                found[group][name] = getattr(getattr(state, group), name)
        answers = self.hook.diagnostics(state=state, interval=interval, points=points) or []
        who = self.recording if len(answers) == len(self.recording) else [None] * len(answers)
        for plugin, answer in zip(who, answers, strict=True):
            with naming(plugin, "diagnostics", state):
                for name, values in answer.items():
                    group, checked = self._by_name[name].group, self._checked(plugin, name, values)
                    if group in found and (group, name) in self.fields:
                        found[group][name] = checked
        pairs, by_pair = state.pairs, found.pop("contact")
        contact = {pair.label: {name: v[pair.index] for name, v in by_pair.items()} for pair in pairs}
        return Frame(
            time=state.time,
            particles=found.get("particles", {}),
            surface=found["surface"],
            series=found["series"],
            contact=contact if by_pair else {},
            pairs=() if state.near is None else tuple(pair.label for pair in pairs),
        )

    def points_are_due(self, time: float) -> bool:
        """Return True if the output at ``time`` [s] has points; call it once for each."""
        if self._particle_interval is None:
            return True
        before = self._intervals
        self._intervals = math.floor((time + 0.5 * self._output_interval) / self._particle_interval)
        return self._intervals > before

    def _checked(self, plugin: Any, name: str, given: Any) -> AnyArray:
        """Return the values of a field as declared; NaN must have a meaning there."""
        field = self._by_name[name]
        values = np.asarray(given, dtype=field.dtype)
        if values.ndim != len(field.dims):
            raise ValueError(f"'{name}' has the shape {values.shape}; declared are the dims {field.dims}")
        allowed = values.dtype.kind != "f" or (bool(field.missing) and not np.isinf(values).any())
        if not allowed and not np.isfinite(values).all():
            text = f"{field.group}/{name} of {described(plugin)} is not finite"
            raise SimulationError(text, time=self.state.time, advice="a smaller time.safety")
        return values

    def _sums(self) -> tuple[float, float]:
        p = self.state.particles
        return float(p.mass.sum()), float(p.initial_volume.sum())


def check_state_finite(state: State) -> None:
    """Raise SimulationError with body, point and array for NaN or infinity."""
    p = state.particles
    for name in ("position", "velocity", "deformation_gradient", "stress"):
        values = getattr(p, name)
        # A finite sum is one of finite numbers, and takes a fifth of the time
        if not np.isfinite(values.sum()) and not np.isfinite(values).all():
            index = int(np.flatnonzero(~np.isfinite(values.reshape(p.count, -1)).all(axis=1))[0])
            text = f"the {name.replace('_', ' ')} of a material point is not finite"
            raise state.error_at(index, text, advice="a smaller time.safety")
