"""Comparisons with a runner that computes nothing: joining, failures, the table, the page and the figures."""

import numpy as np
import pytest
import xarray as xr

from mpmfw.campaigns.comparison import compare as compare_really
from mpmfw.errors import MpmfwError, SceneError, SimulationError
from mpmfw.plots import figures_of
from mpmfw.report import table
from mpmfw.results import Frame, RunHeader, RunWriter
from mpmfw.results import open as open_results
from mpmfw.results.references import rings_table
from mpmfw.scene.loading import shipped_scenes
from mpmfw.state.clock import STEP_STAGES
from mpmfw.state.fields import CONTACT_SERIES, MIN_GAP, SERIES_FIELDS, SURFACE_FIELDS

SERIES = {field.name: field for field in (*SERIES_FIELDS, *CONTACT_SERIES, MIN_GAP)}
ERRORS = {"penalty": 0.01, "bardenhagen": -0.08, "none": 0.0}
ACCELERATION, SPIN = 10.0 * (np.sin(np.pi / 3) - 0.286 * 0.5), -2.0 * 0.286 * 10.0 * 0.5 / 1.6


def compare(scene, contact, shape, vary=None, *, runner, **arguments):
    """A comparison whose runs are the runner's, which computes nothing."""

    def run(scene, *, contact, shape, output, **_):
        name = scene.contact.method if contact is None else contact
        overrides = {k: v for k, v in scene.source.overrides.items() if not k.endswith(".method")}
        try:
            tree = runner(
                scene, contact=name, shape=scene.shape.method if shape is None else shape, set=overrides
            )
        except SimulationError as error:
            tree = error.results
            raise
        finally:
            if output is not None and "tree" in locals():
                tree.to_netcdf(output)
        return tree

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("mpmfw.campaigns.work.run", run)
        scene = "rolling-cylinder-slip" if scene == "any" else scene
        return compare_really(scene, contact, shape, vary, repeats=1, **arguments)


def acceleration(friction):
    """Of the rigid cylinder on the plane of 60 degrees under 10 m/s²."""
    slips = np.tan(np.pi / 3) > 3.0 * friction
    return 10.0 * (np.sin(np.pi / 3) - friction * 0.5) if slips else 20.0 * np.sin(np.pi / 3) / 3.0


class Cylinder:
    """Stands in for ``mpmfw.run``: a cylinder that rolls by the closed form, a known fraction too far."""

    def __init__(self, fail=None, refuse=()):
        self.fail, self.refuse, self.calls = fail, refuse, []

    def __call__(self, _scene, *, contact, shape, set, **_):
        name = contact.partition("(")[0] if isinstance(contact, str) else contact.name
        self.calls.append((name, shape, dict(set)))
        if (name, shape) in self.refuse:
            raise SceneError(f"{name} does not go with {shape}")
        names = (
            "centre_of_mass",
            "mean_velocity",
            "angular_velocity",
            *(["min_gap"] if name != "none" else []),
        )
        angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
        header = RunHeader(
            2,
            ("cylinder", "plane"),
            ("cylinder-plane",),
            {"cylinder": 3, "plane": 4},
            (*(SERIES[field] for field in names), SURFACE_FIELDS[0]),
            {"cylinder": 24, "plane": 4},
            {"cylinder": np.roll(np.arange(24), -1), "plane": np.array([1, 2, 3, 0])},
            {
                "scene": shipped_scenes()["rolling-cylinder-slip"],
                "title": "Rolling <cylinder>",
                "contact": name,
                "scheme": "musl" if shape == "linear" else "usl",
                "transfer": "flip" if shape == "linear" else "aflip",
            },
        )
        rate = acceleration(set.get("contact.pairs[0].friction", 0.286))
        circle = 1.6 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        plane = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 0.8], [0.0, 0.8]])
        with RunWriter(None, header) as writer:
            for time in np.linspace(0.0, 1.7, 18):
                if self.fail == name and time > 0.85:
                    writer.finish({"status": "failed: a point left the grid", "steps": 5})
                    error = SimulationError("a point left the grid", time=time)
                    error.results = writer.results()
                    raise error
                d = 0.5 * rate * time**2 * (1.0 + ERRORS[name])
                series = {
                    "centre_of_mass": [[4.0 + d, 2.4], [10.0, 0.4]],
                    "mean_velocity": [[rate * time * (1.0 + ERRORS[name]), 0.0], [0.0, 0.0]],
                    "angular_velocity": [[SPIN * time * 0.9], [0.0]],
                    "min_gap": [0.2],
                }
                writer.write(
                    Frame(
                        float(time),
                        surface={"position": np.concatenate([circle + np.array([4.0 + d, 2.4]), plane])},
                        series={field: np.array(series[field]) for field in names},
                    )
                )
            stages = {f"cpu_{stage}": 0.1 for stage in STEP_STAGES}
            writer.finish({"steps": 100, "material_points": 1000, "cpu_time": 0.6, "wall_time": 0.7} | stages)
        return writer.results()


