"""Reference steps, each written out for one kind of scene: the same kernels, called directly.

No hook, no plan, no clock, no structure for what the scene does not have. They read and write the arrays of a
simulation in place, so that both run on the very same memory.
"""

from __future__ import annotations

import math
from typing import Any

from mpmfw_contact.penalty.losses import add_losses
from mpmfw_contact.penalty.pair_force import contact_forces
from mpmfw_contact.penalty.stability import contact_frequency, map_to_grid, spring_stiffness
from mpmfw_contact.penalty.strategy import THIN
from mpmfw_contact.penalty.tracking import find_crossings, keep_inside
from mpmfw_contact.penalty.travel import fewest_steps

from mpmfw.effects.surface import move_points, weigh_plain
from mpmfw.kernels import gather, nodal, projection
from mpmfw.kernels.polyline import bounding_boxes
from mpmfw.kernels.stencil import fill_linear
from mpmfw.simulation import Simulation
from mpmfw_contact.penalty import search
from mpmfw_material.neo_hookean import neo_hookean_split
from mpmfw_shape.cpdi import fill_cpdi


class OneBody:
    """CPDI, affine FLIP, neo-Hookean, update stress last; one body, no loads."""

    def __init__(self, simulation: Simulation) -> None:
        self.p, self.g = simulation.state.particles, simulation.state.grid
        self.half_edges, self.phi = simulation.shape.half_edges, simulation.shape.room
        body = simulation.state.bodies[0]
        self.bulk, self.shear = body.bulk_modulus, body.shear_modulus
        self.limit = self.g.cell_size / max(body.wave_speed for body in simulation.state.bodies)
        self.safety = simulation.scene.time.safety

    def step(self) -> None:
        """One step of the stable length."""
        dt = self.safety * self.limit
        self.interpolate()
        self.project()
        projection.add_internal_force(
            self.phi.row,
            self.phi.nodes,
            self.phi.gradient,
            self.p.volume,
            self.p.stress,
            self.g.force,
            self.g.spacing,
        )
        self.move(dt)

    def interpolate(self) -> None:
        """φ_ip and ∇φ_ip."""
        p, g, phi = self.p, self.g, self.phi
        outside = fill_cpdi(
            p.position, p.deformation_gradient, self.half_edges, p.first, g.lower, g.window_lower, g.window_shape,
            g.offset, phi.row, phi.nodes, phi.weight, phi.gradient, g.spacing,
        )  # fmt: skip
        assert outside < 0

    def project(self) -> None:
        """m_i, (m v)_i and v_i⁰."""
        p, g, phi = self.p, self.g, self.phi
        g.mass.fill(0.0)
        g.momentum.fill(0.0)
        g.force.fill(0.0)
        projection.project_mass_momentum(
            phi.row, phi.nodes, phi.weight, p.mass, p.velocity, p.position, p.affine, g.position, g.mass, g.momentum,
            g.spacing,
        )  # fmt: skip
        nodal.velocity_of_momentum(g.mass, g.momentum, g.start_velocity, g.spacing)

    def move(self, dt: float) -> None:
        """Everything after the forces."""
        p, g, phi = self.p, self.g, self.phi
        nodal.integrate_momentum(g.mass, g.momentum, g.force, dt, g.spacing)
        nodal.velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)
        gather.gather(
            phi.row, phi.nodes, phi.weight, phi.gradient, g.position, g.velocity, g.start_velocity, p.velocity,
            p.position, p.velocity_gradient, p.affine, True, 1.0, dt, g.spacing,
        )  # fmt: skip
        gather.transport_affine(p.affine, dt, g.spacing)
        self.advect(dt)
        inverted = gather.update_deformation(
            p.velocity_gradient, p.deformation_gradient, p.initial_volume, p.volume, dt, g.spacing
        )
        assert inverted < 0
        neo_hookean_split(0, p.count, p.deformation_gradient, p.stress, self.bulk, self.shear, g.spacing)

    def advect(self, dt: float) -> None:
        """No surface."""


class TwoApart(OneBody):
    """Two bodies of one material with outlines, whose boxes are compared and found apart."""

    def __init__(self, simulation: Simulation) -> None:
        super().__init__(simulation)
        self.s, self.contact = simulation.state.surface, simulation.contact
        self.n = len(simulation.state.bodies)
        surface: Any = simulation.shape._surface
        self.n_s, self.cell_mass = surface, simulation.state.arrays["surface/cell_mass"]
        self.state, self.travel = simulation.state, simulation.manager.get_plugin("penalty_travel")

    def interpolate(self) -> None:
        """φ_ip, ∇φ_ip and N_i(x_s)."""
        super().interpolate()
        g, s, table = self.g, self.s, self.n_s
        outside = fill_linear(
            s.position, s.first, g.lower, g.window_lower, g.window_shape, g.offset, table.nodes, table.weight,
            table.gradient, g.spacing,
        )  # fmt: skip
        assert outside < 0

    def project(self) -> None:
        """As for one body; then the surface's weights."""
        super().project()
        weigh_plain(self.n_s.row, self.n_s.nodes, self.n_s.weight, self.cell_mass, self.g.mass)

    def step(self) -> None:
        """One step of the stable length."""
        dt = self.safety * min(self.limit, self.time_to_travel())
        self.interpolate()
        self.project()
        projection.add_internal_force(
            self.phi.row,
            self.phi.nodes,
            self.phi.gradient,
            self.p.volume,
            self.p.stress,
            self.g.force,
            self.g.spacing,
        )
        assert not self.near()
        self.move(dt)

    def time_to_travel(self) -> float:
        """Time in which bodies come nearer by their distance and half of the search radius."""
        t, s = self.travel, self.s
        lower, upper, slowest, fastest = t.boxes
        bounding_boxes(s.body_first, s.position, lower, upper)
        bounding_boxes(s.body_first, s.displacement, slowest, fastest)
        steps: float = fewest_steps(t.first, t.second, lower, upper, slowest, fastest, t.band)
        return steps * self.state.dt

    def near(self) -> bool:
        """Whether the boxes are within the reach of the search."""
        c, boxes = self.contact, self.contact.grid
        bounding_boxes(self.s.body_first, self.s.position, boxes.box_lower, boxes.box_upper)
        near: bool = search.boxes_touch(
            c.laws.first, c.laws.second, boxes.box_lower, boxes.box_upper, c.radius
        )
        return near

    def advect(self, dt: float) -> None:
        """Outlines move with the grid."""
        s, t = self.s, self.n_s
        move_points(t.row, t.nodes, t.weight, self.g.velocity, s.position, s.displacement, dt)


