"""Pairs of bodies with contacts of their own beside that of the scene, and ties."""

import numpy as np
import pytest

from contact_scenes import CELL, MU, STEP, rectangle, scene, three_meet
from mpmfw.cli.explain import unused_facts
from mpmfw.errors import SceneError, SimulationError
from mpmfw.kernels.contact import relative_motion
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import CONTACT_SERIES

#: Two blocks that meet with slip, and far away two others, one of which is at rest.
MEET = {
    "a": rectangle([-0.85, 0.4], [-0.45, 0.8], velocity=[1.0, 0.3]),
    "b": rectangle([-0.44, 0.35], [-0.04, 0.75], kind="stiff", velocity=[-0.5, 0.0]),
}
TORN = {
    "c": rectangle([0.1, -0.6], [0.5, -0.2], velocity=[0.0, 0.0]),
    "d": rectangle([0.5, -0.6], [0.9, -0.2], velocity=[1.0, 0.5]),
}


def made(bodies, pairs=None, method="penalty", friction=0.3, step=None, **keys):
    """A simulation of the bodies, started."""
    mapping = scene({k: b for k, b in bodies.items() if "rigid" not in b}, friction=friction, **keys)
    mapping["bodies"] = bodies
    if step is not None:
        mapping["time"]["step"] = step
    contact = {"method": method, "friction": friction} | ({"pairs": pairs} if pairs else {})
    simulation = Simulation({**mapping, "contact": contact})
    simulation.start()
    return simulation


def points_of(simulation, names):
    """Positions, velocities and stresses of bodies."""
    p = simulation.state.particles
    slices = [b.particles for b in simulation.state.bodies if b.name in names]
    return [np.concatenate([array[s] for s in slices]) for array in (p.position, p.velocity, p.stress)]


def momentum(simulation):
    p = simulation.state.particles
    v, m = p.velocity, p.mass[:, None]
    x = p.position
    return np.append((m * v).sum(0), (m[:, 0] * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])).sum())


@pytest.mark.parametrize(
    ("pair", "names"),
    [
        ({"c-d": {"method": "tied"}}, ("penalty", "tied")),
        ({"c-d": {"method": "lcp"}}, ("penalty", "lcp")),
        ({"c-d": {"detection": "nodes", "law": "impulse"}}, ("penalty", "nodes+impulse")),
        ({"d-c": {"method": "bardenhagen"}}, ("lcp", "bardenhagen")),
        ({"c-d": {"method": "barrier"}}, ("penalty", "barrier")),
    ],
    ids=lambda value: value[-1] if isinstance(value, tuple) else "",
)
def test_groups_of_bodies_move_as_in_scenes_of_their_own(pair, names):
    both = made({**MEET, **TORN}, pair, names[0])
    apart = [made(MEET, method=names[0]), made(TORN, method=names[1])]
    for _ in range(60):
        for one in (both, *apart):
            one.step(STEP)
    for one, bodies in zip(apart, (MEET, TORN), strict=True):
        for found, expected in zip(points_of(both, bodies), points_of(one, bodies), strict=True):
            np.testing.assert_array_equal(found, expected)
    labels = [pair.label for pair in both.state.pairs]
    series = both.frame().series
    for one, label in zip(apart, ("a-b", "c-d"), strict=True):
        for field in CONTACT_SERIES:
            own = one.frame().series[field.name][0]
            np.testing.assert_array_equal(series[field.name][labels.index(label)], own)
    assert np.all(series["contact_count"][[labels.index("a-c"), labels.index("b-d")]] == 0.0)


def moved(bodies, steps=150, **keys):
    """The simulation after some steps, and the change of its momenta over the largest."""
    simulation = made(bodies, **keys)
    before = momentum(simulation)
    for _ in range(steps):
        simulation.step(STEP)
    return simulation, np.abs(momentum(simulation) - before).max() / np.abs(before).max()


def slip(simulation, tie):
    """Largest relative velocity [m/s] in the rows of a tie, with which points and surfaces moved."""
    grid, rows = simulation.state.grid, tie.rows
    velocity = np.zeros((rows.count, grid.dim))
    relative_motion(rows, rows.count, grid.velocity, 1.0, velocity, grid.spacing)
    assert rows.count > 5
    return np.abs(velocity).max()


