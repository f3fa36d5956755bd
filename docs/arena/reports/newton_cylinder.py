"""Newton 1.8: contact at nodes hardly turns a cylinder that slides down a plane; contact at points does.

    pip install newton; python newton_cylinder.py

runs an elastic cylinder on a rigid plane, with friction 0.286 at 60° (it slips) and 0.495 at 45° (it does
not), and prints displacement and spin over those of a rigid cylinder. Drag of air is off and the grid is
dense. Found on the CPU:

    basis   friction   displacement   spin
    S2      0.286      1.001          0.001
    pic27   0.286      1.007          0.689
    S2      0.495      0.763          0.072
    pic27   0.495      0.868          0.913
"""

import math

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverImplicitMPM

RADIUS, WIDTH, CELL, STEP, G = 1.6, 1.6, 0.8, 1.0 / 480.0, 10.0


def points():
    """Return positions and volumes of points in rings, whose outline is round."""
    size, found = 0.5 * CELL, []
    for radius in np.arange(RADIUS - 0.5 * size, 0.0, -size):
        count = max(1, round(2.0 * math.pi * radius / size))
        for angle in 2.0 * math.pi * (np.arange(count) + 0.5) / count:
            for y in np.arange(0.5 * size, WIDTH, size):
                place = (radius * math.cos(angle), y, RADIUS + radius * math.sin(angle))
                found.append((*place, 2.0 * math.pi * radius * size**2 / count))
    return np.array(found)[:, :3], np.array(found)[:, 3]


def run(basis, friction, degrees):
    """Print what a run has over the closed form, after 10 m of it."""
    place, volume = points()
    count, tilt = len(volume), math.radians(degrees)
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
    SolverImplicitMPM.register_custom_attributes(builder)
    given = {"young_modulus": 7.714e6, "poisson_ratio": 0.2857, "friction": 0.0, "yield_stress": 1e15}
    builder.add_particles(
        pos=[wp.vec3(*each) for each in place.tolist()],
        vel=[wp.vec3(0.0)] * count,
        mass=(1000.0 * volume).tolist(),
        radius=(0.5 * np.cbrt(volume)).tolist(),
        custom_attributes={f"mpm:{name}": [value] * count for name, value in given.items()}
        | {"mpm:tensile_yield_ratio": [1.0] * count},
    )
    builder.add_ground_plane(cfg=newton.ModelBuilder.ShapeConfig(mu=friction))
    model = builder.finalize(device="cpu")
    model.set_gravity((G * math.sin(tilt), 0.0, -G * math.cos(tilt)))
    config = SolverImplicitMPM.Config()
    config.grid_type, config.air_drag, config.voxel_size, config.collider_basis = "dense", 0.0, CELL, basis
    solver, now, then = SolverImplicitMPM(model, config=config), model.state(), model.state()
    slips = math.tan(tilt) > 3.0 * friction
    push = G * (math.sin(tilt) - friction * math.cos(tilt)) if slips else 2.0 / 3.0 * G * math.sin(tilt)
    turn = 2.0 * friction * G * math.cos(tilt) / RADIUS if slips else push / RADIUS
    steps = round(math.sqrt(20.0 / push) / STEP)
    for _ in range(steps):
        solver.step(now, then, None, None, STEP)
        now, then = then, now
    x, v = (each.numpy().astype(float) for each in (now.particle_q, now.particle_qd))
    time, r, u = steps * STEP, x - x.mean(axis=0), v - v.mean(axis=0)
    spin = (r[:, 2] @ u[:, 0] - r[:, 0] @ u[:, 2]) / (r[:, ::2] ** 2).sum()
    moved = x[:, 0].mean() - place[:, 0].mean()
    print(
        f"{basis:8}{friction:<11}{moved / (0.5 * push * time**2):<15.3f}{spin / (turn * time):.3f}",
        flush=True,
    )


for friction, degrees in ((0.286, 60.0), (0.495, 45.0)):
    for basis in ("S2", "pic27"):
        run(basis, friction, degrees)
