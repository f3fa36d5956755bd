"""Write docs/guide/costs.md: predicted against measured cost of the shipped scenes: ``python docs/make_costs.py``.

Measures this machine's times per stage first, then runs every scene; takes about three minutes.
"""

from __future__ import annotations

import tempfile
import tracemalloc
import warnings
from pathlib import Path

import numpy as np

import mpmfw
from mpmfw import prediction
from mpmfw.cli.explain import named_arrays
from mpmfw.errors import ResultsWarning
from mpmfw.simulation import Simulation

PAGE = Path(__file__).with_name("guide") / "costs.md"
COMBINATIONS = [
    (scene, contact, shape)
    for scene in ("rolling-cylinder-slip", "rolling-cylinder-no-slip", "sliding-block", "colliding-rings")
    for contact, shape in (
        ("penalty", "cpdi"),
        ("penalty", "bspline"),
        ("bardenhagen", "gimp"),
        ("none", "linear"),
    )
]

HEAD = """\
# What a run will cost

<!-- Made by docs/make_costs.py, which runs all that it quotes. -->

`mpmfw explain SCENE` predicts steps, CPU time (with `--all` by stage) and the memory of all arrays before a run. A stage takes
a + b n seconds a step: a for the calls, b for each of its n entities, material points, or surface nodes for a contact that
works on outlines. The table of a and b that ships with mpmfw comes from two blocks that touch, at two sizes, for every
bundled shape function and contact strategy; `mpmfw explain SCENE --measure` takes one of your own machine and keeps
it. Steps are counted with the stable time step of the contacts that are detected at the start; where bodies do not touch
yet, with the one that contact takes for granted. A limit that changes during the run changes them, as where rings
touch for a part of it.
Settling and output come on top; `contact-stress` is settling alone and is not in the table. What gravity, sides and rotation
take is in no table: scenes of few points, in which calls are all the cost, take more than is predicted.

Prediction against measurement, with times per stage taken just before on the same machine (`python docs/make_costs.py`).
Memory is that of the arrays allocated while the simulation is built and takes a step, as NumPy reports it.

| scene | contact | shape | steps, predicted | run | CPU s, predicted | run | ratio | MB, predicted | allocated |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""


def allocated(scene: str, contact: str, shape: str) -> tuple[prediction.Prediction, float]:
    """The prediction, and what the arrays of the simulation that made it take [MB]."""
    tracemalloc.start()
    simulation = Simulation(scene, contact=contact, shape=shape)
    simulation.step()
    ours = tracemalloc.take_snapshot().filter_traces(
        [tracemalloc.DomainFilter(True, np.lib.tracemalloc_domain)]
    )
    tracemalloc.stop()
    fresh = Simulation(scene, contact=contact, shape=shape)
    found = prediction.predict(fresh, [array.nbytes for _, array in named_arrays(fresh.state)])
    return found, 1e-6 * sum(entry.size for entry in ours.statistics("filename"))


def row(scene: str, contact: str, shape: str) -> str:
    """Predict, run, and compare."""
    found, memory = allocated(scene, contact, shape)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)
        try:
            attributes = mpmfw.run(
                scene, contact=contact, shape=shape, set={"output.particles": False, "output.ledger": False}
            ).attrs
        except mpmfw.errors.SimulationError as error:
            return f"| {scene} | {contact} | {shape} | {found.steps} | failed: {error.what} | | | | | |"
    cpu = float(attributes["cpu_time"])
    values = (
        found.steps,
        attributes["steps"],
        f"{found.cpu_time:.2f}",
        f"{cpu:.2f}",
        f"{found.cpu_time / cpu:.2f}",
        f"{1e-6 * found.memory:.2f}",
        f"{memory:.2f}",
    )
    return " | ".join(["", scene, contact, shape, *map(str, values), ""]).strip()


def main() -> None:
    """Measure, run, write."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "costs.json"
        prediction.measure(table)
        prediction.own_table = lambda: table
        rows = [row(*combination) for combination in COMBINATIONS]
    PAGE.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
