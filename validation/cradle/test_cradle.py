"""A rigid disc runs into a row of rigid discs: momentum, energy and velocities of plastic impacts."""
# cost: 60

import numpy as np
from common import disc, rectangle, scene

from mpmfw.validation import Place, Runs, methods

RADIUS, SPEED = 0.25, 1.0


def row(count, cell):
    """Return a row of ``count`` discs of 1, 2, 3, … times the density, and a block far away."""
    rubber = {"model": "neo_hookean", "density": 1e3, "bulk_modulus": 1e6, "shear_modulus": 5e5}
    bodies = {"block": rectangle(0.0, -1.2, 0.4, -0.8)}
    for k in range(count):
        moving = {"rigid": {"density": 1000.0 * (k + 1)}, "velocity": [0.0 if k else SPEED, 0.0]}
        bodies[f"disc{k}"] = disc(0.3 + 0.52 * k, 0.3, RADIUS, segment=0.01, **moving)
    more = {"contact": {"method": "lcp"}, "output": {"particles": False}}
    return scene(cell, [-0.4, -1.6], [3.2, 1.2], 0.02 * count + 0.4, 0.02, rubber, bodies, **more)


cradle = Runs(
    "cradle",
    row,
    methods(["lcp"], bound=True) + methods(["impulse"], when="full"),
    [
        Place(f"{count} discs, h = {cell:g} m", make={"count": count, "cell": cell})
        for count, cell in ((2, 0.1), (4, 0.1), (4, 0.05))
    ],
)


def errors(tree):
    """Return errors of the sum of momenta, of the energy that is left, and the largest of a velocity."""
    series = tree["series"].to_dataset().isel(body=slice(1, None))
    momentum, energy = series["linear_momentum"].sel(axis="x").values, series["kinetic_energy"].values
    mass = momentum[0, 0] / SPEED * np.arange(1, momentum.shape[1] + 1)
    total = mass[0] * SPEED
    velocity = momentum[-1] / mass * mass.sum() / total - 1.0
    return {
        "momentum": np.abs(momentum.sum(axis=1) / total - 1.0).max(),
        "energy": 100.0 * (energy[-1].sum() / energy[0].sum() * mass.sum() / mass[0] - 1.0),
        "velocity": 100.0 * velocity[np.abs(velocity).argmax()],
    }


@cradle
def test_cradle(run):
    run.gates(
        errors,
        ("sum of momenta, largest change, {at}", "momentum", 0.0, 1e-12),
        ("energy that is left, error, {at}", "energy", 0.0, 1.0, "%"),
        ("velocity, largest error of a disc, {at}", "velocity", 0.0, 2.0, "%"),
    )
