"""What the faults are planted in: quadratic B-splines in plain NumPy, without a fault."""

import itertools

import numpy as np

from mpmfw.api import OutsideGrid, ShapeFunction, Stencil, hookimpl

WIDTH = 3


class Sound(ShapeFunction):
    """Tensor products of quadratic B-splines; every piece is a method that a fault can replace."""

    name = "sound"

    @hookimpl
    def particle_reach(self, particles):
        """Points have no extent."""
        return np.zeros_like(particles.position)

    @hookimpl
    def interpolate(self, particles, grid):
        """φ_ip and ∇φ_ip."""
        return self.table(particles.position, particles.first, grid)

    @hookimpl
    def interpolate_surface(self, position, first, grid):
        """The same basis, without gradients."""
        table = self.table(position, first, grid)
        return table.replace(gradient=np.zeros((0, grid.dim)))

    def base(self, xi):
        """First node of the support, of the position ``xi`` [cells] in the window."""
        return np.floor(xi - 0.5)

    def weights(self, t):
        """The three splines at ``t`` cells after the first node, (…, 3)."""
        return np.stack([0.5 * (1.5 - t) ** 2, 0.75 - (t - 1.0) ** 2, 0.5 * (t - 0.5) ** 2], axis=-1)

    def slopes(self, t):
        """Their derivatives [1/cell]."""
        return np.stack([t - 1.5, -2.0 * (t - 1.0), t - 0.5], axis=-1)

    def inside(self, base, shape):
        """Return True for each point whose nodes lie in its window, (n,)."""
        return ((base >= 0.0) & (base + WIDTH <= shape)).all(axis=1)

    def reported(self, index):
        """The index that ``OutsideGrid`` carries."""
        return index

    def offset(self, grid, field):
        """First node of each point's velocity field."""
        return grid.offset[field]

    def table(self, position, first, grid):
        """Weights and gradients at points (n, dim) of velocity fields ``first``."""
        n, dim, h = len(position), grid.dim, grid.cell_size
        field = np.repeat(np.arange(grid.n_fields), np.diff(first))
        shape = grid.window_shape[field]
        xi = (position - (grid.lower + h * grid.window_lower[field])) / h
        base = self.base(xi)
        inside = self.inside(base, shape)
        if not inside.all():
            raise OutsideGrid(self.reported(int(np.argmin(inside))))
        weight, slope = self.weights(xi - base), self.slopes(xi - base) / h
        start = np.clip(np.nan_to_num(base), -9, 999).astype(np.int64)
        nodes = np.zeros((n, WIDTH**dim), dtype=np.int64)
        phi, gradient = np.ones((n, WIDTH**dim)), np.ones((n, WIDTH**dim, dim))
        for k, digits in enumerate(itertools.product(range(WIDTH), repeat=dim)):
            for d, digit in enumerate(digits):
                nodes[:, k] = nodes[:, k] * shape[:, d] + start[:, d] + digit
                phi[:, k] *= weight[:, d, digit]
                for e in range(dim):
                    gradient[:, k, e] *= slope[:, d, digit] if d == e else weight[:, d, digit]
        nodes += self.offset(grid, field)[:, None]
        return Stencil(
            row=np.arange(n + 1, dtype=np.int64) * WIDTH**dim,
            nodes=nodes.ravel().astype(np.int32),
            weight=phi.ravel(),
            gradient=gradient.reshape(-1, dim),
        )
