"""A body with contact of its own surface: parts of it meet as two bodies do."""

import numpy as np
import pytest
from test_restart import array_bytes

import mpmfw
from contact_scenes import CELL, MU, scene
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from msh_files import write_msh
from scenes_for_tests import body_of, with_changes

pytestmark = pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")

ARM = 5 * CELL  # m, thickness of a half
END = 0.4  # s
LUMPED = {"rotation": "lumped"}


def cells(lower, count, start=0):
    """Nodes and quadrilaterals of half a cell, ``count`` along each axis."""
    i, j = np.meshgrid(*(np.arange(n + 1) for n in count), indexing="ij")
    x, y = (low + 0.5 * CELL * k.ravel() for low, k in zip(lower, (i, j), strict=True))
    first = start + (count[1] + 1) * i[:-1, :-1].ravel() + j[:-1, :-1].ravel()
    return np.column_stack([x, y, 0 * x]), np.stack(
        [first, first + count[1] + 1, first + count[1] + 2, first + 1], axis=1
    )


def halves(folder, *, joined, gap=2.5, method="penalty", shape="cpdi"):
    """Two blocks, one held and one driven down by three cells; ``joined`` they are one body."""
    low, high = [0.0, 0.37 * CELL], [0.2 * CELL, 0.37 * CELL + ARM + gap * CELL]
    points, quads = cells(low, (16, 10))
    more, others = cells(high, (13, 10), len(points))

    def body(name, points, quads, *sides, **keys):
        path = write_msh(folder / f"{name}.msh", points, {"quad": quads})
        return body_of(
            {"type": "mesh", "path": str(path)}, 0.5 * CELL, layout="fitted", sides=sides, **LUMPED, **keys
        )

    held, driven = {"side": "bottom", "fixed": True}, {"side": "top", "velocity": [0.0, -3.0 * CELL / END]}
    bodies = {"low": body("low", points, quads, held), "high": body("high", *cells(high, (13, 10)), driven)}
    if joined:
        both = np.concatenate([points, more]), np.concatenate([quads, others])
        bodies = {"all": body("all", *both, held, driven, self_contact=True)}
    made = scene(bodies, friction=0.3, output={"ledger": True}, shape={"method": shape})
    made["contact"]["method"] = method
    made["grid"].update(lower=[-0.6, -0.6], upper=[1.4, 2.1])
    made["time"].update(end=END, output_interval=END / 20)
    return made


#: Ends of boxes [half-cells] that face each other widely, and in one cell at a corner.
WIDE = [[0, 1, 1], [7, 6, 9]], [[1, 11, 2], [6, 17, 8]]
NARROW = [[0, 1, 0], [8, 9, 8]], [[6, 11, 6], [14, 19, 14]]


def boxes(folder, ends, *, joined):
    """Two boxes in space, one held and one driven down; ``joined`` they are one body."""
    trimesh, h = pytest.importorskip("trimesh"), 0.5 * CELL
    low, high = (trimesh.creation.box(bounds=np.multiply(h, each)) for each in ends)
    down = (ends[1][0][1] - ends[0][1][1] + (1 if ends is WIDE else 3)) * h

    def body(name, mesh, *sides, **keys):
        mesh.export(folder / f"{name}.obj", digits=17)
        geometry = {"type": "surface_mesh", "path": str(folder / f"{name}.obj")}
        return body_of(geometry, h, sides=sides, **LUMPED, **keys)

    held = {"side": "bottom", "fixed": True}
    driven = {"side": "top", "velocity": [0.0, -down / END, 0.0]}
    bodies = {"low": body("low", low, held), "high": body("high", high, driven)}
    if joined:
        both = trimesh.util.concatenate([low, high])
        bodies = {"all": body("all", both, held, driven, self_contact=True)}
    made = scene(bodies, friction=0.3, shape={"method": "cpdi"})
    made["contact"]["method"] = "penalty"
    made["grid"].update(lower=[-0.6, -0.6, -0.6], upper=[1.4, 2.1, 1.4])
    made["time"].update(end=END, output_interval=END / 20)
    return made


def clip(**changes):
    """A C in flight whose upper arm is hit by a disc until its arms meet."""
    points = [[0, 0], [1.6, 0], [1.6, 0.4], [0.4, 0.4], [0.4, 0.7], [1.6, 0.7], [1.6, 1.1], [0, 1.1]]
    parts = {"clip": ({"type": "polygon", "points": points}, [1.0, 0.5])}
    parts["ball"] = {"type": "disc", "centre": [1.4, 1.42], "radius": 0.3}, [0.5, -9.0]
    size = {"size": 0.5 * CELL}
    bodies = {
        name: {"material": "firm", "geometry": shape, "particles": size, "velocity": v, "rotation": "lumped"}
        for name, (shape, v) in parts.items()
    }
    bodies["clip"]["self_contact"] = True
    made = scene(bodies, output={"ledger": True}, shape={"method": "cpdi"})
    made["materials"]["firm"].update(bulk_modulus=2.5e5, shear_modulus=1.2e5)
    made["contact"]["method"] = "penalty"
    made["grid"].update(lower=[-1.0, -2.5], upper=[3.0, 3.0])
    made["time"].update(end=0.08, output_interval=0.004)
    return with_changes(made, **changes)


