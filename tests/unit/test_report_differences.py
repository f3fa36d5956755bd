"""The report of a scene without a reference: differences of methods, and where bodies went."""

import json

import numpy as np
import pytest
import xarray as xr

from mpmfw.plots import scene
from mpmfw.report import COLUMNS, shown, table, write_report
from mpmfw.report.page import differences

SCENE = "[grid]\ncell_size = 0.1\n[bodies.floor]\n[bodies.block]\n[bodies.stone]\n"
BODIES, PAIRS = ["floor", "block", "stone"], ["floor-block", "floor-stone"]


def comparison():
    """Two methods at two cell sizes: the block goes 1 or 2 m (1.5 at the coarse cells), the stone falls out
    of the second run.

    Impulses of floor and block are 3 and 6 N s/m, of floor and stone none.
    """
    lead = ("contact", "shape", "cell_size")
    shape, times = (2, 1, 2), np.linspace(0.0, 1.0, 3)
    centre = np.zeros((*shape, 3, 3, 2))
    centre[0, 0, :, :, 1, 0] = times
    centre[1, 0, 0, :, 1, 0], centre[1, 0, 1, :, 1, 0] = 1.5 * times, 2.0 * times
    force = np.zeros((*shape, 3, 2, 2))
    force[0, ..., 1:, 0, 1], force[1, ..., 1:, 0, 1] = 3.0, 6.0
    gap = np.full((*shape, 3, 2), np.nan)
    gap[..., 0], gap[..., 1] = 0.02, 0.5  # floor and stone five cells apart
    gap[1, ..., 1, 0] = -0.05
    energy = np.ones((*shape, 3, 3))
    return xr.Dataset(
        {
            "status": (lead, np.full(shape, "ok", dtype=object).astype(str)),
            "centre_of_mass": ((*lead, "time", "body", "axis"), centre),
            "mean_velocity": ((*lead, "time", "body", "axis"), np.gradient(centre, times, axis=3)),
            "contact_force": ((*lead, "time", "pair", "axis"), force, {"units": "N m-1"}),
            "friction_force": ((*lead, "time", "pair", "axis"), 0.0 * force, {"units": "N m-1"}),
            "min_gap": ((*lead, "time", "pair"), gap),
            "kinetic_energy": ((*lead, "time", "body"), energy, {"units": "J m-1"}),
            "strain_energy": ((*lead, "time", "body"), energy, {"units": "J m-1"}),
        },
        {
            "contact": ["one", "other"],
            "shape": ["cpdi"],
            "cell_size": [0.2, 0.1],
            "time": times,
            "body": BODIES,
            "pair": PAIRS,
            "axis": ["x", "y"],
        },
        {"scene": SCENE, "varied": '{"cell_size": "grid.cell_size"}', "kind": "compare"},
    )


@pytest.mark.parametrize(("stored", "shown"), [("N m-1", "N s/m"), ("N", "N s")])
def test_impulses_are_per_metre_where_the_forces_are(stored, shown):
    """Bodies with a thickness, bodies of revolution and bodies in space have forces in N."""
    runs = comparison()
    runs["contact_force"].attrs["units"] = stored
    found = {one.quantity: one.unit for one in differences(runs)}
    assert {unit for name, unit in found.items() if "impulse" in name} == {shown}


def test_the_largest_difference_comes_first():
    found = {one.quantity: one for one in differences(comparison())}
    spreads = [one.spread for one in differences(comparison())]
    assert spreads == sorted(spreads, reverse=True)
    moved = found["block: displacement, x"]
    assert moved.values.ravel().tolist() == [1.0, 2.0]
    assert (moved.spread, moved.scale) == (0.5, 2.0)
    assert found["floor-block: impulse, y"].values.ravel() == pytest.approx([3.0, 6.0])
    assert found["floor-block: largest penetration"].spread == pytest.approx(0.5)  # half a cell of 0.1 m
    assert found["kinetic energy"].spread == 0.0


def test_a_run_that_failed_differs_from_nothing():
    dataset = comparison()
    dataset["status"][{"contact": 1}] = "failed"
    for name in ("centre_of_mass", "mean_velocity"):
        dataset[name][{"contact": 1}] = np.nan
    assert all(one.spread == 0.0 for one in differences(dataset))


def with_costs(dataset):
    ones = (dataset["status"].dims, np.ones(dataset["status"].shape))
    return dataset.assign(dict.fromkeys(("cpu_time", "steps", "material_points"), ones))


def test_gap_and_depth_are_of_the_nearest_pair_and_noise_of_the_one_that_pushes_most():
    dataset = with_costs(comparison().sel(cell_size=[0.1]))
    # Floor and block; floor and stone are five cells apart
    assert table(dataset)[1]["gap"] == pytest.approx(0.2)
    swapped = dataset.assign_coords(pair=list(reversed(PAIRS))).sel(pair=PAIRS)
    assert repr(table(swapped)) == repr(table(dataset))  # noise of three outputs is NaN
    assert table(dataset)[1]["largest_penetration"] == pytest.approx(0.5)


def test_gaps_within_round_off_are_zero():
    dataset = with_costs(comparison().sel(cell_size=[0.1]))
    dataset["min_gap"][{"contact": 1}] = -0.9e-6  # 0.9e-5 cells
    found = {one.quantity: one for one in differences(dataset)}
    assert found["floor-block: largest penetration"].values.ravel().tolist() == [0.0, 0.0]
    gap = table(dataset)[1]["gap"]
    for value in (gap, -gap, 0.0):
        assert shown(value, COLUMNS["gap"]) == shown(value, COLUMNS["penetration"]) == "0"
    assert shown(-1.1e-5, COLUMNS["gap"]) == "-1e-05"
    drawn = scene.gap_history(dataset.sel(pair=["floor-block"]))
    lines = [line.get_ydata() for axes in drawn.axes for line in axes.lines if len(line.get_xdata()) == 3]
    assert min(np.min(line) for line in lines) == 0.0
    dataset["min_gap"][{"contact": 1}] = -1.1e-6
    found = {one.quantity: one for one in differences(dataset)}
    assert found["floor-block: largest penetration"].spread == pytest.approx(1.1e-5)


def test_the_page_escapes_every_text_and_needs_no_network(tmp_path):
    evil = "<script>alert('x')</script>"
    dataset = with_costs(comparison().sel(cell_size=[0.1])).assign_coords(contact=["none", evil])
    status = dataset["status"].astype(object)
    status[{"contact": 1}] = f"failed: {evil}"
    notes = json.dumps({f"{evil}/cpdi": [evil]})
    dataset = dataset.assign(status=status).assign_attrs(title=evil, scene=evil, commit=evil, notes=notes)
    write_report(dataset, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<script" not in page
    assert page.count("&lt;script&gt;") > 5
    assert "<svg" in page
    assert "src=" not in page
    assert 'href="http' not in page
