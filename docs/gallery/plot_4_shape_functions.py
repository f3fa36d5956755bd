"""
Weights of a shape function over a cell crossing
================================================

One material point moves through a few cells. What it gives to one node, :math:`\\phi`, and what it takes from
it as strain,
:math:`\\partial\\phi/\\partial x`, decide how much noise crossing a cell face makes. The weights are those that a run uses: the
interpolation table of a simulation.
"""  # noqa: E501

import matplotlib.pyplot as plt
import numpy as np

import mpmfw
from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.runs.simulation import Simulation

plt.style.use("mpmfw.plots.journal")

#: One square point of half a cell, on a grid of unit cells.
scene = {
    "grid": {"cell_size": 1.0, "lower": [-4.0, -4.0], "upper": [6.0, 6.0]},
    "time": {"end": 1.0, "output_interval": 1.0},
    "shape": {"method": "linear"},
    "materials": {"any": {"model": "neo_hookean", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 1.0}},
    "bodies": {
        "point": {
            "material": "any",
            "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [0.5, 0.5]},
            "particles": {"size": 0.5},
        }
    },
}


def weights(shape, places, node=(1.0, 0.25), stretch=1.0):
    """Weight and gradient along x at a node line, of a point at each of the places."""
    simulation = Simulation(mpmfw.load_scene(scene, set={"shape.method": shape}))
    state = simulation.state
    points, grid = state.particles, state.grid
    points.deformation_gradient[0] = np.diag([stretch, 1.0])
    found = []
    for x in places:
        move = np.array([x, 0.25]) - points.position[0]
        points.position[0] += move
        if shape == "cpdi2":  # its domain is four corners of its own
            state.arrays["cpdi2/corners"][0] += move
        table = simulation.hook.interpolate(particles=points, grid=grid)
        line = np.isclose(grid.position[table.nodes, 0], node[0])  # summed along y: the function of x alone
        found.append([table.weight[line].sum(), table.gradient[line, 0].sum()])
    return np.array(found).T


# %% The gradient of the linear function jumps as the point crosses a cell face, and with it the force that it
# exerts. GIMP averages over the point's square, CPDI over its corners: as long as the square is not deformed
# their gradients are the same ramp, and CPDI's weight has a flat top where GIMP's is round. CPDI2 is the same
# as CPDI here; they differ where domains become trapezoids. B-splines need no domain: their gradient is
# continuous by itself, and they reach farther.

places = np.linspace(-0.8, 2.8, 181)
shapes = {"linear": ":", "cpdi": "-", "cpdi2": (0, (1, 2)), "gimp": "--", "bspline": "-."}
figure = new_figure(2, 1)
left, right = figure.subplots(1, 2)
for shape, style in shapes.items():
    phi, slope = weights(shape, places)
    left.plot(places, phi, linestyle=style, label=shape)
    right.plot(places, slope, linestyle=style, label=shape)
for axes in (left, right):
    for face in (0.0, 1.0, 2.0):
        axes.axvline(face, color="0.8", linewidth=0.6, zorder=0)
dress(left, "position of the point [cells]", "φ of the node at 1")
dress(right, "position of the point [cells]", "∂φ/∂x [1/cell]")
legend_below(figure, [left.get_legend_handles_labels()[0]])
figure

# %% A point that is stretched to one and a half cells: CPDI's corners follow, GIMP's square in mpmfw does
# not. Its corners are now farther apart than a cell, and its weight has a dip at the node between them: such
# points are too coarse for the grid.

figure = new_figure(2, 1)
left, right = figure.subplots(1, 2)
for shape, stretch, style in (("gimp", 3.0, "--"), ("cpdi", 1.0, ":"), ("cpdi", 3.0, "-")):
    phi, slope = weights(shape, places, stretch=stretch)
    left.plot(places, phi, linestyle=style, label=f"{shape}, stretched by {stretch:g}")
    right.plot(places, slope, linestyle=style)
dress(left, "position of the point [cells]", "φ of the node at 1")
dress(right, "position of the point [cells]", "∂φ/∂x [1/cell]")
legend_below(figure, [left.get_legend_handles_labels()[0]])
figure

# %%
# All of them sum to one over the nodes, and reproduce a linear field:

for shape in shapes:
    total = sum(weights(shape, [0.7], node=(float(k), 0.0))[:, 0] for k in range(-3, 5))
    first = sum(k * weights(shape, [0.7], node=(float(k), 0.0))[:, 0] for k in range(-3, 5))
    print(f"{shape:8s} sum φ = {total[0]:.12f}, sum x φ = {first[0]:.12f}, sum x ∂φ/∂x = {first[1]:.12f}")
    assert np.allclose([total[0], first[0], first[1]], [1.0, 0.7, 1.0])