LUMPED = {name: {**body, "rotation": "lumped"} for name, body in TORN.items()}
#: Three blocks, of which two share every node with a third.
THREE = {
    "l": rectangle([-0.4, -0.4], [0.0, 0.0], velocity=[0.0, 0.0], rotation="lumped"),
    "r": rectangle([0.0, -0.4], [0.4, 0.0], kind="stiff", velocity=[1.0, 0.0], rotation="lumped"),
    "t": rectangle([-0.2, 0.0], [0.2, 0.4], velocity=[0.0, 1.0], rotation="lumped"),
}


@pytest.mark.parametrize("bodies", [LUMPED, THREE], ids=["two", "three"])
@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
def test_a_tie_leaves_no_relative_velocity(bodies, scheme):
    tied, change = moved(bodies, 30, method="tied", stepping={"scheme": scheme})
    assert change < 1e-2  # of momentum and angular momentum, which MUSL does not keep
    assert slip(tied, tied.contact) < 1e-11


def test_ties_that_do_not_converge_end_the_run(monkeypatch):
    monkeypatch.setattr("mpmfw_contact.tied.cg", lambda _, b, **__: (0.0 * b, 1))
    with pytest.raises(SimulationError, match="impulses of ties do not converge"):
        moved(TORN, 1, method="tied")


def test_a_tie_holds_as_the_grid_itself_does():
    tied, change = moved(TORN, method="tied")
    none, _ = moved(TORN, method="none")
    free, _ = moved(TORN, method="separate")
    assert change < 1e-3  # of the angular momentum; of momentum
    np.testing.assert_allclose(momentum(tied)[:2], momentum(free)[:2], rtol=1e-12)
    assert abs(tied.frame().series["min_gap"][0]) < 2e-3 * CELL
    assert free.frame().series["min_gap"][0] > 1.4 * CELL
    differs = np.linalg.norm(points_of(tied, TORN)[0] - points_of(none, TORN)[0], axis=1)
    assert differs.max() < 0.1 * CELL


def test_a_tie_holds_a_free_rigid_body():
    bodies = {
        "c": {**TORN["c"], "rotation": "lumped"},
        "ball": {
            "geometry": {"type": "disc", "centre": [0.3, 0.0], "radius": 0.2},
            "rigid": {"density": 2000.0},
            "velocity": [0.0, 1.0],
        },
    }
    tied, free = made(bodies, method="tied"), made(bodies, method="separate")
    for _ in range(150):
        tied.step(STEP)
        free.step(STEP)
    assert slip(tied, tied.contact) < 1e-9
    assert tied.frame().series["min_gap"][0] < 0.05 * CELL < free.frame().series["min_gap"][0]


@pytest.mark.parametrize("scheme", ["usl", "musl"])
@pytest.mark.parametrize("motion", [{"rigid": True}, {"rigid": {"density": 1e3, "held": ["y", "rotation"]}}])
def test_laws_against_one_rigid_body_act_as_in_runs_apart(motion, scheme):
    """The second law finds the floor as it moves, and not with what the first one did to it."""
    floor = {"geometry": {"type": "rectangle", "lower": [-1.0, -0.5], "upper": [1.0, -0.2]}, **motion}
    fall = {"velocity": [0.0, -1.0]}
    a = rectangle([-0.85, -0.19], [-0.45, 0.21], **fall)
    b = rectangle([0.2, -0.19], [0.6, 0.21], **fall)

    def last(bodies, method, pairs=None):
        frames, keys = [], {"output": {"ledger": True}, "stepping": {"scheme": scheme}}
        simulation = made(bodies, pairs, method, friction=0.0, step=STEP, **keys)
        simulation.advance(60, frames.append)
        labels = [pair.label for pair in simulation.state.pairs]
        return dict(zip(labels, sum(frame.series["contact_force"] for frame in frames), strict=True)), frames

    force, frames = last({"a": a, "b": b, "f": floor}, "lcp", {"b-f": {"method": "bardenhagen"}})
    apart = [last({"a": a, "f": floor}, "lcp"), last({"b": b, "f": floor}, "bardenhagen")]
    assert force["b-f"][1] > 1e3
    assert force["a-f"] == pytest.approx(apart[0][0]["a-f"], rel=1e-9, abs=1e-6)
    assert force["b-f"] == pytest.approx(apart[1][0]["b-f"], rel=1e-9, abs=1e-6)
    reaction = sum(frame.series["reaction"][-1] for frame in frames)
    assert reaction == pytest.approx(-force["a-f"] - force["b-f"], rel=1e-9, abs=1e-6)
    kinetic = [each[1][-1].series["kinetic_energy"][0] for each in apart]
    assert frames[-1].series["kinetic_energy"][:2] == pytest.approx(kinetic, rel=1e-9)


