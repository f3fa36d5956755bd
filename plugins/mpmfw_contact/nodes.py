"""Detection at grid nodes: those that two bodies share, with the normal of their volume gradients; in 2D and 3D.

Multiple velocity fields: Bardenhagen, Brackbill & Sulsky (2000), Bardenhagen et al. (2001).
"""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.api import ContactRows, Detection, FloatArray, Grid, Particles, SceneError, Setup, State, Stencil
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.types import Floats, Indices, Ints

#: Share of a full cell's mass that both bodies must have at a node for a force to act there: with less it would be all
#: acceleration.
LEAST_MASS = 0.05


@kernel
def find_shared_nodes(
    first: Ints,
    second: Ints,
    window_lower: Ints,
    window_shape: Ints,
    offset: Ints,
    node_mass: Floats,
    pair: Ints,
    node_a: Ints,
    node_b: Ints,
) -> int:
    """List the nodes where both bodies of a pair have mass; return how many there are, stored or not.

    Only the intersection of the two windows is visited: bodies apart cost a comparison.
    """
    dim = window_lower.shape[1]
    count = 0
    for c in range(len(first)):
        a, b = first[c], second[c]
        total = 1
        for d in range(dim):
            low = max(window_lower[a, d], window_lower[b, d])
            high = min(window_lower[a, d] + window_shape[a, d], window_lower[b, d] + window_shape[b, d])
            total *= max(high - low, 0)
        for flat in range(total):
            rest = flat
            i, j, stride_a, stride_b = 0, 0, 1, 1
            for reverse in range(dim):
                d = dim - 1 - reverse
                low = max(window_lower[a, d], window_lower[b, d])
                high = min(window_lower[a, d] + window_shape[a, d], window_lower[b, d] + window_shape[b, d])
                index = low + rest % (high - low)
                rest //= high - low
                i += (index - window_lower[a, d]) * stride_a
                j += (index - window_lower[b, d]) * stride_b
                stride_a *= window_shape[a, d]
                stride_b *= window_shape[b, d]
            i, j = offset[a] + i, offset[b] + j
            if node_mass[i] > 0.0 and node_mass[j] > 0.0:
                if count < len(pair):
                    pair[count], node_a[count], node_b[count] = c, i, j
                count += 1
    return count


@kernel
def project_volume_gradient(
    row: Ints, nodes: Indices, gradient: Floats, volume: Floats, out: Floats, spacing: tuple[float, ...]
) -> None:
    """Σ_p V_p ∇φ_ip, which points out of the body."""
    dim = len(spacing)
    out[:] = 0.0
    for p in range(len(volume)):
        for k in range(row[p], row[p + 1]):
            for d in range(dim):
                out[nodes[k], d] += volume[p] * gradient[k, d]


