"""
A film of a run
===============

[H17]'s cylinder rolls down the plane under classical contact in its strongest form and under penalty contact,
side by side at the same times. ``mpmfw animate`` does the same from the files of two runs, and ``.mp4``
instead of ``.gif`` makes a film to be stopped."""

from pathlib import Path
from tempfile import mkdtemp

import mpmfw

changes = {"grid.cell_size": 0.8, "output.particles": True, "time.output_interval": 0.05}
contacts = {"classical": "bardenhagen(criterion=position, normal=master)", "penalty": "penalty"}
runs = {
    label: mpmfw.run("rolling-cylinder-slip", contact=contact, shape="cpdi", set=changes)
    for label, contact in contacts.items()
}

# %% Colours are the von Mises stress, on a scale that holds for both and for all times. Cells are coarse,
# four to the radius: at nodes the contact presses on few points of the cylinder's foot, and its stress leaves
# the scale.

film = mpmfw.animate(runs, Path(mkdtemp()) / "rolling.gif", "von_mises", limits=(0.0, 6e4), fps=10)
film
