"""Where two bodies may touch: replace the normal, or all that finds the rows, by your own."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api.types import FloatArray, SceneError, State
from mpmfw.contact.nodes import AtNodes


class TemplateOptions(BaseModel):
    """How strongly the stiffer body leads the normal: 0 as both, 10 as the stiffer one alone."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    exponent: float = Field(1.0, ge=0, le=10)


class Template(AtNodes):
    """Rows at nodes that two bodies share, the normal from both volume gradients, weighted by powers of the
    wave moduli."""

    name = "template"
    Options = TemplateOptions
    options: TemplateOptions

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:
        """Laws of impulses alone: no gap is measured."""
        if "gap" in needs or forces:
            raise SceneError("detection 'template' measures no gap, which the law needs")

    def weights(self, state: State) -> tuple[FloatArray, FloatArray]:
        """What the volume gradients of every pair's bodies weigh in its normal, (pair,) each [1]."""
        moduli = np.array([body.p_wave_modulus for body in state.bodies]) ** self.options.exponent
        first = moduli[[pair.first for pair in state.pairs]]
        second = moduli[[pair.second for pair in state.pairs]]
        return first / (first + second), second / (first + second)
