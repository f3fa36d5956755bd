"""Contact pressure and traction on surface nodes: closed forms, areas at edges, figures and messages."""

import numpy as np
import pytest

import mpmfw
from command_line import called
from mpmfw.errors import SceneError
from mpmfw.geometry.solid import box_surface
from mpmfw.results.fields import LEVEL, carried_areas, pressed_bodies
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import DENSITY, ball_on_a_box, scene_of, solid, with_changes

FRICTION, TILT = 0.2, 0.5
GRAVITY = 10.0 * np.array([np.sin(TILT), -np.cos(TILT)])


def sliding(**changes):
    """A block of 1 m x 0.5 m that slides down a rigid plane, from rest on it."""
    plane = {"geometry": {"type": "rectangle", "lower": [-1.0, -0.3], "upper": [2.0, 0.013]}, "rigid": True}
    bodies = {"block": solid([0.0, 0.013], [1.0, 0.513], 0.05, layout="fitted"), "plane": plane}
    scene = scene_of(
        bodies, 0.1, [-1.0, -0.5], [2.0, 1.0], end=0.1, outputs=2,
        contact={"method": "penalty", "friction": FRICTION}, gravity={"vector": GRAVITY.tolist()},
        settle={"gravity": {"vector": [0.0, float(GRAVITY[1])]}, "tolerance": 1e-4},
    )  # fmt: skip
    return with_changes(scene, **changes)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """File of the block's run."""
    path = tmp_path_factory.mktemp("contact") / "block.nc"
    mpmfw.run(sliding(), output=path)
    return path


@pytest.fixture(scope="module")
def space():
    """A run in space."""
    return mpmfw.run(ball_on_a_box())


def along(values):
    """Places and values on the underside, from left to right."""
    low = values["y"].values < values["y"].values.min() + 0.01
    order = np.argsort(values["x"].values[low])
    return values["x"].values[low][order], values.values[low][order]


def test_the_mean_pressure_is_the_weight_over_the_area(file):
    pressure = mpmfw.field(file, "contact_pressure", time=0.0)
    assert (pressure.dims, pressure.attrs["units"]) == (("surface_node",), "Pa")
    assert set(pressure["body"].values) == {"block"}  # the plane is rigid
    x, values = along(pressure)
    assert np.trapezoid(values, x) == pytest.approx(-DENSITY * 0.5 * GRAVITY[1], rel=5e-3)
    assert (values > 0.0).all()
    assert np.count_nonzero(pressure) == len(values)


def test_the_traction_is_that_of_friction_and_against_the_motion(file):
    pressure, size, x = (
        mpmfw.field(file, name) for name in ("contact_pressure", "contact_traction", "contact_traction_x")
    )
    pressed = along(pressure)[1]
    assert np.count_nonzero(pressed) > 30
    for values, expected in ((along(size)[1], FRICTION * pressed), (along(x)[1], -FRICTION * pressed)):
        np.testing.assert_allclose(values, expected, rtol=1e-2)  # the side leans under the front edge
        assert values.sum() == pytest.approx(expected.sum(), rel=1e-3)


def test_a_thin_block_has_the_same_pressure(file):
    thin = mpmfw.run(sliding(bodies__block__thickness=0.25, time__end=0.05))
    for name in ("contact_pressure", "contact_traction"):
        np.testing.assert_allclose(
            mpmfw.field(thin, name, time=0.05), mpmfw.field(file, name, time=0.05), rtol=1e-5, atol=1.0
        )


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")  # settling is cut short
@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
@pytest.mark.parametrize("method", ["penalty", "lcp", "impulse", "hybrid"])
def test_the_forces_of_nodes_add_up_to_that_of_contact(method, scheme):
    changed = sliding(contact__method=method, stepping={"scheme": scheme}, settle__max_time=0.02)
    simulation, sums = Simulation(changed), []

    def add(frame):
        surface, force = simulation.state.surface, frame.surface["force"]
        both = [force[surface.of(body.index)].sum(axis=0) for body in simulation.state.bodies]
        sums.append([*both, frame.series["contact_force"][0]])

    simulation.advance(10, add)
    block, plane, contact = np.array(sums)[1:].swapaxes(0, 1)
    assert np.abs(contact).max() > 1e3
    np.testing.assert_allclose(block, contact, atol=1e-9)
    np.testing.assert_allclose(plane, -contact, atol=1e-9)


def test_impulses_give_the_pressure_of_the_weight():
    run = mpmfw.run(sliding(time={"end": 1e-4, "output_interval": 1e-4}), contact="lcp")
    x, values = along(mpmfw.field(run, "contact_pressure", time=0.0))
    assert np.trapezoid(values, x) == pytest.approx(-DENSITY * 0.5 * GRAVITY[1], rel=5e-3)


