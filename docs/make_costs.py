"""Write docs/guide/costs.md: predicted against measured cost of the shipped scenes: ``python docs/make_costs.py``.

Measures this machine's times first, then runs every scene by ``mpmfw run`` in a process of its own; takes about five minutes.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import tracemalloc
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from mpmfw import cost_table, prediction
from mpmfw.cli.explain import named_arrays
from mpmfw.limits import results_size
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

`mpmfw explain SCENE` predicts steps, CPU time (with `--all` by stage) of steps, settling, output and start, the memory of all
arrays and the bytes of the file before a run, from a table of measured times: seconds a step of a stage are a + b n + c m, a
for the calls, b for each of n material points and c for each of m grid nodes, or b and c for surface nodes and for those near
another body where a contact works on outlines. The table that ships with mpmfw has a, b and c of every bundled shape function
and contact strategy, of gravity, prescribed sides, rotation and the energy ledger, and of a frame, from two blocks that touch,
at three sizes; `mpmfw explain SCENE --measure` takes one of your own machine and keeps it.

Steps are counted with the stable time step of the contacts that are detected at the start; where bodies do not touch
yet, with the one that contact takes for granted. A limit that changes during the run changes them, as where rings
touch for a part of it. How long settling takes nobody knows before: the most steps of it are predicted, after which it gives
up. Nothing is compiled but what detects contacts, where bodies touch at the start and contact limits the step.

Prediction against measurement, with times taken just before on the same machine (`python docs/make_costs.py`): CPU seconds of
the steps; of settling, for the steps that it took (in brackets, and the most); of output, that is frames, ledger and gap; and of
the whole process of `mpmfw run`, start included. A run is the cheaper of two. The table has the least of its samples and a run
the mean of what it meets: on a machine that does other things, as the one that this page was made on did, runs take longer than
is predicted. Memory is that of the arrays allocated while the simulation is built and takes a step, as NumPy reports it.

"""

COLUMNS = (
    *("scene", "contact", "shape", "steps, predicted", "run", "CPU, predicted", "run"),
    *("settling, predicted", "run", "output, predicted", "run", "whole, predicted", "run", "ratio"),
    *("arrays MB, predicted", "allocated", "file MB, predicted", "written"),
)
HEAD += f"| {' | '.join(COLUMNS)} |\n| {' | '.join(['---'] * len(COLUMNS))} |\n"


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


def run(scene: str, contact: str, shape: str, path: Path) -> tuple[dict[str, Any], float]:
    """The cheaper of two."""
    return min((run_once(scene, contact, shape, path) for _ in range(2)), key=lambda found: found[1])


def run_once(scene: str, contact: str, shape: str, path: Path) -> tuple[dict[str, Any], float]:
    """Attributes of a run's file, and the CPU time of its process [s]."""
    methods = ["--contact", contact, "--shape", shape]
    path.unlink(missing_ok=True)
    before = os.times()
    subprocess.run(
        [sys.executable, "-m", "mpmfw", "run", scene, *methods, "-o", str(path)],
        capture_output=True,
        check=True,
    )
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    with netCDF4.Dataset(path) as dataset:
        return {name: dataset.getncattr(name) for name in dataset.ncattrs()}, cpu


def row(scene: str, contact: str, shape: str) -> str:
    """Predict, run, and compare."""
    found, memory = allocated(scene, contact, shape)
    simulation = Simulation(scene, contact=contact, shape=shape)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.nc"
        try:
            attributes, whole = run(scene, contact, shape, path)
        except subprocess.CalledProcessError as error:
            what = error.stderr.decode().strip().splitlines()[-1]
            return f"| {scene} | {contact} | {shape} | {found.steps} | failed: {what} |" + " |" * 14
        written = path.stat().st_size
    settled = int(attributes.get("settle_steps", 0))
    settling = settled * found.cpu_time / found.steps
    costs, _ = cost_table.measured_costs()
    output = prediction.output_time(simulation, costs, found.steps, settled)
    predicted = found.cpu_time + settling + output + found.start_time
    values = (
        found.steps,
        int(attributes["steps"]),
        f"{found.cpu_time:.2f}",
        f"{float(attributes['cpu_time']):.2f}",
        f"{settling:.2f} ({settled}, {found.settle_steps})" if settled else "",
        f"{float(attributes['settle_time']):.2f}" if settled else "",
        f"{output:.2f}",
        f"{float(attributes['output_time']) + float(attributes['gap_time']):.2f}",
        f"{predicted:.2f}",
        f"{whole:.2f}",
        f"{predicted / whole:.2f}",
        f"{1e-6 * found.memory:.2f}",
        f"{memory:.2f}",
        f"{1e-6 * results_size(simulation, simulation.header())[2]:.1f}",
        f"{1e-6 * written:.1f}",
    )
    return " | ".join(["", scene, contact, shape, *map(str, values), ""]).strip()


def main() -> None:
    """Measure, run, write."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "costs.json"
        cost_table.measure(table)
        cost_table.own_table = lambda: table
        rows = [row(*combination) for combination in COMBINATIONS]
    PAGE.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
