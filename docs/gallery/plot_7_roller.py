"""
A roller between rigid plates, as a film
========================================

A plate presses an elastic roller onto a floor, which then begins to move. The roller turns, and its centre
moves with half the velocity of the floor. Johnson's closed form gives how far it is squeezed, 31.0 mm."""

from pathlib import Path
from tempfile import mkdtemp

import mpmfw

changes = {"grid.cell_size": 0.2, "time.output_interval": 0.05, "output.particles": True}
tree = mpmfw.run("roller", set=changes)

# %%
# ``mpmfw.animate`` writes a GIF, or with ``.mp4`` a film that can be stopped. ``mpmfw animate FILE`` does the
# same from a file.

film = mpmfw.animate(tree, Path(mkdtemp()) / "roller.gif", "in_plane_pressure", bodies=["roller"], fps=10)
film

# %%
# The plate's height and the centre's velocity, against the closed forms. These cells are twice those of the
# shipped scene.

plate = mpmfw.history(tree, "centre_of_mass", body="plate", axis="y")
velocity = mpmfw.history(tree, "mean_velocity", body="roller", axis="x")
print(f"squeezed by {1e3 * (2.1 - float(plate[-1])):.1f} mm, Johnson 31.0 mm")
print(f"velocity of the centre {float(velocity[-5:].mean()):.3f} m/s, half of the floor's 0.5 m/s")
