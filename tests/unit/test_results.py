"""The results' file: what is written is what is read, in memory and on disk."""

import base64
import dataclasses
import json
import os
import zlib

import netCDF4
import numpy as np
import pytest
import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.results import Frame, RunHeader, RunWriter
from mpmfw.results.concatenation import series_at_outputs, union_of_times
from mpmfw.results.provenance import peak_memory, restart_peak_memory
from mpmfw.results.reading import read as open_results
from mpmfw.results.selection import opened
from mpmfw.state.fields import CONTACT_SERIES, PARTICLE_FIELDS, SERIES_FIELDS, SURFACE_FIELDS, Field

FIELDS = tuple(
    field for field in (*PARTICLE_FIELDS, *SURFACE_FIELDS, *SERIES_FIELDS, *CONTACT_SERIES) if field.output
)
PRESSURE = Field("pressure", ("contact_node",), "Pa", "contact pressure", "contact", output=True)
COUNT = {"ball": 4, "floor": 6}


def header(**changes):
    return RunHeader(
        **{
            "dim": 2,
            "bodies": ("ball", "floor"),
            "pairs": ("ball-floor",),
            "particle_count": COUNT,
            "fields": (*FIELDS, PRESSURE),
            "surface_count": {"ball": 3, "floor": 0},
            "connectivity": {"ball": np.array([1, 2, 0])},
            "attributes": {
                "title": "a ball",
                "effects": {"gravity": [0, -10]},
                "settled": True,
                "commit": None,
            },
            **changes,
        }
    )


def frame(time, seed=0):
    random = np.random.default_rng([seed, round(1000 * time)])
    sizes = {"axis": 2, "axis2": 2, "rotation": 1, "body": 2, "pair": 1, "surface_node": 3}

    def arrays(group, **more):
        return {
            field.name: random.standard_normal([(sizes | more)[dim] for dim in field.dims])
            for field in FIELDS
            if field.group == group
        }

    return Frame(
        time,
        arrays("particles", particle=sum(COUNT.values())),
        arrays("surface"),
        arrays("series"),
        {"ball-floor": {"pressure": random.standard_normal(5)}},
    )


#: A file with one output, at 0 s, whose group particles/ball is a link to that of victim.nc (made with h5py).
LINKED = (
    "c-rllKTq307{*^af8+)OX-Snrk#Ok<4F;u=I?yI{OhAOBN)SU;2|2MNEP@jyhLyFQJ61yK+Nnc7Mx{!fSo#IJ<Rj4g<0FX+RfjH="
    "_opOJ?7Q>(+;gWJ{BE<jF`1Z4$ch4jivV5c*MUI(^M}LgX0ax#U*tu0ClUz_36qdPqV4fn`YT06iFoJO?;iVu;4+zH%`tve61~_^"
    "xIYhcTtvFI3LicQ%+$s31dL&~zAZ5Olg}h6MeoRxB!wp(Nzt-*A1wekt3g_U^eOolV{?g2@M>>@YVU*b!e#VYm+BIW4C0{Bu12{~"
    "ufq(TJ+(r<#jPE)Qs1gp_UlHWY=ZilMi7A*A5bamn5=(3=)Zg5_BHacG|%yk;)Z6sM~>HbJD%1!_BF5L51US`o@+JQPDT^xKn=;{"
    "`BR|M=kHe>ziGF!Mfb?HAxZXwNI)KjxcBz)91n4RBt+@z5VaS;cU2y;6Og?ik;SH1h)cuWc2-hmSTM2-4}yE7pfZxFe0`<`o@t6q"
    "AvK(W(dqPT*Ry=5KR%HWuhPiYP|G~&X|fin(S;~))pubwSfey>TUR}WsWSXOIL%e7#^(0r+=OG=NbRU?>YJ9-X~~+oVb;uwVe*nW"
    "nU}OJ-|9R5u=eE=gOY?lPb@2s@Be#Wzn@S`s>w5(;@fJ!V!Y~gx=zn`Nm|tIVz9qXoF1*TzP9YKSl6?eRXwx1d|<bpuCHa*GWzq6"
    "=RZOxg7mj1!V~6I%?o?chShFABvsv}?;d5mCaiQVVyfA8`YW^zU>p7|pAHv)(nR8EemV*7QDVRm@x|wPqe%14rK^|0ahBVwE(3zx"
    "KuSin%(i`U{O}Ox^B~m!d>S)D5ClOG1VIo4L6DoqZp}0$`2E$ocpnf(*Fraf*J27ri697qAh(3G5-KVxDk>@}Dk>@}Dk>`K|EIqI"
    "g%$d)"
)


