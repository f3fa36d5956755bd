"""Reference steps, each written out for one kind of scene: the same kernels and the same contact, called
directly.

No hook, no plan, no clock, no structure for what the scene does not have. They read and write the arrays of a
simulation in place, so that both run on the very same memory.
"""

from mpmfw.effects.surface import move_points, weigh_plain
from mpmfw.kernels import particle_grid
from mpmfw.kernels.stencil import fill_linear
from mpmfw_material.neo_hookean import neo_hookean_split
from mpmfw_shape.cpdi import fill_cpdi


class OneBody:
    """CPDI, affine FLIP, neo-Hookean, update stress last; one body, no loads."""

    def __init__(self, simulation):
        self.p, self.g = simulation.state.particles, simulation.state.grid
        self.half_edges, self.phi = simulation.shape.half_edges, simulation.shape.table
        body = simulation.state.bodies[0]
        self.bulk, self.shear = body.bulk_modulus, body.shear_modulus
        self.limit = self.g.cell_size / max(body.wave_speed for body in simulation.state.bodies)
        self.safety = simulation.scene.time.safety

    def step(self):
        """One step of the stable length."""
        dt = self.safety * self.limit
        self.interpolate()
        self.project()
        self.move(dt)

    def interpolate(self):
        """φ_ip and ∇φ_ip."""
        p, g, phi = self.p, self.g, self.phi
        points = (p.first, p.position, p.deformation_gradient, self.half_edges)
        outside = fill_cpdi(*points, g, 0, phi.room, phi, g.spacing)
        assert outside < 0

    def project(self):
        """m_i, (m v)_i and v_i⁰, and the internal forces."""
        p, g, phi = self.p, self.g, self.phi
        g.mass.fill(0.0)
        g.momentum.fill(0.0)
        g.force.fill(0.0)
        particle_grid.project_with_force(p, p.affine, None, phi, g, g.spacing)
        particle_grid.velocity_of_momentum(g.mass, g.momentum, g.start_velocity, g.spacing)

    def move(self, dt):
        """Everything after the forces."""
        p, g, phi = self.p, self.g, self.phi
        particle_grid.integrate_momentum(g.mass, g.momentum, g.force, dt, g.spacing)
        particle_grid.velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)
        particle_grid.gather(p, p.affine, phi, g, True, 1.0, dt, g.spacing)
        particle_grid.transport_affine(p, p.affine, dt, g.spacing)
        self.advect(dt)
        inverted = particle_grid.update_deformation(p, dt, g.spacing)
        assert inverted < 0
        neo_hookean_split(0, p.count, p.deformation_gradient, p.stress, self.bulk, self.shear, g.spacing)

    def advect(self, dt):
        """No surface."""


class TwoApart(OneBody):
    """Two bodies of one material with outlines, whose boxes are compared and found apart."""

    def __init__(self, simulation):
        super().__init__(simulation)
        self.s, self.contact = simulation.state.surface, simulation.contact
        surface = simulation.shape._surface
        self.n_s, self.cell_mass = surface, simulation.state.arrays["surface/cell_mass"]
        self.state, self.travel = simulation.state, simulation.manager.get_plugin("surface_travel")

    def interpolate(self):
        """φ_ip, ∇φ_ip and N_i(x_s)."""
        super().interpolate()
        g, s, table = self.g, self.s, self.n_s
        outside = fill_linear(s.position, s.first, g, table, g.spacing)
        assert outside < 0

    def project(self):
        """As for one body; then the surface's weights."""
        super().project()
        weigh_plain(self.n_s.row, self.n_s.nodes, self.n_s.weight, self.cell_mass, self.g.mass)

    def step(self):
        """One step of the stable length; springs that are near limit it."""
        self.interpolate()
        self.project()
        self.contact.detect(self.g, self.phi, self.p)
        limits = [self.contact.stable_timestep(), self.travel.stable_timestep(self.state)]
        dt = self.safety * min([self.limit, *(limit[0] for limit in limits if limit is not None)])
        self.state.dt = dt
        self.contact.add_nodal_force(self.g, dt)
        self.move(dt)

    def advect(self, dt):
        """Outlines move with the grid, and contacts become history."""
        s, t = self.s, self.n_s
        self.contact.advect(self.g, dt)
        move_points(t, self.g.velocity, s.position, s.displacement, dt, self.g.spacing)
