"""Newton 1.8: a point on the face of an empty cell gives a motion that is not finite.

    pip install newton; python newton_face.py

takes one step of three points in free fall, of which one lies on the face between two cells or beside it,
and prints their velocities. The cell beyond the face is taken for one with points, and its far nodes have no
mass. Found on the CPU, with a dense grid; a single point on a face ends with ZeroDivisionError.

    second point at 0.40 m, on the face    nan
    second point at 0.41 m                 -0.0208 m/s, as in free fall
"""

import newton
import warp as wp
from newton.solvers import SolverImplicitMPM

CELL, STEP = 0.4, 1.0 / 480.0


def run(x):
    """Print the velocities after a step with the second point at x [m]."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
    SolverImplicitMPM.register_custom_attributes(builder)
    given = {"young_modulus": 1e6, "poisson_ratio": 0.3, "yield_stress": 1e15}
    places = [(0.1, 0.1, 0.1), (x, 0.1, 0.1), (0.9, 0.9, 0.9)]
    builder.add_particles(
        pos=[wp.vec3(*place) for place in places],
        vel=[wp.vec3(0.0)] * 3,
        mass=[8.0] * 3,
        radius=[0.1] * 3,
        custom_attributes={f"mpm:{name}": [value] * 3 for name, value in given.items()},
    )
    model = builder.finalize(device="cpu")
    model.set_gravity((0.0, 0.0, -10.0))
    config = SolverImplicitMPM.Config()
    config.grid_type, config.air_drag, config.voxel_size = "dense", 0.0, CELL
    solver, now, then = SolverImplicitMPM(model, config=config), model.state(), model.state()
    solver.step(now, then, None, None, STEP)
    print(f"second point at {x:.2f} m:", then.particle_qd.numpy()[:, 2])


wp.config.quiet = True
for place in (0.4, 0.41):
    run(place)