class Touching(TwoApart):
    """Two bodies in contact by springs; with and without friction differ in the coefficient that the kernel reads."""

    def step(self) -> None:
        """One step of the stable length, which its springs limit; they are found first, and become the history last."""
        c = self.contact
        self.interpolate()
        self.project()
        assert self.near()
        self.find()
        self.stiffen()
        springs = 2.0 / math.sqrt(c.bulk_frequency**2 + c.omega_squared)
        dt = self.safety * min(self.limit, springs, self.time_to_travel())
        projection.add_internal_force(
            self.phi.row,
            self.phi.nodes,
            self.phi.gradient,
            self.p.volume,
            self.p.stress,
            self.g.force,
            self.g.spacing,
        )
        self.press(dt)
        map_to_grid(self.n_s.row, self.n_s.nodes, self.n_s.weight, c.force, self.g.force)
        self.move(dt)
        c.candidates.swap()

    def find(self) -> None:
        """Candidate segments of every surface node."""
        s, c, k, g = self.s, self.contact, self.contact.candidates, self.contact.grid
        lower, spacing, nodes = self.g.lower, self.g.spacing, self.g.nodes
        g.stamp += 1
        search.mark_shared_nodes(
            g.stamp, self.n, s.position, s.next, s.body, lower, spacing, nodes, g.owner, g.shared
        )  # fmt: skip
        entries = search.list_segments(
            g.stamp, s.position, s.next, lower, spacing, nodes, g.shared, g.head, g.head_stamp, g.link, g.link_segment
        )  # fmt: skip
        assert entries <= len(g.link)
        search.find_pairs(
            g.stamp, c.radius, False, s.position, s.next, s.previous, s.body, c.laws.rank, lower, spacing, nodes,
            g.shared, g.head, g.head_stamp, g.link, g.link_segment, k.master, k.segment, k.coordinate, k.gap, k.normal,
        )  # fmt: skip
        found = k.master, k.segment, k.coordinate, k.gap, k.normal
        keep_inside(
            s.position, s.next, s.previous, s.body, s.body_first, k.old_master, k.old_segment, *found, c.through
        )  # fmt: skip
        find_crossings(
            THIN * c.radius, s.position, s.displacement, s.next, s.previous, s.body_first, c.laws.first, c.laws.second,
            c.laws.rank, g.box_lower, g.box_upper, *found,
        )  # fmt: skip

    def stiffen(self) -> None:
        """Springs and their frequency."""
        s, c, k, t = self.s, self.contact, self.contact.candidates, self.n_s
        spring_stiffness(
            k.slots, k.segment, k.master, s.body, c.node_factor, c.laws.modulus, s.position, s.next, s.previous,
            s.displacement, k.coordinate, k.normal, k.gap, c.cell_size, k.old_master,
            k.old_share, k.old_rest, False, k.share, k.rest, k.stiffness,
        )  # fmt: skip
        c.omega_squared = c.stiffest * contact_frequency(
            k.slots, k.segment, k.coordinate, k.gap, k.rest, k.stiffness, c.linear_to, s.next, t.row, t.nodes, t.weight,
            self.g.mass, c.node_stiffness,
        )  # fmt: skip

    def press(self, dt: float) -> None:
        """The forces on the surface nodes."""
        s, c, k, r = self.s, self.contact, self.contact.candidates, self.contact.records
        c.force.fill(0.0)
        rubbed = r.frictional_work.copy()
        contact_forces(
            k.slots, k.master, k.segment, k.coordinate, k.gap, k.rest, k.normal, k.old_master, k.tangential,
            k.old_tangential,
            s.body, c.laws.pair_of, c.laws.first, s.position, s.displacement, s.next, s.previous, k.stiffness,
            k.damping, c.laws.friction, 1.0, False, c.linear_to, dt, c.scratch, c.force, r.impulse, r.frictional_work,
            r.damping_work, r.energy, r.count,
        )  # fmt: skip
        add_losses(
            s.body, c.laws.pair_of, s.position, s.displacement, s.next, s.previous, k.master, k.gap, k.rest, k.stiffness,
            k.tangential, k.old_master, k.old_segment, k.old_coordinate, k.old_gap, k.old_normal, k.old_rest,
            k.old_stiffness, k.old_tangential, 1.0, c.linear_to, c.rows, c.spring_work,
        )  # fmt: skip
        c.spring_work -= r.frictional_work - rubbed