def test_laws_against_one_free_rigid_body_keep_momentum_and_give_no_energy():
    ball = {"geometry": {"type": "disc", "centre": [0.0, 0.0], "radius": 0.3}, "rigid": {"density": 500.0}}
    bodies = {
        "a": rectangle([-0.72, -0.1], [-0.32, 0.3], velocity=[1.0, 0.0]),
        "b": rectangle([-0.2, 0.32], [0.2, 0.72], velocity=[0.0, -1.0]),
        "ball": ball,
    }
    simulation, frames = made(bodies, {"b-ball": {"method": "impulse"}}, "lcp", output={"ledger": True}), []
    simulation.advance(100, frames.append)
    momentum = np.array([frame.series["linear_momentum"].sum(axis=0) for frame in frames])
    energy = [
        sum(frame.series[name].sum() for name in ("kinetic_energy", "strain_energy")) for frame in frames
    ]
    assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.abs(momentum[0]).max()
    assert frames[-1].series["kinetic_energy"][-1] > 1.0
    assert max(energy) < 1.0001 * energy[0]


def test_pairs_have_friction_springs_and_warnings_of_their_own():
    pairs = {
        "a-b": {"friction": 0.1, "method": "penalty", "penalty": {"kappa": 2.0}},
        "c-d": {"method": "tied"},
    }
    simulation = made({**MEET, **TORN}, pairs)
    mu = {pair.label: pair.mu for pair in simulation.state.pairs}
    assert (mu["a-b"], mu["a-c"]) == (0.1, 0.3)
    assert simulation.contact.label == "penalty; a-b: penalty(kappa=2.0); c-d: tied"
    assert [line for line in unused_facts(simulation) if "friction" in line] == [
        "friction of c-d: 'pairs.c-d.tied' has none"
    ]
    assert [each.kappa for each in simulation.contact.contacts[:2]] == [4.0, 2.0]
    labels = [pair.label for pair in simulation.state.pairs]
    yields = dict(zip(labels, simulation.contact.compliance(), strict=True))
    assert (yields["a-b"] / yields["a-c"], yields["c-d"]) == (2.0, 0.0)


def test_pairs_with_the_same_contact_and_the_ledger_are_as_with_one():
    bodies = {**MEET, "c": rectangle([-0.34, -0.06], [0.06, 0.34], velocity=[0.0, 1.0])}
    last = {}
    for title, pairs in {
        "one": None,
        "same": {"b-c": {"method": "penalty", "penalty": {"kappa": 4.0}}},
        "softer": {"b-c": {"method": "penalty", "penalty": {"kappa": 1.0}}},
        "tied": {"b-c": {"method": "tied"}},
    }.items():
        frames, simulation = [], made(bodies, pairs, output={"ledger": True}, step=0.5 * STEP)
        simulation.advance(150, frames.append)
        count = np.max([frame.series["contact_count"] for frame in frames], axis=0)
        assert [count[pair.index] > 5 for pair in simulation.state.pairs] == [True, False, True]
        last[title] = frames[-1].series
    for name in (
        "contact_residual",
        "contact_work",
        "spring_work",
        "frictional_work",
        "contact_half_step_work",
    ):
        np.testing.assert_allclose(last["same"][name], last["one"][name], rtol=1e-6, atol=1e-9)
        if name in last["tied"]:
            assert np.abs(last["softer"][name] - last["one"][name]).max() > 0.01
    # ties do not record the energy that they take
    assert not {"spring_work", "contact_residual"} & last["tied"].keys()


