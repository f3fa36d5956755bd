"""Write docs/stability-maps/ and the section of docs/guide/stability.md about the shipped scenes.

``python docs/make_stability_maps.py [FOLDER]`` takes about four minutes of one core. FOLDER keeps the maps; one that was
broken off goes on from there.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from mpmfw.plots.stability import stability_chart
from mpmfw.stability import stability_map
from mpmfw.stability.chart import largest_stable

HERE = Path(__file__).parent
FIGURES, PAGE = HERE / "stability-maps", HERE / "guide" / "stability.md"
BEGIN = "<!-- Made by docs/make_stability_maps.py from here -->\n"
END = "<!-- to here -->\n"

KAPPA = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
CFL = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)


class Map(NamedTuple):
    """A shipped scene with coarser cells, and the steps of every run."""

    scene: str
    cell_size: str
    steps: int

    @property
    def command(self) -> str:
        """What makes the same map."""
        kappa, cfl = (",".join(f"{value:g}" for value in values) for values in (KAPPA, CFL))
        return (
            f"mpmfw stability {self.scene} --set 'grid.cell_size={self.cell_size}' --steps {self.steps} \\\n"
            f"  --kappa {kappa} --cfl {cfl}"
        )


MAPS = (
    Map("sliding-block", "0.2 m", 300),
    Map("contact-stress", "0.2 m", 300),
    Map("rolling-cylinder-slip", "0.8 m", 300),
    Map("rolling-cylinder-no-slip", "0.8 m", 300),
    Map("colliding-rings", "4 mm", 300),
)


def section(one: Map, dataset: xr.Dataset) -> str:
    """Command, figure, and the rows of the figure as numbers."""
    stability_chart(dataset).savefig(FIGURES / f"{one.scene}.png", dpi=200)
    return f"""
### {dataset.attrs["title"]}

```sh
{one.command}
```

![Classes over stiffness and Courant number](../stability-maps/{one.scene}.png)

{table(dataset)}
"""


def table(dataset: xr.Dataset) -> str:
    """Per stiffness: the limits, the largest Courant number that is stable, and the least one that is not."""
    heads = ("κ", "closed form", "Gershgorin bound", "refused past", "stable up to", "not from")
    lines = [f"| {' | '.join(heads)} |", "|" + " --- |" * len(heads)]
    for k, held in enumerate(largest_stable(dataset)):
        row: Any = dataset.isel(kappa=k)
        broken = row["cfl"].values[row["class"].values >= 2]
        refused = min(float(row["limit"]), float(dataset.attrs["courant"]))
        numbers = (float(row["closed_form"]), float(row["limit"]), refused)
        cells = [f"{float(row['kappa']):g}", *(f"{number:.3g}" for number in numbers)]
        cells += [f"{held:g}" if np.isfinite(held) else "–", f"{broken.min():g}" if len(broken) else "–"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Run, draw, write."""
    FIGURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        sections = []
        for one in MAPS:
            changes = {"grid.cell_size": one.cell_size}
            output = folder / f"{one.scene}.nc"
            dataset = stability_map(
                one.scene, kappa=KAPPA, cfl=CFL, steps=one.steps, set=changes, output=output
            )
            sections.append(section(one, dataset))
            print(one.command, table(dataset), sep="\n", flush=True)
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    PAGE.write_text(before + BEGIN + "".join(sections) + "\n" + END + after, encoding="utf-8")


if __name__ == "__main__":
    main()
