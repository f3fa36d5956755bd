"""Colliding rings, figure 3 of [H17]: von Mises stress beside that of fine finite elements."""
# cost: 160

import numpy as np
from common import POSITION
from matplotlib.collections import PolyCollection
from rings_fem import collide

from mpmfw.plots.style import dress, new_figure
from mpmfw.results.domains import corners_of
from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods, together

TIMES = (0.0, 0.4e-3, 1.6e-3, 3.2e-3)  #: of [H17] figure 3 [s]
MOST = 20e6  #: end of the colour scale of [H17] [Pa]
BODIES = ("left", "right")
#: Time, the fine elements' 95th percentile and mean in MPa; gates allow 10 and 15 % of them.
STRESSES = (("0.4 ms", 8.024, 3.2), ("1.6 ms", 14.085, 6.229), ("3.2 ms", 3.822, 1.855))


def frames_of(tree, time):
    """Return the material points of both rings at a time, and all their stresses."""
    rings = [tree[f"particles/{body}"].to_dataset().sel(time=time, method="nearest") for body in BODIES]
    return rings, np.concatenate([ring["von_mises"].values for ring in rings])


def of_run(tree):
    """Return the 95th percentile and the mean by reference volume at each time but the first [Pa]."""
    measures = {}
    for time in TIMES[1:]:
        rings, stress = frames_of(tree, time)
        mass = np.concatenate([ring["mass"].values for ring in rings])  # one density: as the volume
        order, at = np.argsort(stress), f"{1e3 * time:.1f} ms"
        filled = np.cumsum(mass[order]) - 0.5 * mass[order]
        measures[f"p95 {at}"] = float(np.interp(0.95 * mass.sum(), filled, stress[order]))
        measures[f"mean {at}"] = float(np.average(stress, weights=mass))
    return measures


def beside_finite_elements(runs):
    """Draw [H17] fig. 3: material points left, finite elements right, one row for each time."""
    tree = next(run for run in runs if run.method.recommended).results
    elements, figure = collide(2e-3), new_figure(2, 4, 60.0)
    panels = figure.subplots(4, 2, sharex=True, sharey=True)
    for pair, time, snapshot in zip(panels, TIMES, elements.snapshots, strict=True):
        rings, stress = frames_of(tree, time)
        domains = [corners_of(tree, body)(ring) for body, ring in zip(BODIES, rings, strict=True)]
        quads = snapshot.points[elements.mesh.elements], snapshot.element_von_mises
        names = "CPDI, points of 0.5 mm", "finite elements of 2 mm"
        for axes, drawn, name in zip(pair, ((np.concatenate(domains), stress), quads), names, strict=True):
            shown = _draw(axes, *drawn)
            dress(axes, "x [mm]", "y [mm]", f"{1e3 * time:.1f} ms: {name}")
            axes.label_outer()
            axes.set_axisbelow(True)
    bar = figure.colorbar(shown, ax=panels, location="bottom", shrink=0.6, aspect=40, extend="max", pad=0.015)
    bar.set_label("von Mises stress [MPa]")
    return figure


def _draw(axes, corners, von_mises):
    """Draw quadrilaterals (n, 4, 2) [m], coloured by their stress [Pa], in mm and MPa."""
    drawn = PolyCollection(list(1e3 * corners), array=1e-6 * von_mises, cmap="turbo", linewidth=0.3)
    drawn.set(edgecolor="face", clim=(0.0, 1e-6 * MOST), rasterized=True)
    axes.add_collection(drawn)
    axes.set(xlim=(-90.0, 90.0), ylim=(-62.0, 62.0), aspect="equal")
    return drawn


rings = Runs(
    "rings",
    scene="colliding-rings",
    methods=[
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], settings={"criterion position": POSITION}, when="full"),
        *methods(shape=RECOMMENDED, settings={"kappa 1": {"contact.penalty.kappa": 1.0}}, when="full"),
        *methods(when="quick"),
    ],
    set={"time.output_interval": "0.4 ms", "time.outputs": "exact", "output.energy": False},
)


@rings
def test_rings(run):
    for at, most, mean in STRESSES:
        for what, key, exact, share in (("95th percentile", "p95", most, 0.10), ("mean", "mean", mean, 0.15)):
            limits, value = (exact * (1 - share), exact * (1 + share)), run.of(of_run, f"{key} {at}", 1e-06)
            run.gate(f"von Mises stress, {what}, {at}", value, exact, limits, "MPa")


@together(rings)
def test_figure(case, runs):
    case.figure("", beside_finite_elements(runs))
