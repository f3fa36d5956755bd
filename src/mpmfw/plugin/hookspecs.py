"""Hook specifications: every place in the algorithm where a plug-in may act.

Hooks are named by their place, not by a method. A plug-in takes other data from
:class:`mpmfw.api.types.Setup`, once. An implementation may leave out arguments that it does not use."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pluggy

from mpmfw.state.fields import AnyArray, Field, FloatArray, IntArray
from mpmfw.state.structs import Grid, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.plugin.setup import Setup

hookspec = pluggy.HookspecMarker("mpmfw")
hookimpl = pluggy.HookimplMarker("mpmfw")


class HookSpecs:
    """The hooks, in the order in which a run calls them."""

    @hookspec
    def declare_fields(self) -> list[Field]:
        """Once, before allocation: declare the arrays and series that the plug-in owns.

        Arrays are then allocated with :meth:`mpmfw.api.types.Setup.allocate`, and series filled by
        :meth:`diagnostics`. May change nothing.
        """
        raise NotImplementedError

    @hookspec
    def setup(self, setup: Setup) -> None:
        """Once, after the bodies are discretised: read facts of the scene, allocate declared arrays.

        May change the plug-in alone, and the material points' initial state.
        """

    @hookspec(firstresult=True)
    def particle_reach(self, particles: Particles) -> FloatArray:
        """When a window of the grid is laid: half the extent of every particle's domain, (n, dim) [m].

        Implemented by the shape function. May change nothing."""
        raise NotImplementedError

    @hookspec
    def add_pairs(self, state: State) -> None:
        """When bodies come near each other: ``state.pairs`` has more pairs, at its end.

        In a scene of many bodies a plug-in that implements it has pairs only as they come near, before
        anything can act between them, and lengthens its arrays of pairs
        (:meth:`mpmfw.api.types.State.lengthen`). Others have all pairs from the start. May change the
        plug-in's own arrays alone."""

    @hookspec(firstresult=True)
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """Step 1: φ_ip and ∇φ_ip of every material point. Implemented by the shape function.

        May change nothing but its own table. Raise :class:`mpmfw.api.OutsideGrid` if a support leaves its
        window; the core lays the window anew, or stops if the grid ends there.
        """
        raise NotImplementedError

    @hookspec(firstresult=True)
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """Step 1, after :meth:`interpolate`: N_i at points on the boundary.

        Implemented by the shape function. The basis matches the particles', Σ V ∇S = ∮ N n dS. Parameters:
        ``position`` (n, dim) [m]; ``first`` (n_fields + 1,), the points of velocity field f are
        ``first[f]:first[f + 1]``. May change nothing but its own table. Raise
        :class:`mpmfw.api.OutsideGrid` as :meth:`interpolate`.
        """
        raise NotImplementedError

    @hookspec
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """After step 2, before the length of the step is chosen: detect contacts.

        m_i and (m v)_i are on the grid. May change the plug-in's own arrays alone; a second call in the step
        finds the same.
        """

    @hookspec
    def after_momentum_projection(self, grid: Grid, phi: Stencil, particles: Particles, dt: float) -> None:
        """After step 2: m_i and (m v)_i of every field are complete. May change ``grid.momentum``."""

    @hookspec
    def add_nodal_force(self, grid: Grid, state: State, phi: Stencil, dt: float) -> None:
        """Step 3: f_ext and f_cont (eq. 12 of [H17]). May add to ``grid.force``."""

    @hookspec
    def after_momentum_update(self, grid: Grid, phi: Stencil, particles: Particles, dt: float) -> None:
        """After step 4: (m v)_i is integrated. May change ``grid.momentum``."""

    @hookspec
    def correct_inertia(self, grid: Grid, phi: Stencil, particles: Particles, dt: float) -> None:
        """After contact's corrections: correct the lumped inertia. May change ``grid.momentum``."""

    @hookspec
    def constrain_momentum(self, grid: Grid, time: float) -> None:
        """After all corrections of the momentum: boundary conditions, which act last.

        ``time`` [s] is the end of the step. MUSL and USF call it again for the velocity of the strain.
        May change ``grid.momentum``.
        """

    @hookspec
    def after_second_projection(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """MUSL alone: (m v)_i of the points' new velocity is complete. May change ``grid.momentum``."""

    @hookspec
    def advect(self, grid: Grid, dt: float) -> None:
        """Step 5: move what rides on ``grid.velocity``, such as surface nodes. May change that."""

    @hookspec
    def after_velocity_gradient(self, particles: Particles, grid: Grid, phi: Stencil, dt: float) -> None:
        """Before F of step 6: L_p of every point is complete.

        With MUSL and USF it is that of the second projection, or of the first. May change
        ``particles.velocity_gradient``, which is (n, 3, 3) of bodies of revolution.
        """

    @hookspec
    def update_particle_domains(self, particles: Particles, grid: Grid, dt: float) -> None:
        """Step 6: GIMP lengths or CPDI corners follow F. May change these."""

    @hookspec
    def update_stress(self, particles: Particles, dt: float) -> None:
        """Step 6: σ of the material's bodies from F. May change their ``particles.stress``.

        Of bodies of revolution F and σ are (n, 3, 3). A material that forgets its shape may also restart F at
        large strain, and must change V with it: V = det F V⁰."""

    @hookspec
    def end_step(self, state: State) -> None:
        """After the step: records and guards. May change the plug-in alone.

        A plug-in with an attribute ``running`` is called only while that is true."""

    @hookspec
    def stable_timestep(self, state: State) -> tuple[float, str] | None:
        """After :meth:`detect`: the largest stable step [s] and its owner, or None if nothing limits it now.

        The least of all answers holds. Of the time in which a wave passes a cell, whose owner begins with
        "bulk", the shape function's share is stable. Before the first :meth:`detect` contacts count as if
        they were there. May change nothing."""

    @hookspec
    def diagnostics(self, state: State, interval: float, points: bool) -> dict[str, AnyArray]:
        """At outputs only: values of the plug-in's declared series and output fields.

        ``interval`` [s] is the time since the last output (0 at the first). Without ``points`` fields of
        material points need no answer. May change nothing but accumulators that restart at outputs."""
        raise NotImplementedError

    @hookspec
    def concerns(self) -> list[str]:
        """After the last step: warnings for a reader of the results. May change nothing."""
        raise NotImplementedError
