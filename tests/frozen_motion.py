"""Freeze the motion of many short runs, and compare a later checkout with it to the bit.

A change of structure must not change motion::

    python tests/frozen_motion.py freeze build/before.npz      # before
    python tests/frozen_motion.py compare build/before.npz     # after; exit status 1 if a bit of the motion differs

Bits depend on the processor, so that both runs belong on one machine. ``--jobs N`` runs N at once, ``--only
TEXT`` those whose name has the text. Works and energies may change in the last digit where sums are
reordered: they are listed apart."""  # noqa: E501

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "stability"))


from hard_cases import CASES, IN_SPACE

import mpmfw
from contact_scenes import STRATEGIES, impact, slider, three_meet
from mpmfw.errors import MpmfwError
from scenes_for_tests import two_blocks

STEPS = 40
SHAPES = ("linear", "gimp", "cpdi", "cpdi2", "bspline", "cubic_bspline", "ck")
MORE = {
    "adhesion": "adhesion(traction=1000.0)",
    "points+penalty": "points+penalty",
    "nodes+penalty": "nodes+penalty",
}
CONTACTS = {
    **{label: f"{name}({_written})" if (_written := ", ".join(f"{k}={v}" for k, v in options.items())) else name  # noqa: E501
       for label, (name, options) in STRATEGIES.items() if "specified" not in label},
    **MORE,
}  # fmt: skip
SHIPPED = {
    "rolling-cylinder-slip": {"grid.cell_size": 0.8, "time.end": 0.2, "time.output_interval": 0.1},
    "rolling-cylinder-no-slip": {"grid.cell_size": 0.8, "time.end": 0.2, "time.output_interval": 0.1},
    "sliding-block": {"time.end": 0.02, "time.output_interval": 0.01},
    "contact-stress": {"time.end": 2e-3, "time.output_interval": 1e-3},
}
#: Series of works, energies and their residuals.
SUMS = ("work", "energy", "dissipat", "ledger", "residual")


def scenes():
    """Mappings of all scenes by name; those of the suite run a number of steps."""
    found = {f"shipped {name}": {"shipped": name, "set": values} for name, values in SHIPPED.items()}
    cases = {**CASES, **IN_SPACE}
    found |= {
        f"hard {name}": case.build() for name, case in cases.items() if not case.refusal and not case.springs
    }
    found |= {
        "impact": impact(),
        "slider": slider(),
        "three meet": three_meet(),
        "two blocks": two_blocks("penalty"),
    }
    return found


def runs():
    """Scene, contact and shape: every contact with the scene's shape, every shape with two contacts."""
    for scene in scenes():
        yield from ((scene, contact, "cpdi") for contact in CONTACTS)
        yield from ((scene, contact, shape) for contact in ("penalty", "bardenhagen") for shape in SHAPES)


def motion(scene, contact, shape):
    """Series of a run and the points' state at its end, by name; why it was refused or failed."""
    given = scenes()[scene]
    try:
        if "shipped" in given:
            made = mpmfw.load_scene(given["shipped"], set={**given["set"], "output.ledger": True})
        else:
            made = mpmfw.load_scene({**given, "output": {"ledger": True}})
        simulation, frames = mpmfw.Simulation(made, contact=CONTACTS[contact], shape=shape), []
        simulation.start()
        for _ in range(4):
            simulation.advance(STEPS // 4, frames.append)
        points = simulation.state.particles
        found = {
            f"{name} {k}": np.array(values)
            for k, frame in enumerate(frames)
            for name, values in frame.series.items()
        }
        return found | {name: getattr(points, name).copy() for name in ("position", "velocity", "stress")}
    except MpmfwError as error:
        return {"ended": np.array(type(error).__name__)}


def differences(before, after):
    """Names of the values that differ in a bit, and by what share of their largest."""
    for name in sorted({*before, *after}):
        one, other = before.get(name), after.get(name)
        if one is None or other is None or one.shape != other.shape or one.dtype.kind not in "fiu":
            if one is None or other is None or not np.array_equal(one, other):
                yield name, np.inf
        elif not np.array_equal(one, other, equal_nan=True):
            scale = np.nanmax(np.abs(one), initial=0.0) or 1.0
            yield name, float(np.nanmax(np.abs(one - other), initial=0.0) / scale)


def main():
    """Freeze, or compare and list what differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["freeze", "compare"])
    parser.add_argument("file", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    chosen = [run for run in dict.fromkeys(runs()) if asked.only in " | ".join(run)]
    with ProcessPoolExecutor(asked.jobs) as pool:
        found = dict(zip(chosen, pool.map(partial(_one), chosen), strict=True))
    flat = {
        " | ".join([*run, name]): values for run, series in found.items() for name, values in series.items()
    }
    if asked.what == "freeze":
        asked.file.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(asked.file, **flat)
        print(
            f"{len(chosen)} runs, {sum('ended' in series for series in found.values())} of them refused or "
            "ended"
        )
        return 0
    with np.load(asked.file, allow_pickle=False) as file:
        frozen = {name: file[name] for name in file.files if asked.only in name}
    rows = list(differences(frozen, flat))
    moved = [row for row in rows if not any(word in row[0].rpartition(" | ")[2] for word in SUMS)]
    for name, share in rows:
        print(f"{share:9.2e}  {name}")
    print(
        f"{len(chosen)} runs: {len(moved)} values of the motion differ, {len(rows) - len(moved)} sums of "
        "works"
    )
    return 1 if moved else 0


def _one(run):
    return motion(*run)


if __name__ == "__main__":
    sys.exit(main())
