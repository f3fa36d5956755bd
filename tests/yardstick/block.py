"""One neo-Hookean body, stepped by the real stepper and plug-ins: a synthetic block, or the points of the
colliding rings.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.geometry.layout import Layout, layout_of_boxes
from mpmfw.plugin.discovery import load
from mpmfw.plugin.hooks import BoundHooks, make_manager
from mpmfw.plugin.setup import Setup
from mpmfw.runs.bodies import lay_out
from mpmfw.scene.loading import load_scene
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Particles, State
from mpmfw.state.windows import MARGIN, allocate_nodes, make_grid
from mpmfw.step.schemes import usl
from mpmfw.step.timestep import Clock
from mpmfw.step.transfer import Transfer, make_transfer

#: All is of order one: h = 1 m, density 1 kg/m^3, moduli [Pa]; the step [s] is well below its limit.
CELL_SIZE, BULK, SHEAR, DT = 1.0, 1.0, 0.5, 0.1
#: Material points along each edge of a cell.
PER_CELL = 2
#: Standard deviation of the points' velocities [m/s]: the block jitters and stays where it is.
JITTER = 1e-4


@dataclass
class Block:
    """A block ready to be stepped."""

    state: State
    hook: Any
    transfer: Transfer
    clock: Clock
    half_edges: FloatArray  #: (n, dim, dim) [m]

    def step(self) -> None:
        """One step of update stress last."""
        usl(self.state, self.hook, self.transfer, self.clock, lambda: DT)


def make_block(shape: str, count: int, dim: int = 2) -> Block:
    """A cube of about ``count`` points at slightly irregular positions, in the corner of a grid that fits
    it.
    """
    cells = max(1, round((count / PER_CELL**dim) ** (1.0 / dim)))
    rng = np.random.default_rng(0)
    axis = MARGIN + (np.arange(PER_CELL * cells) + 0.5) / PER_CELL
    position = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    position += rng.uniform(-0.1, 0.1, position.shape)
    layout = layout_of_boxes(position, np.full(position.shape, CELL_SIZE / PER_CELL))
    return _block_of(layout, shape, cells, rng)


def make_rings(shape: str) -> Block:
    """The points of the scene ``colliding-rings``, lengths in cells, as one block in the corner of a square
    grid.
    """
    scene = load_scene("colliding-rings")
    layouts, h = lay_out(scene), scene.grid.cell_size
    corners = np.concatenate([layout.corners for layout in layouts if layout.corners is not None]) / h
    shift = MARGIN - np.floor(
        corners.min(axis=(0, 1))
    )  # whole cells: the points lie between grid lines as in the scene
    layout = Layout(
        position=np.concatenate([layout.position for layout in layouts]) / h + shift,
        volume=np.concatenate([layout.volume for layout in layouts]) / h**2,
        half_edges=np.concatenate([layout.half_edges for layout in layouts]) / h,
        corners=corners + shift,
    )
    cells = math.ceil((corners + shift).max()) - MARGIN
    return _block_of(layout, shape, cells, np.random.default_rng(0))


def _block_of(layout: Layout, shape: str, cells: int, rng: np.random.Generator) -> Block:
    """A block of these points, on a grid of so many cells along each axis and a margin on both sides."""
    position = layout.position
    dim = position.shape[1]
    particles = _particles(layout, rng)
    grid = make_grid(CELL_SIZE, np.zeros(dim), np.full(dim, float(cells + 2 * MARGIN)), 1)
    body = Body(
        name="block",
        index=0,
        particles=slice(0, len(position)),
        field=0,
        density=1.0,
        bulk_modulus=BULK,
        shear_modulus=SHEAR,
        lower=tuple(position.min(axis=0)),
        upper=tuple(position.max(axis=0)),
        outlines=(),
    )
    state = State(particles=particles, grid=grid, bodies=(body,), pairs=())
    function = load("shape", shape)()
    material = load("material", "neo_hookean")(bulk_modulus=BULK, shear_modulus=SHEAR, energy="log")
    material.slices = (body.particles,)
    setup = Setup(
        state=state,
        layouts=(layout,),
        shape=shape,
        massless_boundary=function.massless_boundary,
        scheme="usl",
        transfer="aflip",
        flip=1.0,
        bulk_frequency=2.0 * body.wave_speed / CELL_SIZE,
        safety=0.5,
    )
    manager = make_manager()
    for plugin in (function, material):
        manager.register(plugin)
    manager.check_pending()
    manager.hook.setup(setup=setup)
    clock = Clock()
    hook: Any = BoundHooks(manager, clock)
    grid.window_shape[:] = grid.nodes  # the plain loop knows one cubic window
    allocate_nodes(grid)
    transfer = make_transfer("aflip", singular_spread=function.singular_spread)
    return Block(state, hook, transfer, clock, layout.half_edges)


def _particles(layout: Layout, rng: np.random.Generator) -> Particles:
    """Points of unit density that jitter and are slightly deformed."""
    position, volume = layout.position, layout.volume
    n, dim = position.shape
    tensor = (n, dim, dim)
    return Particles(
        position=position,
        velocity=JITTER * rng.normal(size=(n, dim)),
        mass=volume.copy(),
        initial_volume=volume,
        volume=volume.copy(),
        deformation_gradient=np.eye(dim) + rng.uniform(-1e-3, 1e-3, tensor),
        velocity_gradient=np.zeros(tensor),
        stress=np.zeros(tensor),
        affine=np.zeros(tensor),
        moment=None,
        first=np.array([0, n], dtype=np.int64),
    )
