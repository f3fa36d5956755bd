"""Write docs/turned.md: the headline scenes turned against the grid; ``python docs/make_turned.py``.

The shipped scenes lie along grid lines, which flatters contact at nodes. Here bodies, velocities and gravity turn
together, the grid does not, and material points have two layouts. Takes about ten minutes of one core;
``--only SCENE`` and ``--contact NAME`` make a part anew.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import sys
import tomllib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import xarray as xr

import mpmfw
from mpmfw.errors import MpmfwError
from mpmfw.results.analysis import impulse, rolling_solution
from mpmfw.results.conservation import dissipation
from mpmfw.results.references import rings_table
from mpmfw.scene import load_scene
from mpmfw.units import to_si

HERE = Path(__file__).parent
PAGE, FOUND = HERE / "turned.md", HERE / "turned.json"
sys.path.insert(0, str(HERE.parent / "validation" / "hard"))

import placing  # noqa: E402

ANGLES = (0.0, 0.35, 0.6)  #: [rad]
LAYOUTS = ("fitted", "lattice")
CONTACTS = (
    "penalty(kappa=1)",
    "penalty(kappa=4)",
    "lcp",
    "hybrid",
    "surfaces+impulse",
    "bardenhagen(criterion=position, normal=master)",
    "bardenhagen(criterion=position, normal=master, cut_off=1.0)",
    "bardenhagen(criterion=position)",
    "bardenhagen",
    "bardenhagen(traction=true)",
    "nairn",
    "particles",
)
G, DISTANCE = 10.0, 10.0


def turned(name: str, angle: float, layout: str, changes: dict[str, Any]) -> dict[str, Any]:
    """Return a shipped scene as a mapping, turned about the origin by ``angle`` [rad], gravity as vectors."""
    scene = tomllib.loads(load_scene(name, set=changes).text)
    for table in (scene["grid"], *(body["geometry"] for body in scene["bodies"].values())):
        table.update({key: _metres(value) for key, value in table.items() if key != "type"})
    for key in ("gravity", "settle"):
        table = scene.get(key, {})
        own = table if key == "gravity" else table.get("gravity", {})
        if own:
            tilt = cast(float, to_si(own["tilt"], "rad"))
            vector = [G * math.sin(tilt), -G * math.cos(tilt)]
            scene[key] = {"vector": vector} if key == "gravity" else {**table, "gravity": {"vector": vector}}
    scene.pop("reference", None)
    for body in scene["bodies"].values():
        body["particles"] = {**body["particles"], "layout": layout}
    settle = scene.get("settle")
    made: dict[str, Any] = placing.placed(scene, turn=math.degrees(angle))
    if settle:
        rotation = direction(angle)
        made["settle"] = {**settle, "gravity": {"vector": (rotation @ settle["gravity"]["vector"]).tolist()}}
    return made


def _metres(value: Any) -> Any:
    return [_metres(one) for one in value] if isinstance(value, list) else cast(float, to_si(value, "m"))


def direction(angle: float) -> np.ndarray:
    """Rotation by ``angle`` [rad]; its first column is along the turned x axis."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def slides(run: xr.DataTree, along: np.ndarray) -> dict[str, float]:
    """Acceleration of the block [% of the rigid block's]."""
    way, time = _way(run, "block", along)
    exact = G * (math.sin(math.radians(30.0)) - 0.3 * math.cos(math.radians(30.0)))
    late = time >= 0.2 * time[-1]
    return {"acceleration": 100.0 * (2.0 * np.polyfit(time[late], way[late], 2)[0] / exact - 1.0)}


def rolls(tilt: float, friction: float) -> Callable[[xr.DataTree, np.ndarray], dict[str, float]]:
    """Displacement and spin of the cylinder when the rigid one has moved by 10 m [% of it]."""
    solution = rolling_solution(math.radians(tilt), friction, G, 1.6)

    def errors(run: xr.DataTree, along: np.ndarray) -> dict[str, float]:
        way, time = _way(run, "cylinder", along)
        at = solution.time_to(DISTANCE)
        omega = run["series"].to_dataset()["angular_velocity"].sel(body="cylinder").isel(rotation=-1).values
        return {
            "displacement": 100.0 * (np.interp(at, time, way) / DISTANCE - 1.0),
            "spin": 100.0 * (np.interp(at, time, omega) / float(solution.spin(at)) - 1.0),
        }

    return errors


def collides(run: xr.DataTree, along: np.ndarray) -> dict[str, float]:
    """Impulse of the rings over time, largest difference from the finite elements' [% of the total]."""
    series, table = run["series"].to_dataset(), rings_table("force")
    time = series["time"].values
    ours = impulse(time, -series["contact_force"].values[:, 0] @ along)
    exact = np.interp(time, table["time"], table["fine_impulse_Ns_per_m"])
    return {"impulse": 100.0 * float(np.abs(ours - exact).max() / table["fine_impulse_Ns_per_m"][-1])}