def of_runs(*scenes):
    return [mpmfw.run(made)["series"].to_dataset() for made in scenes]


@pytest.mark.parametrize(
    ("method", "shape", "rtol"),
    [
        *(("penalty", shape, 1e-11) for shape in ("cpdi", "linear", "bspline")),
        *((method, "cpdi", 1e-11) for method in ("impulse", "hybrid", "barrier", "adhesion")),
        ("lcp", "cpdi", 1e-3),  # rows come in another order, and its passes end at a tolerance
    ],
)
def test_two_halves_of_one_body_are_two_bodies(tmp_path, method, shape, rtol):
    one, two = of_runs(*(halves(tmp_path, joined=j, method=method, shape=shape) for j in (True, False)))
    assert one.pair.values.tolist() == ["all-all"]
    force = two["contact_force"].values[:, 0]
    assert np.abs(force).max() > 1e3
    # at edges normals lean, and the force counts on what lies lower along their largest component
    lean = 0.02 if (method, shape) in (("penalty", "linear"), ("barrier", "cpdi")) else rtol
    assert np.allclose(one["contact_force"].values[:, 0], force, rtol=0.0, atol=lean * np.abs(force).max())
    for name in ("strain_energy", "kinetic_energy", "energy_residual"):
        if name in two:
            expected = two[name].values.reshape(len(two.time), -1).sum(axis=1)
            found = one[name].values.reshape(len(two.time), -1).sum(axis=1)
            assert np.allclose(
                found, expected, rtol=0.0, atol=rtol * np.abs(two["strain_energy"]).max().item()
            )
    # gaps are measured as far as nodes are divided
    gap = np.minimum(two["min_gap"].values[:, 0], one["min_gap"].values[0, 0])
    assert np.allclose(one["min_gap"].values[:, 0], gap, rtol=0.0, atol=0.05 * rtol**0.5 * CELL)
    assert (one["contact_count"].values[two["min_gap"].values > 0.5 * CELL] == 0.0).all()


@pytest.mark.parametrize("ends", [WIDE, NARROW], ids=["wide", "narrow"])
def test_in_space_too(tmp_path, ends):
    """Facets have another order, which decides between equally near ones."""
    one, two = of_runs(*(boxes(tmp_path, ends, joined=joined) for joined in (True, False)))
    force, expected = (each["contact_force"].values[:, 0, 1] for each in (one, two))
    assert expected.min() < -200.0  # on the lower part
    assert np.allclose(force, expected, rtol=0.0, atol=1e-3 * np.abs(expected).max())
    strain, expected = (each["strain_energy"].values.sum(axis=1) for each in (one, two))
    free = two["contact_count"].values[:, 0] == 0.0
    assert np.allclose(strain[free], expected[free], rtol=1e-11, atol=0.0)
    assert np.allclose(strain, expected, rtol=0.0, atol=1e-4 * expected.max())
    assert np.allclose(one["min_gap"], two["min_gap"], rtol=0.0, atol=0.01 * CELL)