def test_results_that_link_to_another_file_are_refused_and_do_not_write_to_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with RunWriter("victim.nc", header()) as writer:
        writer.write(frame(0.0))
    before = (tmp_path / "victim.nc").read_bytes()
    content = np.frombuffer(zlib.decompress(base64.b85decode(LINKED)), np.uint8)
    with (
        pytest.raises(MpmfwError, match="damaged, or belongs to another run"),
        RunWriter("run.nc", header(), content) as writer,
    ):
        writer.write(frame(0.1))
    assert (tmp_path / "victim.nc").read_bytes() == before


@pytest.mark.parametrize("in_memory", [True, False])
def test_what_is_written_is_read(tmp_path, in_memory):
    frames = [frame(0.1 * k) for k in range(4)]
    with RunWriter(None if in_memory else tmp_path / "run.nc", header()) as writer:
        for one in frames:
            writer.write(one)
        writer.finish({"steps": 12, "cpu_time": 0.5})
    tree = writer.results()
    assert tree["time"].values.tolist() == [one.time for one in frames]
    for k, one in enumerate(frames):
        for name in one.particles.keys() - {"mass"}:
            np.testing.assert_array_equal(tree[f"particles/ball/{name}"][k], one.particles[name][:4])
            np.testing.assert_array_equal(tree[f"particles/floor/{name}"][k], one.particles[name][4:])
        for name, values in one.series.items():
            np.testing.assert_array_equal(tree[f"series/{name}"][k], values)
        np.testing.assert_array_equal(
            tree["contact/ball-floor/pressure"][k], one.contact["ball-floor"]["pressure"]
        )
        np.testing.assert_array_equal(tree["surface/ball/position"][k], one.surface["position"])
    np.testing.assert_array_equal(tree["particles/ball/mass"], frames[0].particles["mass"][:4])
    assert tree["surface/ball/next"].values.tolist() == [1, 2, 0]
    assert (tree.attrs["status"], tree.attrs["steps"], tree.attrs["settled"]) == ("ok", 12, 1)
    assert json.loads(tree.attrs["effects"]) == {"gravity": [0, -10]}
    assert "commit" not in tree.attrs
    assert float(
        tree["series"].to_dataset()["mean_velocity"].sel(body="floor", axis="y")[2]
    ) == pytest.approx(frames[2].series["mean_velocity"][1, 1])


@pytest.mark.skipif(not os.access("/proc/self/clear_refs", os.W_OK), reason="the system keeps one mark")
def test_peak_memory_is_of_the_time_since_the_mark():
    block = np.ones(20_000_000)
    high = peak_memory()
    del block
    restart_peak_memory()
    assert peak_memory() < high - 100_000_000


@pytest.mark.parametrize("interval", [1, 3])
def test_plain_xarray_opens_every_run(tmp_path, interval):
    """With and without points at every output, surfaces and contact, also while it is written."""
    path = tmp_path / "run.nc"
    with RunWriter(path, header(surface_count={"ball": 3, "floor": 5})) as writer:
        for k in range(7):
            one = frame(0.1 * k)
            one.surface = {name: np.resize(each, (8, *each.shape[1:])) for name, each in one.surface.items()}
            one.contact = {} if k < 2 else one.contact
            writer.write(one if k % interval == 0 else dataclasses.replace(one, particles={}))
            writer.flush()
            with xr.open_datatree(path) as begun:
                np.testing.assert_array_equal(begun["series/kinetic_energy"][k], one.series["kinetic_energy"])
        writer.finish({})
    with xr.open_datatree(path) as plain:
        xr.testing.assert_identical(plain.load(), open_results(path))
        assert set(plain.groups) == {
            "/", "/series", "/particles", "/particles/ball", "/particles/floor", "/surface", "/surface/ball",
            "/surface/floor", "/contact", "/contact/ball-floor",
        }  # fmt: skip
        assert plain["particles/floor/position"].dims == ("time", "particle", "axis")
        assert plain["particles/floor/position"].shape == (7 if interval == 1 else 3, 6, 2)
        assert plain["series/time"].size == plain["time"].size == plain["contact/ball-floor/time"].size == 7
        assert np.isnan(plain["contact/ball-floor/pressure"][:2]).all()
    with netCDF4.Dataset(path) as dataset:
        assert dataset["particles/ball/position"].filters()["zlib"] is False