def _way(run: xr.DataTree, body: str, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    series = run["series"].to_dataset()
    centre = series["centre_of_mass"].sel(body=body).values
    return (centre - centre[0]) @ along, series["time"].values


class Headline(NamedTuple):
    """A shipped scene, what is set in it, its errors, and the contacts that run it."""

    title: str
    scene: str
    changes: dict[str, Any]
    errors: Callable[[xr.DataTree, np.ndarray], dict[str, float]]
    contacts: tuple[str, ...] = CONTACTS


SLIP, NO_SLIP = "rolling-cylinder-slip", "rolling-cylinder-no-slip"
COARSE, FINE = {"grid.cell_size": 0.8}, {"grid.cell_size": 0.4}
OF_README = (
    "penalty(kappa=1)",
    "penalty(kappa=4)",
    "bardenhagen(criterion=position, normal=master)",
    "bardenhagen",
)
SCENES = {
    "block": Headline("Block sliding down an incline", "sliding-block", {"time.end": 0.3}, slides),
    "slip": Headline("Cylinder, rolling with slip", SLIP, COARSE, rolls(60.0, 0.286)),
    "no-slip": Headline("Cylinder, rolling without slip", NO_SLIP, COARSE, rolls(45.0, 0.495)),
    "slip-fine": Headline("Rolling with slip, the README's cells", SLIP, FINE, rolls(60.0, 0.286), OF_README),
    "no-slip-fine": Headline(
        "Without slip, the README's cells", NO_SLIP, FINE, rolls(45.0, 0.495), OF_README
    ),
    "rings": Headline("Rings that collide", "colliding-rings", {"grid.cell_size": 0.004}, collides),
}
SHARED = {"output.gap": False, "output.particles": False, "output.surface": False}


def measured(name: str, contact: str) -> list[dict[str, Any]]:
    """Errors of a contact in a scene, for each layout and angle."""
    one, rows = SCENES[name], []
    for layout, angle in itertools.product(LAYOUTS, ANGLES):
        try:
            scene = load_scene(turned(one.scene, angle, layout, {**one.changes, **SHARED}))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                run = mpmfw.run(scene, contact=contact, shape="cpdi")
            found: dict[str, Any] = one.errors(run, direction(angle)[:, 0]) | {
                "lost": 100.0 * dissipation(run, scene)
            }
            found["cpu"] = float(run.attrs["cpu_time"])
        except MpmfwError as error:
            found = {"failed": str(error)}
        found = {key: float(f"{value:.4g}") if key != "failed" else value for key, value in found.items()}
        rows.append({"layout": layout, "angle": angle, **found})
        print(name, contact, rows[-1], flush=True)
    return rows


def table(found: dict[str, list[dict[str, Any]]]) -> list[str]:
    """A row for each contact: errors at the three angles with each layout, the largest of all in bold."""
    quantities = list(dict.fromkeys(key for rows in found.values() for row in rows for key in row))
    quantities = [key for key in quantities if key not in ("layout", "angle", "lost", "cpu", "failed")]
    lines = []
    for quantity in quantities:
        heads = [f"{layout}: {', '.join(f'{angle:g}' for angle in ANGLES)} rad" for layout in LAYOUTS]
        lines += [
            "",
            f"| {quantity}, error [%] | {' | '.join(heads)} | best | worst | lost, worst [%] |",
            "| --- |" + " --- |" * 5,
        ]
        for contact, rows in found.items():
            cells, known = [], [row[quantity] for row in rows if quantity in row]
            for layout in LAYOUTS:
                of = [row for row in rows if row["layout"] == layout]
                cells.append(
                    ", ".join(f"{row[quantity]:+.3g}" if quantity in row else "failed" for row in of)
                )
            best, worst = (f"{pick(known, key=abs):+.3g}" if known else "–" for pick in (min, max))
            if len(known) < len(rows):
                worst = "failed"
            lost = max(
                (row["lost"] for row in rows if row.get("lost") == row.get("lost") and "lost" in row),
                default=None,
            )
            lines.append(
                f"| `{contact}` | {' | '.join(cells)} | {best} | **{worst}** | {'–' if lost is None else f'{lost:.2g}'} |"
            )
    return lines


HEAD = """\
# Scenes turned against the grid

<!-- Made by docs/make_turned.py: edit that. -->

The shipped scenes lie along grid lines, which flatters contact at grid nodes. Here bodies, velocities and gravity
are turned together by 0, 0.35 and 0.6 rad. Points have fitted and lattice layouts; shape functions are CPDI. Cells are
coarse: the cylinder has two in its radius, and its plane is one cell thick; with the README's both are doubled. The
tables show the best and the worst of six. `lost` is the [dissipation](guide/studies.md#the-error). Take a method by its
worst column, unless your scene lies along the grid.
"""


def page(found: dict[str, Any]) -> str:
    """Return the page of what was found: for each scene and contact a list of errors with layout and angle."""
    text = [HEAD.rstrip("\n")]
    for name, one in SCENES.items():
        if name in found:
            ordered = {contact: found[name][contact] for contact in CONTACTS if contact in found[name]}
            changes = ", ".join(f"`{key}` = {value:g}" for key, value in one.changes.items())
            text += ["", f"## {one.title}", "", f"`{one.scene}` with {changes}.", *table(ordered)]
    return "\n".join(text) + "\n"


def main() -> None:
    """Run what is asked for, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=tuple(SCENES), action="append", help="make this scene's table anew")
    parser.add_argument("--contact", choices=CONTACTS, action="append", help="run these contacts anew")
    asked = parser.parse_args()
    found = json.loads(FOUND.read_text(encoding="utf-8")) if FOUND.exists() else {}
    for name in asked.only or SCENES:
        for contact in SCENES[name].contacts:
            if asked.contact and contact not in asked.contact:
                continue
            found.setdefault(name, {})[contact] = measured(name, contact)
            FOUND.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    main()