@kernel
def project_position(
    row: Ints,
    nodes: Indices,
    weight: Floats,
    mass: Floats,
    position: Floats,
    node_mass: Floats,
    out: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Σ_p φ_ip m_p x_p / m_i."""
    dim = len(spacing)
    out[:] = 0.0
    for p in range(len(mass)):
        for k in range(row[p], row[p + 1]):
            for d in range(dim):
                out[nodes[k], d] += weight[k] * mass[p] * position[p, d]
    for i in range(len(node_mass)):
        if node_mass[i] > 0.0:
            for d in range(dim):
                out[i, d] /= node_mass[i]


@kernel
def write_rows(
    found: int, pairs: Ints, node_a: Ints, node_b: Ints, first: Ints, window_lower: Ints, window_shape: Ints, offset: Ints,
    grid_nodes: Ints, weight_first: Floats, weight_second: Floats, given: Floats, gradient: Floats, mean: Floats,
    cut_off: float, least_mass: float, node_mass: Floats, start_velocity: Floats, dt: float,
    pair: Ints, identity: Ints, sign: Floats, gap: Floats, area: Floats, whole: Floats, normal: Floats, motion: Floats,
    start: Ints, dof: Ints, weight: Floats, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each shared node whose normal is known and where the bodies are near; their number.

    n ∝ w_b g_b − w_a g_a of the outward volume gradients, or the given one, out of the second body. The gap is the bodies'
    extrapolated separation less the cut-off, and the area what both have across the normal, S_i = Σ V ∇φ = ∮ φ n dS.
    """
    dim = len(spacing)
    n = scratch.vector(spacing)
    c = 0
    for f in range(found):
        i, j, p = node_a[f], node_b[f], pairs[f]
        if least_mass > 0.0 and min(node_mass[i], node_mass[j]) < least_mass:
            continue
        square = 0.0
        for d in range(dim):
            n[d] = -given[d]
            if len(gradient) > 0:
                n[d] = weight_second[p] * gradient[j, d] - weight_first[p] * gradient[i, d]
            square += n[d] * n[d]
        if square == 0.0:
            continue
        length, apart, of_a, of_b = math.sqrt(square), 0.0, 0.0, 0.0
        for d in range(dim):
            n[d] /= length
            if len(mean) > 0:
                apart += (mean[i, d] - mean[j, d]) * n[d]
            if len(gradient) > 0:
                of_a -= gradient[i, d] * n[d]
                of_b += gradient[j, d] * n[d]
        if len(mean) > 0 and apart >= cut_off:
            continue
        index, rest, stride = 0, i - offset[first[p]], 1
        for reverse in range(dim):
            d = dim - 1 - reverse
            index += (window_lower[first[p], d] + rest % window_shape[first[p], d]) * stride
            rest //= window_shape[first[p], d]
            stride *= grid_nodes[d]
        pair[c], identity[c], sign[c] = p, p * stride + index, 1.0
        gap[c] = apart - cut_off if len(mean) > 0 else 0.0
        area[c] = max(min(of_a, of_b), 0.0)
        whole[c] = spacing[0] ** (dim - 1)
        for d in range(dim):
            normal[c, d] = n[d]
            motion[c, d] = dt * (start_velocity[i, d] - start_velocity[j, d])
        start[c] = 2 * c
        dof[2 * c], weight[2 * c] = i, 1.0
        dof[2 * c + 1], weight[2 * c + 1] = j, -1.0
        c += 1
    start[c] = 2 * c
    return c


class NodesOptions(BaseModel):
    """Criterion of contact and kind of normal."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    criterion: Literal["auto", "velocity", "position"] = Field(
        "auto",
        description="velocity: bodies approach at a shared node (2000, 2001); position: and their extrapolated "
        "positions are closer than the cut-off; auto: position where the law needs a gap, else velocity",
    )
    cut_off: float = Field(
        0.8, gt=0, description="separation in cells below which bodies touch (criterion = position)"
    )
    normal: Literal["averaged", "master", "specified"] = Field(
        "averaged", description="averaged of the pair, the stiffer body's, or given by `direction`"
    )
    direction: tuple[float, ...] | None = Field(
        None, description="unit vector out of a pair's first body (normal = specified)"
    )

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> NodesOptions:
        if "cut_off" in self.model_fields_set and self.criterion == "velocity":
            raise ValueError(
                '\'cut_off\' has no effect with criterion = "velocity"; expected criterion = "position"'
            )
        if (self.direction is not None) != (self.normal == "specified"):
            raise ValueError("'direction' and normal = \"specified\" go together")
        if self.direction is not None and not np.isclose(np.linalg.norm(self.direction), 1.0):
            raise ValueError("'direction' must have length 1")
        return self


class Nodes(Detection):
    """Grid nodes with mass of both bodies of a pair; a row is v_a − v_b there."""

    name = "nodes"
    Options = NodesOptions
    options: NodesOptions

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.by_position = self.options.criterion == "position"
        self.forces = False

    def for_law(self, *, needs_gap: bool, forces: bool) -> None:
        """A gap is that of positions; forces need an area, and nodes that have some mass.

        Raises
        ------
        SceneError
            The criterion of velocity measures no gap, a given normal no area.
        """
        self.forces = forces
        if needs_gap and self.options.criterion == "velocity":
            raise SceneError(
                'detection \'nodes\' with criterion = "velocity" measures no gap, which the law needs; expected "position"'
            )
        if forces and self.options.normal == "specified":
            raise SceneError(
                "detection 'nodes' with normal = \"specified\" measures no area, which the law needs; expected "
                '"averaged" or "master"'
            )
        self.by_position = self.by_position or needs_gap

    def parts(self, contact: Any) -> list[Any]:
        """What follows averaged normals; the other kinds lean on one body alone."""
        if self.options.normal != "averaged":
            return []
        from mpmfw_contact._leaning import LeaningNormals

        return [LeaningNormals(contact, self)]

    def prepare(self, setup: Setup, owner: str) -> None:
        """The given direction, and the bodies of the pairs.

        Raises
        ------
        SceneError
            The direction has not the grid's number of components.
        """
        direction = self.options.direction
        if direction is not None and len(direction) != setup.dim:
            raise SceneError(
                f"contact.{owner}.direction: expected {setup.dim} components, found {len(direction)}"
            )
        self.state, self.owner = setup.state, owner
        self.given = np.array(direction if direction is not None else [0.0] * setup.dim)
        self.cut_off = self.options.cut_off * setup.cell_size if self.by_position else np.inf
        cell = min(body.density for body in setup.bodies) * setup.cell_size**setup.dim
        self.least_mass = LEAST_MASS * cell if self.forces else 0.0
        self.shared = np.zeros((3, 64), dtype=np.int64)
        self.frame = -1
        self.list_pairs(setup.state)

    def list_pairs(self, state: State) -> None:
        """Bodies of all pairs, and which of their gradients make up the normal: both, or the stiffer body's alone."""
        bodies, pairs = state.bodies, state.pairs
        self.first = np.array([pair.first for pair in pairs], dtype=np.int64)
        self.second = np.array([pair.second for pair in pairs], dtype=np.int64)
        stiffer_second = np.array(
            [bodies[p.second].p_wave_modulus > bodies[p.first].p_wave_modulus for p in pairs], dtype=bool
        )
        averaged = self.options.normal == "averaged"
        self.weight_first = np.where(averaged | ~stiffer_second, 1.0, 0.0)
        self.weight_second = np.where(averaged | stiffer_second, 1.0, 0.0)

    def new_rows(self, own: dict[str, int]) -> ContactRows:
        """Rows of two entries, without a couple: both sides are at one place."""
        return ContactRows(self.state.grid.dim, couples=False, own=own)

    def _fit(self, grid: Grid) -> None:
        """Fit the nodal arrays to the windows whenever these were laid anew."""
        if self.frame == grid.frame:
            return
        self.frame = grid.frame
        empty = np.zeros((0, grid.dim))
        self.gradient: FloatArray = (
            np.zeros_like(grid.momentum) if self.options.normal != "specified" else empty
        )
        self.mean: FloatArray = np.zeros_like(grid.momentum) if self.by_position else empty
        for name, array in (("volume_gradient", self.gradient), ("mean_position", self.mean)):
            if len(array):
                self.state.arrays[f"{self.owner}/{name}"] = array

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """Find the shared nodes, project what normals and gaps are made of, and write the rows."""
        self._fit(grid)
        found = self._find(grid)
        rows.count = 0
        if found == 0:
            return
        if len(self.gradient):
            project_volume_gradient(
                phi.row, phi.nodes, phi.gradient, particles.volume, self.gradient, grid.spacing
            )
        if len(self.mean):
            project_position(
                phi.row, phi.nodes, phi.weight, particles.mass, particles.position, grid.mass, self.mean, grid.spacing
            )  # fmt: skip
        if len(rows.pair) < found:
            rows.make_room(2 * found, 4 * found)
        of_pair, node_a, node_b = self.shared
        rows.count = write_rows(
            found, of_pair, node_a, node_b, self.first, grid.window_lower, grid.window_shape, grid.offset, grid.nodes,
            self.weight_first, self.weight_second, self.given, self.gradient, self.mean, self.cut_off, self.least_mass,
            grid.mass, grid.start_velocity, self.state.dt,
            rows.pair, rows.identity, rows.sign, rows.gap, rows.area, rows.whole, rows.normal, rows.motion,
            rows.start, rows.dof, rows.weight, grid.spacing,
        )  # fmt: skip

    def _find(self, grid: Grid) -> int:
        where = (self.first, self.second, grid.window_lower, grid.window_shape, grid.offset, grid.mass)
        found = find_shared_nodes(*where, *self.shared)
        if found > self.shared.shape[1]:
            self.shared = np.zeros((3, 2 * found), dtype=np.int64)
            find_shared_nodes(*where, *self.shared)
        return found