def test_the_pressure_under_a_cylinder_on_its_axis_is_that_of_its_rings():
    scene = sliding(
        grid__axisymmetric=True, grid__lower=[0.0, -0.5], gravity__vector=[0.0, -10.0],
        settle__gravity={"vector": [0.0, -10.0]}, time={"end": 1e-4, "output_interval": 1e-4},
    )  # fmt: skip
    r, values = along(mpmfw.field(mpmfw.run(scene), "contact_pressure", time=0.0))
    radius = r[-1]
    assert np.trapezoid(values * r, r) / (0.5 * radius**2) == pytest.approx(DENSITY * 5.0, rel=5e-3)
    assert values[0] == pytest.approx(values[1], rel=0.1)


def test_one_side_of_an_edge_carries_a_force():
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    facets = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    area, normal = carried_areas(np.array([[0.6, 1.0], [0.6, 1.0], [-1.0, 0.6], [0.0, 0.0]]), square, facets)
    np.testing.assert_allclose(area[:3], [1.0, 1.0, 0.5])
    np.testing.assert_allclose(normal[:3], [[0.0, -1.0], [0.0, -1.0], [1.0, 0.0]])
    nodes, triangles = box_surface(np.zeros(3), np.ones(3), 0.25)
    area, normal = carried_areas(np.tile([0.0, 1.0, 0.0], (len(nodes), 1)), nodes, triangles)
    below = nodes[:, 1] < 1e-9
    assert area[below].sum() == pytest.approx(1.0)
    np.testing.assert_allclose(normal[below], np.tile([0.0, -1.0, 0.0], (below.sum(), 1)), atol=1e-12)
    for turned, carried in ((0.9 * np.arccos(LEVEL), 2.0), (1.1 * np.arccos(LEVEL), 1.0)):
        bent = np.array([[-2.0, 0.0], [0.0, 0.0], [2.0 * np.cos(turned), 2.0 * np.sin(turned)], [0.0, 9.0]])
        area, _ = carried_areas(np.tile([0.0, 1.0], (4, 1)), bent, facets)
        expected = 1.0 if carried == 1.0 else 2.0 * np.cos(0.5 * turned)
        assert area[1] == pytest.approx(expected)


def test_the_command_draws_curves_and_maps(file, space, monkeypatch):
    monkeypatch.chdir(file.parent)
    result = called("plot", "block.nc", "--field", "contact_pressure", "--limits", "0,9e3")
    assert (result.stdout, result.stderr) == ("block-contact_pressure.png\n", "")
    _, curves = mpmfw.plots.side_by_side({"one": file, "two": file}, "contact_traction").axes
    assert curves.get_ylabel() == "contact traction [kPa]"
    _, values = along(mpmfw.field(file, "contact_traction"))
    assert [np.nanmax(line.get_ydata()) for line in curves.lines] == pytest.approx([1e-3 * values.max()] * 2)
    ball, *_, bar = mpmfw.plots.field(space, "contact_pressure", bodies=["ball", "solid"]).axes
    assert bar.get_ylabel() == "contact pressure [kPa]"
    drawn = ball.collections[0].get_array()
    np.testing.assert_allclose(1e3 * drawn, mpmfw.field(space, "contact_pressure", body="ball"))


def test_what_cannot_be_drawn_gets_one_message(file, tmp_path):
    draw, bare = mpmfw.plots.field, mpmfw.run(sliding(time__end=0.05), contact="bardenhagen")
    for call, message in (
        (lambda: draw(bare, "contact_pressure"), "surface nodes: contact at grid nodes and midplane act"),
        (lambda: mpmfw.field(file, "contact_pressur"), "did you mean 'contact_pressure'"),
        (lambda: mpmfw.field(file, "contact_traction_z"), "did you mean 'contact_traction"),
        (lambda: draw(file, "contact_pressure", bodies=["top"]), "no body 'top'; one of block, plane"),
        (lambda: draw(file, "contact_pressure", arrows=True), "arrows: have no effect"),
        (lambda: draw(file, "contact_pressure", plane=("z", None)), "plane: has no effect"),
        (lambda: mpmfw.animate(file, tmp_path / "a.gif", "contact_pressure"), "is on surface nodes"),
    ):
        with pytest.raises(SceneError, match=message):
            call()
    assert pressed_bodies(mpmfw.open(file), "plane") == ["plane"]
    free = sliding(bodies__block__geometry__lower=[0.0, 0.4], time={"end": 1e-3, "output_interval": 1e-3})
    del free["settle"]
    with pytest.raises(SceneError, match="no contact force acts at this output"):
        draw(mpmfw.run(free), "contact_pressure")
