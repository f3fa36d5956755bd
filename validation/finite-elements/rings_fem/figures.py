"""Von Mises stress of a collision."""

from __future__ import annotations

from typing import Any

from matplotlib.collections import PolyCollection

from rings_fem.collision import Snapshot
from rings_fem.mesh import Mesh


def draw_von_mises(axes: Any, snapshot: Snapshot, mesh: Mesh, most: float = 20e6) -> PolyCollection:
    """Draw each deformed element [mm], coloured by its mean stress, 0 to ``most`` [Pa], in MPa."""
    drawn = PolyCollection(
        list(1e3 * snapshot.points[mesh.elements]),
        array=1e-6 * snapshot.element_von_mises,
        cmap="turbo",
        linewidth=0.2,
    )
    drawn.set_edgecolor("face")
    drawn.set_clim(0.0, 1e-6 * most)
    axes.add_collection(drawn)
    axes.set_xlim(-90.0, 90.0)
    axes.set_ylim(-62.0, 62.0)
    axes.set_aspect("equal")
    return drawn
