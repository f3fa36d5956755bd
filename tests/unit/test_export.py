"""What ParaView reads is what the run stored: every value and every time, by VTK's own readers."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_QUAD, VTK_TRIANGLE, VTK_VERTEX
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

import mpmfw
from drop_for_tests import drop
from mpmfw.errors import SceneError
from mpmfw.geometry.layout import neighbours_of
from scenes_for_tests import ball_on_a_box

BODIES = ("upper", "floor")


@pytest.fixture(scope="module", params=["cpdi", "cpdi2", "gimp"])
def exported(request, tmp_path_factory):
    """Shape function, results, folder of the export, made from the file."""
    folder = tmp_path_factory.mktemp(request.param)
    tree = drop(request.param, output=folder / "drop.nc")
    written = mpmfw.export(folder / "drop.nc", folder / "out")
    names = ["drop-points.pvd", "drop-surfaces.pvd", "drop-series.csv"]
    assert written == [folder / "out" / name for name in names]
    return request.param, tree, folder / "out"


def listed(collection):
    """Times and files of a collection."""
    entries = ET.parse(collection).getroot().findall("Collection/DataSet")
    return [(float(entry.get("timestep")), collection.parent / entry.get("file")) for entry in entries]


def read(path):
    """The grid of one file, and the time that the reader knows it by; no reader may report an error."""
    reader, errors = vtkXMLUnstructuredGridReader(), []
    reader.AddObserver("ErrorEvent", lambda *event: errors.append(event))
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())
    reader.Update()
    assert not errors
    return reader.GetOutput(), times


def arrays(data):
    return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}


def expected(values):
    """Vectors of three and tensors of nine components, from those of the plane."""
    if values.ndim == 1:
        return values
    padded = np.zeros((len(values), *(3,) * (values.ndim - 1)))
    padded[(slice(None), *(slice(values.shape[-1]),) * (values.ndim - 1))] = values
    return padded.reshape(len(values), -1)


def test_every_time_and_value_of_the_points_is_read_back(exported):
    shape, tree, folder = exported
    collection = listed(folder / "drop-points.pvd")
    assert [time for time, _ in collection] == tree["time"].values.tolist()
    for k, (time, file) in enumerate(collection):
        grid, times = read(file)
        assert times == (time,)
        kinds = {grid.GetCellType(cell) for cell in range(grid.GetNumberOfCells())}
        assert kinds == ({VTK_VERTEX} if shape == "gimp" else {VTK_QUAD})
        found = arrays(grid.GetPointData() if shape == "gimp" else grid.GetCellData())
        stored = {body: tree[f"particles/{body}"].to_dataset() for body in BODIES}
        np.testing.assert_array_equal(
            found.pop("body"), np.repeat([0, 1], [stored[body].sizes["particle"] for body in BODIES])
        )
        names = set(stored["upper"].data_vars) - {"corners"} - ({"position"} if shape == "gimp" else set())
        assert set(found) == names
        for name in names:
            parts = [stored[body][name].isel(time=k, missing_dims="ignore").values for body in BODIES]
            values = expected(np.concatenate(parts))
            if name == "stress":  # the out-of-plane stress is not in the file
                assert np.isnan(found[name][:, 8]).all()
                values[:, 8] = np.nan
            if name == "deformation_gradient":
                values[:, 8] = 1.0
            np.testing.assert_array_equal(found[name], values, err_msg=name)


def test_the_cells_are_the_domains_of_the_shape_function(exported):
    shape, tree, folder = exported
    for k, (_, file) in enumerate(listed(folder / "drop-points.pvd")):
        grid, _ = read(file)
        points = vtk_to_numpy(grid.GetPoints().GetData())
        position = np.concatenate([tree[f"particles/{body}/position"].values[k] for body in BODIES])
        if shape == "gimp":
            np.testing.assert_array_equal(points[:, :2], position)
            continue
        corners = points.reshape(-1, 4, 3)[..., :2]
        volume = np.concatenate([tree[f"particles/{body}/volume"].values[k] for body in BODIES])
        diagonals = corners[:, 2:] - corners[:, :2]
        area = 0.5 * np.linalg.det(diagonals)
        # A point of CPDI2 integrates F, its quadrilateral moves by its corners: the two drift apart; stored
        # are six digits
        np.testing.assert_allclose(area, volume, rtol=1e-6 if shape == "cpdi" else 0.05)
        if shape == "cpdi":
            np.testing.assert_allclose(corners.mean(axis=1), position, atol=1e-6)
        else:
            stored = [tree[f"particles/{body}/corners"].values[k] for body in BODIES]
            np.testing.assert_array_equal(corners, np.concatenate(stored))


def test_surfaces_are_closed_lines_with_force_and_gap(exported):
    _, tree, folder = exported
    for k, (time, file) in enumerate(listed(folder / "drop-surfaces.pvd")):
        assert time == float(tree["time"][k])
        grid, _ = read(file)
        assert {grid.GetCellType(cell) for cell in range(grid.GetNumberOfCells())} == {VTK_LINE}
        ends = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 2)
        assert sorted(ends[:, 0]) == sorted(ends[:, 1]) == list(range(grid.GetNumberOfPoints()))
        found = arrays(grid.GetPointData())
        stored = [tree[f"surface/{body}"].to_dataset().isel(time=k) for body in BODIES]
        points = vtk_to_numpy(grid.GetPoints().GetData())
        np.testing.assert_array_equal(
            points[:, :2], np.concatenate([one["position"].values for one in stored])
        )
        np.testing.assert_array_equal(
            found["force"], expected(np.concatenate([one["force"].values for one in stored]))
        )
        np.testing.assert_allclose(found["gap"].min(), float(tree["series/min_gap"][k, 0]), atol=1e-15)
        np.testing.assert_array_equal(found["body"][ends[:, 0]], arrays(grid.GetCellData())["body"])
    assert (found["gap"] < 0.0).any()
    assert np.abs(found["force"]).max() > 0.0


def test_surfaces_of_three_dimensions(tmp_path):
    tree = mpmfw.run(ball_on_a_box())
    _, surfaces, _ = mpmfw.export(tree, tmp_path)
    for k, (_, file) in enumerate(listed(surfaces)):
        grid, _ = read(file)
        assert {grid.GetCellType(cell) for cell in range(grid.GetNumberOfCells())} == {VTK_TRIANGLE}
        facets = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)
        neighbours_of(facets)  # closed
        found, points = arrays(grid.GetPointData()), vtk_to_numpy(grid.GetPoints().GetData())
        stored = [tree[f"surface/{body}"].to_dataset().isel(time=k) for body in ("solid", "ball")]
        np.testing.assert_array_equal(points, np.concatenate([one["position"].values for one in stored]))
        np.testing.assert_allclose(found["gap"].min(), float(tree["series/min_gap"][k, 0]), rtol=1e-9)
        np.testing.assert_array_equal(found["body"][facets[:, 0]], arrays(grid.GetCellData())["body"])
    force = np.concatenate([one["force"].values for one in stored])
    corners = points[facets]
    third = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 6.0
    area = np.zeros_like(points)
    np.add.at(area, facets.T.ravel(), np.tile(third, (3, 1)))
    pressed = -(force * area).sum(axis=1) / (area * area).sum(axis=1)
    pressure = found["contact_pressure"]
    np.testing.assert_allclose(pressure, pressed, rtol=1e-9, atol=1e-6)
    assert pressure.max() > 1e3
    felt = pressure > 0.1 * pressure.max()
    share = np.linalg.norm(found["contact_traction"][felt], axis=1) / pressure[felt]
    assert 0.05 < np.median(share) <= 0.3 * (1.0 + 1e-2)  # the springs of friction are still closing


def test_no_output_of_an_earlier_export_stays_behind(exported, tmp_path):
    _, tree, _ = exported
    mpmfw.export(tree, tmp_path / "drop.pvd")
    own = tmp_path / "drop-points" / "notes.txt"
    own.write_text("mine", encoding="utf-8")
    for every in (2.0, "a", None, 0):
        with pytest.raises(SceneError, match="expected a whole number of 1 or more"):
            mpmfw.export(tree, tmp_path / "drop.pvd", every=every)
    with pytest.raises(SceneError, match=r"drop-points.pvd: exists already"):
        mpmfw.export(tree, tmp_path / "drop.pvd", every=3)
    mpmfw.export(tree, tmp_path / "drop.pvd", every=3, force=True)
    listed_files = {file for _, file in listed(tmp_path / "drop-points.pvd")}
    assert set((tmp_path / "drop-points").iterdir()) == {own, *listed_files}
