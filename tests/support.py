"""Small factories of state, for tests of kernels and shape functions."""

import numpy as np

from mpmfw.api import Particles, Setup, State
from mpmfw.kernels import Struct, struct
from mpmfw.plugin.discovery import load
from mpmfw.state.windows import make_grid
from mpmfw_material._plastic import Flow


def make_test_grid(windows, *, cell_size, lower):
    """A grid with the given windows (background index of the first node, number of nodes), one per field."""
    dim = len(lower)
    extent = max(max(np.add(first, shape)) for first, shape in windows)
    grid = make_grid(cell_size, lower, lower + cell_size * extent, len(windows))
    positions = []
    for index, (first, shape) in enumerate(windows):
        grid.window_lower[index], grid.window_shape[index] = first, shape
        local = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), -1).reshape(-1, dim)
        positions.append(lower + cell_size * (np.array(first) + local))
    grid.offset[1:] = np.cumsum([len(nodes) for nodes in positions])
    grid.position = np.concatenate(positions)
    return grid


def make_particles(position, first=None, *, deformation_gradient=None, volume=0.25):
    """Points at rest at ``position``, (n, dim); ``first`` are the ranges of the velocity fields."""
    n, dim = position.shape
    eye = np.tile(np.eye(dim), (n, 1, 1))
    return Particles(
        position=np.array(position, dtype=float),
        velocity=np.zeros((n, dim)),
        mass=np.ones(n),
        initial_volume=np.full(n, volume),
        volume=np.full(n, volume),
        deformation_gradient=eye if deformation_gradient is None else deformation_gradient,
        velocity_gradient=np.zeros((n, dim, dim)),
        stress=np.zeros((n, dim, dim)),
        affine=None,
        moment=None,
        first=np.array([0, n] if first is None else first, dtype=np.int64),
    )


def as_points(**arrays) -> Struct:
    """Arrays of points, of the type that runs give to kernels: another one would be compiled anew."""
    return struct(**make_particles(np.zeros((0, 2))).members() | arrays)


def as_grid(**arrays) -> Struct:
    """Arrays of nodes, of the type that runs give to kernels."""
    return struct(**make_grid(1.0, np.zeros(2), np.ones(2), 1).members() | arrays)


def as_table(row, nodes, weight, gradient=None) -> Struct:
    """A table, of the type that runs give to kernels."""
    gradient = np.zeros((0, 2)) if gradient is None else gradient
    return struct(row=row, nodes=nodes, weight=weight, gradient=gradient)


#: Shape functions whose table comes from a fill kernel on points.
SHAPES = ("linear", "gimp", "bspline", "cpdi", "cubic_bspline", "ck")


def make_shape(name, particles, grid, *, half_edges=None):
    """The shape function ``name``, set up for ``particles``; CPDI domains are squares unless given."""
    setup = Setup(
        state=State(particles=particles, grid=grid, bodies=(), pairs=()),
        shape=name,
    )
    half = 0.5 * particles.initial_volume ** (1.0 / particles.dim)
    squares = half[:, None, None] * np.eye(particles.dim)
    vars(setup)["half_edges"] = squares if half_edges is None else half_edges
    shape = load("shape", name)()
    shape.setup(setup)
    return shape


class PlasticPoint:
    """One material point, deformed by hand; ``update(f, flow, stress, spacing)`` writes σ and what flows."""

    def __init__(self, update, dim=3):
        self.update, self.spacing = update, (1.0,) * dim
        self.flow = Flow(metric=np.eye(3)[None].copy(), strain=np.zeros(1), work=np.zeros(1))

    def stress(self, f):
        """σ at F, (dim, dim); the point keeps what has flowed."""
        dim = len(self.spacing)
        stress = np.empty((1, dim, dim))
        self.update(np.ascontiguousarray(f[None, :dim, :dim]), self.flow, stress, self.spacing)
        return stress[0]

    def tried(self, f):
        """σ at F without keeping anything."""
        arrays = self.flow.metric, self.flow.strain, self.flow.work
        before = [array.copy() for array in arrays]
        found = self.stress(f)
        for array, old in zip(arrays, before, strict=True):
            array[:] = old
        return found

    @property
    def strain(self):
        """Plastic strain."""
        return float(self.flow.strain[0])

    @property
    def work(self):
        """Work that is lost [J/m^3]."""
        return float(self.flow.work[0])