def test_a_file_is_repeated_to_the_bit(tmp_path):
    with RunWriter(tmp_path / "a.nc", header()) as writer:
        for k in range(5):
            if k == 3:
                writer.flush()
                half = np.fromfile(tmp_path / "a.nc", np.uint8)
            one = frame(0.1 * k)
            one.contact = {} if k < 4 else one.contact  # a group that the copy has not
            writer.write(one if k % 2 == 0 else dataclasses.replace(one, particles={}))
    with RunWriter(tmp_path / "b.nc", header(), half) as writer:
        writer.write(dataclasses.replace(frame(0.1 * 3), particles={}, contact={}))
        writer.write(frame(0.1 * 4))
    with pytest.raises(MpmfwError, match="its copy of the results is damaged, or belongs to another run"):
        RunWriter(tmp_path / "c.nc", header(), half[:1000])
    xr.testing.assert_identical(open_results(tmp_path / "b.nc"), open_results(tmp_path / "a.nc"))


def test_series_at_nearest_steps_are_had_at_the_times_asked_for():
    recorded = 0.5 * np.array([0.0, 0.9, 2.1, 3.0])
    mean, linear = CONTACT_SERIES[0], SERIES_FIELDS[5]
    assert (mean.name, linear.name) == ("contact_force", "kinetic_energy")
    attributes = {"outputs": "nearest", "output_interval": 0.5}
    with RunWriter(None, header(attributes=attributes)) as writer:
        for k, time in enumerate(recorded):
            force, count = np.array([[2.0 * k, 0.0]]), np.array([float(k)])
            series = {
                "contact_force": force,
                "contact_count": count,
                "kinetic_energy": np.full(2, 0.5 + 3.0 * time),
            }
            writer.write(Frame(time, series=series))
        writer.finish({})
    tree = writer.results()
    series = series_at_outputs(tree)
    assert series["time"].values.tolist() == [0.0, 0.5, 1.0, 1.5]
    np.testing.assert_allclose(series["kinetic_energy"][:, 1], 0.5 + 3.0 * series["time"])
    np.testing.assert_allclose(
        series["contact_force"][:, 0, 0], [0.0, 0.9 * 2 + 0.1 * 4, 4.0, 0.1 * 4 + 0.9 * 6]
    )
    impulse = 0.5 * series["contact_force"].sum()  # as recorded
    assert impulse == pytest.approx(0.5 * (0.9 * 2 + 1.2 * 4 + 0.9 * 6))
    assert series["contact_count"].values[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert series["contact_force"].attrs == mean.attributes
    exact = header(attributes={"outputs": "exact", "output_interval": 1.0})
    with RunWriter(None, exact) as writer:
        writer.write(frame(0.0))
        writer.write(frame(0.9))
    assert series_at_outputs(writer.results())["time"].values.tolist() == [0.0, 0.9]


def test_times_of_two_runs_that_differ_by_rounding_are_one():
    times = np.linspace(0.0, 3e-3, 7)
    np.testing.assert_array_equal(union_of_times([times, times[::2] * (1.0 + 1e-12)]), times)


def test_a_body_whose_name_is_a_path_is_refused(tmp_path):
    with RunWriter(tmp_path / "run.nc", header()) as writer:
        writer.write(frame(0.0))
    with netCDF4.Dataset(tmp_path / "run.nc", "a") as dataset:
        dataset["body"][0] = "../../x"
    with pytest.raises(MpmfwError, match=r"run\.nc': the file was cut short or is damaged"):
        open_results(tmp_path / "run.nc")


def test_values_that_cannot_be_read_once_they_are_needed_are_told_in_one_line(tmp_path):
    with RunWriter(tmp_path / "run.nc", header()) as writer:
        writer.write(frame(0.0))
        writer.finish({})
    message = r"cannot read '.*run\.nc': the file was cut short or is damaged"
    with pytest.raises(MpmfwError, match=message), opened(tmp_path / "run.nc"):
        raise RuntimeError("NetCDF: HDF error")