def test_about_an_axis_too(tmp_path):
    made = [halves(tmp_path, joined=joined) for joined in (True, False)]
    for each in made:
        each["grid"].update(axisymmetric=True, lower=[0.0, -0.6])
        for body in each["bodies"].values():
            del body["rotation"]
    one, two = of_runs(*made)
    force, expected = (each["contact_force"].values[:, 0] for each in (one, two))
    assert np.abs(expected).max() > 1e3
    assert np.allclose(force, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


def test_arms_of_a_free_body_meet():
    tree = mpmfw.run(clip())
    series = tree["series"].to_dataset()
    assert tree.attrs["status"] == "ok"
    own = series.sel(pair="clip-clip")
    assert (own["contact_force"].values[own["min_gap"].values > 0.4 * CELL] == 0.0).all()
    assert np.abs(own["contact_force"].values).max() > 1e3
    assert -0.3 * CELL < own["min_gap"].values.min() < 0.0
    momentum = series["linear_momentum"].sum("body").values
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.abs(momentum).max()
    energy = series["total_energy"].sum("body").values
    assert energy.max() <= 1.001 * energy[0]
    assert "contact with itself" not in str(tree.attrs.get("warnings", ""))


@pytest.mark.parametrize(
    ("own", "other"),
    [
        ({"friction": 0.0}, {"friction": 0.6}),
        ({"method": "penalty", "penalty": {"kappa": 2.0}}, {"method": "lcp"}),
    ],
    ids=["friction", "method"],
)
def test_a_pair_of_a_body_with_itself_has_its_own_contact(own, other):
    """The same, whether the scene's contact is that of the pair with itself or of the other."""
    made = clip(output__ledger=False)["contact"]
    of_ball, of_both = {**made, **other}, {**made, **own}
    contacts = ({**of_ball, "pairs": {"clip-clip": own}}, {**of_both, "pairs": {"clip-ball": other}}, of_ball)
    one, same, without = of_runs(*(clip(contact=each) for each in contacts))
    assert np.abs(one["contact_force"].sel(pair="clip-clip")).max() > 1e3
    for name in ("contact_force", "total_energy", "frictional_work"):
        np.testing.assert_allclose(one[name], same[name], rtol=1e-9, atol=1e-9)
    assert abs(float((one["contact_force"] - without["contact_force"]).sel(pair="clip-clip").max())) > 100.0


@pytest.mark.parametrize("first", [0, 3])
def test_a_slit_closes_under_pressure(first):
    """Its faces meet, and bear no force as long as they are apart, wherever the outline begins."""
    h = CELL
    points = [[0, 0], [20, 0], [20, 5], [12, 5], [4, 5], [4, 8], [20, 8], [20, 13], [0, 13]]
    points = points[first:] + points[:first]
    block = {
        "material": "soft",
        "geometry": {"type": "polygon", "points": [[x * h, y * h] for x, y in points]},
        "particles": {"size": 0.5 * h},
        "self_contact": True,
        "sides": [{"side": "bottom", "fixed": True}, {"side": "top", "pressure": [[0.0, 0.0], [0.8, 6e3]]}],
    }
    made = scene({"block": block}, shape={"method": "cpdi"})
    made["materials"]["soft"]["damping"] = {"bulk": "5 ms", "shear": "5 ms"}
    made["contact"]["method"] = "penalty"
    made["grid"].update(lower=[-0.6, -0.6], upper=[2.6, 1.9])
    made["time"].update(end=1.0, output_interval=0.05)
    tree = mpmfw.run(made)
    own = tree["series"].to_dataset().sel(pair="block-block")
    assert tree.attrs["status"] == "ok"
    assert (own["contact_force"].values[own["min_gap"].values > 0.1 * h] == 0.0).all()
    assert abs(own["min_gap"].values[-1]) < 0.1 * h
    force = own["contact_force"].values[-1, 1]
    assert force < -100.0  # on the lower part
    assert force == pytest.approx(-10226.32, rel=1e-4)


@pytest.mark.parametrize("threads", [1, 3])
def test_a_restart_and_threads_give_the_same_bits(threads):
    made = clip(time__end=1.0)
    whole, half = Simulation(made), Simulation(made)
    whole.advance(110)
    half.advance(95)
    assert half.state.pairs[0].label == "clip-clip"
    assert half.state.arrays["penalty/count"][0] > 0.0
    other = Simulation(made, threads=threads)
    other.restore(half.snapshot())
    other.advance(15)
    assert array_bytes(other.snapshot()).keys() == array_bytes(whole.snapshot()).keys()
    for name, value in array_bytes(whole.snapshot()).items():
        assert "clock" in name or array_bytes(other.snapshot())[name] == value, name


@pytest.mark.parametrize(
    ("changes", "key", "message"),
    [
        ({"contact__method": "bardenhagen"}, "bodies.clip.self_contact", "finds other bodies alone"),
        ({"contact__method": "none"}, "bodies.clip.self_contact", "finds other bodies alone"),
        ({"contact__method": "hamad2017"}, "bodies.clip.self_contact", "finds other bodies alone"),
        *(
            ({"contact__pairs": {"clip-ball": {"method": name}}}, "bodies.clip.self_contact", "second nodes")
            for name in ("bardenhagen", "tied", "nodes+lcp")
        ),
        ({"contact__pairs": {"ball-ball": {"friction": 0.1}}}, "contact.pairs.ball-ball", "not 'ball' twice"),
        ({"contact__pairs": {"clip-clip": {"method": "tied"}}}, "bodies.clip.self_contact", "tied' finds"),
        ({"shape__method": "cpdi2"}, "bodies.clip.self_contact", "cannot be divided"),
        ({"bodies__clip__volumetric": "averaged"}, "bodies.clip.self_contact", "pointwise"),
        ({"bodies__clip__rotation": "spin"}, "bodies.clip.rotation", "'exact' or 'lumped'"),
        ({"sleep": {}}, "sleep", "self_contact"),
    ],
)
def test_what_cannot_go_with_it_is_refused(changes, key, message):
    with pytest.raises(SceneError, match=message) as error:
        Simulation(clip(**changes))
    assert key in str(error.value)


def test_a_single_body_needs_a_contact():
    made = clip()
    del made["bodies"]["ball"], made["contact"]
    with pytest.raises(SceneError, match="contact: missing"):
        Simulation(made)


def test_a_body_with_itself_is_one_of_the_scenes_pairs():
    """By which studies take a pair's name, and records its friction."""
    made = mpmfw.load_scene(clip(contact__pairs={"clip-clip": {"friction": 0.5}}))
    assert made.pairs == (("clip", "ball", MU), ("clip", "clip", 0.5))