@pytest.mark.parametrize(
    ("contact", "message"),
    [
        ({"pairs": {"a-x": {"method": "tied"}}}, r"contact\.pairs\.a-x\.bodies\[1\]: .*no such body"),
        ({"pairs": {"a": {"method": "tied"}}}, r"contact\.pairs\.a: expected the names of two bodies"),
        ({"pairs": {"a-b": {}}}, r"contact\.pairs\.a-b: expected friction, a method"),
        ({"pairs": {"a-b": {"method": "teid"}}}, r"contact\.pairs\.a-b\.method: .*did you mean 'tied'"),
        ({"pairs": {"a-b": {"detection": "points", "law": "impulse"}}}, "'points' acts between all"),
        ({"pairs": {"a-b": {"method": "tied", "penalty": {}}}}, r"a-b\.penalty: has no effect"),
        ({"pairs": {"a-b": {"penalty": {}}}}, r"pairs\.a-b\.method: missing; expected method"),
        ({"pairs": {"a-b": 3}}, r"contact\.pairs\.a-b: expected a table with friction, method, .* not 3"),
        ({"pairs": "tied"}, r"contact\.pairs: expected tables \[contact\.pairs\.a-b\] of two bodies"),
        ({"pairs": [3]}, r"contact\.pairs\[0\]: expected a table with bodies, friction, method"),
        (
            {"pairs": {"a-b": {"friction": 0.1}, "b-a": {"method": "tied"}}},
            r"contact\.pairs\.b-a\.bodies: the same bodies as the pair 'a-b' before",
        ),
        (
            {"pairs": {"a-b": {"method": "tied", "pairs": {}}}},
            r"a-b\.pairs: unknown key; valid keys: ",
        ),
        ({"pairs": {"a-b": {"method": "none"}}}, "'none' has no detection and acts between all bodies"),
        (
            {"method": "separate", "pairs": {"a-b": {"method": "tied"}}},
            r"contact\.method: 'separate' has no detection",
        ),
        (
            {"pairs": {"a-b": {"method": "penalty", "penalty": {"map": "mass_weighted"}}}},
            "contacts with map mass_weighted and plain; expected one",
        ),
        (
            {"pairs": {"a-b": {"method": "penalty", "penalty": {"passes": "one", "master": "c"}}}},
            r"contact\.pairs\.a-b: the master 'c' is not of this pair; expected a or b",
        ),
    ],
)
def test_bad_contacts_of_pairs_are_refused(contact, message):
    mapping = scene(MEET)
    with pytest.raises(SceneError, match=message):
        Simulation({**mapping, "contact": {"method": "penalty", **contact}})


def test_a_corner_that_meets_a_tie_overlaps_as_little_as_on_one_body():
    """Of ``lcp``, which leaves no overlap, where a tie acts after it at the same nodes."""
    meet = three_meet(friction=MU)
    simulation = made(meet["bodies"], {"left-right": {"method": "tied"}}, "lcp", materials=meet["materials"])
    least = []
    for _ in range(120):
        simulation.step(STEP)
        least.append(simulation.frame().series["min_gap"][1:].min())
    assert -0.01 * CELL < min(least) < 0.01 * CELL


def test_two_rigid_bodies_need_a_law_that_acts_between_them():
    ball = {
        "geometry": {"type": "disc", "centre": [0.3, 0.9], "radius": 0.1},
        "rigid": {"density": 2000.0},
    }
    bodies = {
        "a": MEET["a"],
        "p": ball,
        "q": {**ball, "geometry": {**ball["geometry"], "centre": [0.3, 0.6]}},
    }
    with pytest.raises(SceneError, match=r"pairs.p-q: contact between two rigid bodies"):
        made(bodies, {"p-q": {"method": "penalty"}})
    with pytest.raises(SceneError, match=r"pairs.p-q: contact between two rigid bodies"):
        made(bodies, {"p-q": {"method": "tied"}}, method="lcp")
    made(bodies, {"p-q": {"method": "impulse"}}, method="lcp")
    made(bodies, {"p-q": {"method": "lcp"}, "a-p": {"method": "tied"}})
    one = made(bodies, {"a-p": {"method": "tied"}}, method="lcp")
    assert [pair.label for pair in one.state.pairs] == ["a-p", "a-q", "p-q"]
    assert one.setup.plugin("rigid_pairs") is None
    kept = made(bodies, {"a-p": {"method": "lcp"}}).setup.plugin("rigid_pairs")
    assert [label for *_, label in kept.pairs] == ["penalty"] * 2


def test_pairs_may_be_an_array_and_lie_in_a_file(tmp_path):
    array = [{"bodies": ["b", "a"], "method": "tied"}, {"bodies": ["c", "d"], "friction": 0.0}]
    loaded = load_scene({**scene({**MEET, **TORN}), "contact": {"method": "penalty", "pairs": array}})
    assert [(pair.method, pair.friction) for pair in loaded.contact.pairs] == [("tied", None), (None, 0.0)]
    path = tmp_path / "pairs.toml"
    path.write_text(load_scene({**scene(MEET), "contact": {"method": "penalty"}}).text)
    with path.open("a") as file:
        file.write('\n[contact.pairs.a-b]\nmethod = "penalty"\npenalty.kapa = 1.0\n')
    with pytest.raises(SceneError, match=r"pairs\.toml:\d+: contact\.pairs\.a-b\.penalty\.kapa"):
        load_scene(path)
