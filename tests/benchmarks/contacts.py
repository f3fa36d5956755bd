"""What contact costs: a step of bodies as they touch, over one in which they share a velocity field.

    python tests/benchmarks/contacts.py [--shapes linear,gimp,bspline,cpdi,cpdi2] [--repeats 15]
    python tests/benchmarks/contacts.py --sphere 0.2 --shapes cpdi [--repeats 15] [--radius 1.0]

The bodies are the colliding rings, or a sphere that slips down a plane, with cells of the size given [m].
``separate`` has a field for each body, with its rotation corrected, and no contact: what is beyond it is
contact's. Samples of all methods alternate; a figure is the sum of a method's samples over that of ``none``,
since CPU time counts in ticks. Surfaces that only the gap is measured with do not count."""

import argparse
import tomllib
from importlib.resources import files

from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import STEP_STAGES

METHODS = ("none", "separate", "bardenhagen", "penalty")
#: Steps after which the rings touch, those after which the sphere presses on the plane, and steps of a
#: sample: of the sphere with all that is not done in every step.
RINGS_BEFORE, SPHERE_BEFORE, RINGS_SAMPLE, SPHERE_SAMPLE = 270, 60, 20, 40
#: Of the sphere, about that in the middle of its way [m/s].
SPEED = 3.0


def sphere(cell_size, radius):
    """The sphere with slip, on its way, and without the ledger of its energies, which has a cost of its
    own.
    """
    text = files("mpmfw").joinpath("scenes/rolling-sphere-slip.toml").read_text(encoding="utf-8")
    scene = tomllib.loads(text)
    del scene["settle"]
    scene["output"]["ledger"] = False
    scene["grid"]["cell_size"] = cell_size
    scene["contact"]["penalty"] = {"search_radius": radius}
    scene["bodies"]["sphere"]["velocity"] = [SPEED, 0.0, 0.0]
    return scene


def spent(sim):
    """CPU time of the steps so far, without the gap's diagnostic and output [s]."""
    sim.clock.flush()
    return sum(sim.clock.cpu[stage] for stage in STEP_STAGES)


def measure(scene, before, sample, shape, repeats):
    """Number of points, and mean CPU time of a step by method, over the points [ns]."""
    sims = {method: Simulation(scene, contact=method, shape=shape) for method in METHODS}
    for sim in sims.values():
        sim.advance(before)
    mean = dict.fromkeys(METHODS, 0.0)
    points = sims["none"].state.particles.count
    for _ in range(repeats):
        for method, sim in sims.items():
            begin = spent(sim)
            sim.advance(sample)
            mean[method] += (spent(sim) - begin) / repeats / sample / points * 1e9
    return points, mean


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--shapes", default="linear,gimp,bspline,cpdi,cpdi2")
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument(
        "--sphere", type=float, metavar="CELL_SIZE", help="the sphere with such cells [m], and not the rings"
    )
    parser.add_argument("--radius", type=float, default=1.0, help="of the search about the sphere [cells]")
    asked = parser.parse_args()
    scene, before, sample = "colliding-rings", RINGS_BEFORE, RINGS_SAMPLE
    if asked.sphere is not None:
        scene, before, sample = sphere(asked.sphere, asked.radius), SPHERE_BEFORE, SPHERE_SAMPLE
    print(f"shape     points  none [ns]  {'  '.join(f'{method:>11}' for method in METHODS[1:])}")
    for shape in asked.shapes.split(","):
        points, times = measure(scene, before, sample, shape, asked.repeats)
        ratios = "  ".join(f"{times[method] / times['none']:11.3f}" for method in METHODS[1:])
        print(f"{shape:8} {points:7}  {times['none']:9.1f}  {ratios}", flush=True)