@pytest.fixture(scope="module")
def rolling():
    return compare("any", ["penalty", "bardenhagen"], ["linear", "cpdi"], runner=Cylinder(fail="bardenhagen"))


def test_joined_on_contact_and_shape(rolling):
    assert rolling["centre_of_mass"].dims == ("contact", "shape", "time", "body", "axis")
    assert rolling["centre_of_mass"].attrs["units"] == "m"
    end = rolling["mean_velocity"].sel(contact="penalty", shape="cpdi", body="cylinder", axis="x", time=1.7)
    assert float(end) == pytest.approx(1.01 * ACCELERATION * 1.7)
    assert rolling["cpu_stage"].sel(contact="penalty", shape="linear", stage="contact").item() == 0.1
    assert "scene" in rolling.attrs
    assert "contact" not in rolling.attrs


def test_refused_combinations_are_recorded_and_refused_requests_raised():
    refused = {("penalty", "cpdi2")}
    data = compare("any", ["penalty"], ["cpdi2", "cpdi"], runner=Cylinder(refuse=refused))
    assert data["status"].values.tolist() == [["refused: penalty does not go with cpdi2", "ok"]]
    with pytest.raises(SceneError, match="does not go"):
        compare("any", ["penalty"], ["cpdi2"], runner=Cylinder(refuse=refused))


def test_varied_keys_become_dimensions_and_particles_stay_out():
    runner = Cylinder()
    data = compare(
        "any", ["none"], ["cpdi"], {"grid.cell_size": [0.4, 0.2]}, set={"time.end": 1.0}, runner=runner
    )
    assert data["centre_of_mass"].dims[:3] == ("contact", "shape", "cell_size")
    assert runner.calls[1][2] == {"output.particles": False, "time.end": 1.0, "grid.cell_size": 0.2}


def test_every_row_is_judged_by_its_own_closed_form(tmp_path):
    key = "contact.pairs[0].friction"
    data = compare("any", ["penalty"], ["cpdi"], {key: [0.0, 0.286, 0.1]}, runner=Cylinder())
    data.to_netcdf(tmp_path / "c.nc")
    data = open_results(tmp_path / "c.nc")
    assert data.attrs["varied"] == '{"friction": "contact.pairs[0].friction"}'
    for row in table(data):
        assert row["displacement_error"] == pytest.approx(1.0)
    same = compare("any", ["penalty"], ["cpdi"], {"grid.cell_size": [0.4, 0.2]}, runner=Cylinder())
    assert [row["gap"] for row in table(same)] == pytest.approx([0.5, 1.0])


