"""The figure of error over cost: markers that would cover each other."""

import numpy as np
import pytest
import xarray as xr

import mpmfw


def crowd(costs, errors):
    """A study of one contact and as many shape functions as there are runs, none of them on the front."""
    names = ["linear", "gimp", "cpdi", "cpdi2", "bspline"][: len(costs)]
    arrays = {"error": errors, "cpu_time": costs, "cpu_time_spread": np.full(len(costs), 0.01)}
    return xr.Dataset(
        {key: (("contact", "shape"), [value]) for key, value in arrays.items()}
        | {"pareto": (("contact", "shape"), np.zeros((1, len(costs)), dtype=bool))},
        {"contact": ["penalty"], "shape": names},
        {"under": 0.02, "quantity": "end-displacement", "problem_dims": "[]"},
    )


def markers_of(figure):
    """Where the markers of a front are drawn [pt], by shape, and their diameter."""
    figure.canvas.draw()
    (axes,) = figure.axes
    symbols = {"s": "linear", "^": "gimp", "o": "cpdi", "D": "cpdi2", "v": "bspline"}
    drawn = [line for line in axes.get_lines() if line.get_markersize() > 3 and line.get_marker() in symbols]
    scale = 72.0 / figure.dpi
    places = {
        symbols[one.get_marker()]: scale * one.get_transform().transform(one.get_xydata())[0] for one in drawn
    }
    return places, drawn[0].get_markersize(), lambda x, y: scale * axes.transData.transform((x, y))


def test_markers_that_would_cover_each_other_are_moved_up_or_down_and_no_further():
    study = crowd([0.40, 0.371, 0.392, 0.479, 9.0], [0.0113, 0.0115, 0.0112, 0.0111, 0.10])
    places, size, belongs = markers_of(mpmfw.plots.front(study))
    assert len(places) == 5
    centres = np.array(list(places.values()))
    apart = np.hypot(*(centres[:, None] - centres[None]).T)[np.triu_indices(5, 1)]
    assert apart.min() >= 0.55 * size
    for name, place in places.items():
        run = study.sel(contact="penalty", shape=name)
        x, y = belongs(float(run["cpu_time"]), 100.0 * float(run["error"]))
        assert place[0] == pytest.approx(x, abs=0.1)
        assert abs(place[1] - y) <= 2.0 * size
        assert name != "bspline" or place[1] == pytest.approx(y, abs=0.1)


def test_markers_that_cover_nothing_stay():
    study = crowd([0.1, 1.0, 10.0], [0.1, 0.01, 0.001])
    places, _, belongs = markers_of(mpmfw.plots.front(study))
    for name, place in places.items():
        run = study.sel(contact="penalty", shape=name)
        np.testing.assert_allclose(place, belongs(run["cpu_time"], 100.0 * run["error"]), atol=0.1)