@pytest.mark.parametrize(
    ("contact", "varied", "shared", "message"),
    [
        (["none"], {}, {"contact.method": "penalty"}, r"set contact\.method: .* chosen by contact=\[…\]"),
        (["none"], {"time.end": [1, 2]}, {"time.end": 1}, r"set time\.end: vary time\.end takes its place"),
        (["none"], {"time.end": [1, 1.0]}, {}, r"vary time\.end: 1\.0 is given twice"),
        (["none", "none"], {}, {}, "contact: none is given twice"),
        (["none"], {"contact.penalty.kappa": [1, 2]}, {}, r"vary contact\.penalty\.kappa: has no effect"),
    ],
)  # fmt: skip
def test_requests_that_contradict_themselves_are_refused(contact, varied, shared, message):
    runner = Cylinder()
    with pytest.raises(SceneError, match=message):
        compare("any", contact, ["cpdi"], varied, set=shared, runner=runner)
    assert runner.calls == []


def test_saved_and_opened(tmp_path):
    saved = compare("any", ["penalty", "none"], ["cpdi"], runner=Cylinder(), output=tmp_path / "c.nc")
    opened = open_results(tmp_path / "c.nc")
    xr.testing.assert_equal(saved, opened)
    assert opened["min_gap"].sel(contact="none").isnull().all()  # a series that one method lacks
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.nc", "c.nc.runs"]
    with pytest.raises(MpmfwError, match="does not exist"):
        compare("any", ["none"], ["cpdi"], runner=Cylinder(), output=tmp_path / "nowhere" / "c.nc")


def test_table_finds_the_errors_that_were_put_in(rolling):
    row = next(row for row in table(rolling) if (row["contact"], row["shape"]) == ("penalty", "cpdi"))
    assert row["displacement_error"] == pytest.approx(1.0)
    assert row["acceleration_error"] == pytest.approx(1.0)
    assert row["spin_error"] == pytest.approx(-10.0)
    assert row["gap"] == pytest.approx(0.5)
    assert row["cost"] == pytest.approx(6000.0)
    failed = next(row for row in table(rolling) if row["contact"] == "bardenhagen")
    assert np.isnan(failed["displacement_error"])


def rings(contact_force):
    """A comparison of the rings whose force is given at the reference's times."""
    time = rings_table("force")["time"]
    series = {field: SERIES[field] for field in ("contact_force", "kinetic_energy")}
    kinetic = np.interp(time, rings_table("energy")["time"], rings_table("energy")["fine_kinetic_J_per_m"])
    header = RunHeader(
        2, ("left", "right"), ("left-right",), {"left": 1, "right": 1}, tuple(series.values()),
        attributes={"scene": shipped_scenes()["colliding-rings"]},
    )  # fmt: skip

    def runner(*_, **__):
        with RunWriter(None, header) as writer:
            for t, force, energy in zip(time, contact_force, kinetic, strict=True):
                values = {
                    "contact_force": np.array([[-force, 0.0]]),
                    "kinetic_energy": np.full(2, energy / 2),
                }
                writer.write(Frame(float(t), series=values))
            writer.finish({"steps": 1})
        return writer.results()

    return compare("any", ["penalty"], ["cpdi"], runner=runner)


def test_rings_measures_vanish_for_the_reference_itself():
    reference = rings_table("force")
    exact = np.diff(reference["fine_impulse_Ns_per_m"], prepend=0.0) / np.diff(
        reference["time"], prepend=-1.0
    )
    data = rings(exact)
    (row,) = table(data)
    assert row["impulse_error"] == pytest.approx(0.0, abs=1e-6)
    assert row["impulse_curve_error"] == pytest.approx(0.0, abs=1e-6)
    assert row["energy_curve_error"] == pytest.approx(0.0, abs=1e-6)
    assert row["force_error_100us"] == pytest.approx(0.0, abs=1e-6)
    assert row["separation"] == pytest.approx(2.971, abs=0.01)
    assert set(figures_of(data)) == {"force"}
    (short,) = table(data.isel(time=data["time"] < 3.1e-3))
    for name in ("impulse_curve_error", "energy_curve_error", "force_error_100us", "force_error_200us"):
        assert np.isnan(short[name])  # stopped before the end of what is compared
    assert short["impulse_error"] == pytest.approx(0.0, abs=1e-3)
