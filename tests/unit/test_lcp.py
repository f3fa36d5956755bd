"""Impulses of all rows at once, against plain NumPy and a solver of another kind."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import mpmfw
from contact_scenes import CELL, disc, impact, rectangle, run, scene
from interpreted import interpreted
from mpmfw.contact.rows import ContactRows
from mpmfw.errors import ResultsWarning
from mpmfw.runs.simulation import Simulation
from mpmfw_contact import lcp
from mpmfw_contact._gauss_seidel import ROUNDING, add_friction_work, solve, state_problem
from mpmfw_contact.lcp import LcpContact

DT = 0.1


def problem(seed, dim, count=30, *, couples=False, tilts=False, friction=0.0, nodes=40):
    """Rows between two bodies of ``nodes`` grid nodes each, with random normals about one axis."""
    rng = np.random.default_rng(seed)
    own = LcpContact().row_arrays(friction=True)
    rows = ContactRows(dim, couples=couples, tilts=tilts, own=own)
    rows.allocate_friction(cohesion=False)
    rows.make_room(count, 6 * count)
    rows.count = count
    rows.pair[:] = rng.integers(0, 2, count)
    rows.friction[:] = np.array([friction, 2.0 * friction])[rows.pair]
    rows.identity[:] = np.arange(count)
    rows.gap[:] = DT * rng.uniform(-0.5, 1.0, count)
    for c in range(count):
        n = np.eye(dim)[0] + 0.5 * rng.normal(size=dim)
        rows.normal[c] = n / np.linalg.norm(n)
        entries = slice(6 * c, 6 * c + 6)
        rows.start[c + 1] = 6 * c + 6
        rows.dof[entries] = [
            *rng.choice(nodes, 3, replace=False),
            *(nodes + rng.choice(nodes, 3, replace=False)),
        ]
        weights = rng.uniform(0.2, 1.0, (2, 3))
        rows.weight[entries] = (weights / weights.sum(axis=1, keepdims=True) * [[1.0], [-1.0]]).ravel()
        for name in (["couple"] if couples else []) + (["tilt"] if tilts else []):
            tangent = 0.1 * rng.normal(size=(6, dim))
            getattr(rows, name)[entries] = tangent - np.outer(tangent @ rows.normal[c], rows.normal[c])
    mass = rng.uniform(0.5, 2.0, 2 * nodes)
    return SimpleNamespace(
        dim=dim, rows=rows, mass=mass, momentum=rng.normal(size=(2 * nodes, dim)) * mass[:, None],
        friction=np.array([friction, 2.0 * friction]), spacing=(1.0,) * dim,
    )  # fmt: skip


def operator(p):
    """B (n dim, n_nodes dim) of all rows, as a dense matrix, and what maps impulses to momenta."""
    rows, dim, size = p.rows, p.dim, len(p.mass)
    forward, back = np.zeros((rows.count, dim, size, dim)), np.zeros((size, dim, rows.count, dim))
    for c in range(rows.count):
        n = rows.normal[c]
        for k in range(rows.start[c], rows.start[c + 1]):
            i = rows.dof[k]
            block = rows.weight[k] * np.eye(dim)
            if len(rows.couple):
                block = block + np.outer(rows.couple[k], n)
            forward[c, :, i] += block
            back[i, :, c] += block.T + (np.outer(rows.tilt[k], n) if len(rows.tilt) else 0.0)
    return forward.reshape(rows.count * dim, -1), back.reshape(size * dim, -1)


def solved(p, *, tolerance=1e-13, sweeps=20000, recovery=0.0, work=None, begin=None):
    """Impulses J (n, dim), row velocities u (n, dim), what is allowed b (n,), and the sweeps."""
    rows, own, velocity = p.rows, p.rows.own, np.zeros_like(p.momentum)
    rows.force[:] = 0.0 if begin is None else begin
    fastest = state_problem(
        rows, rows.count, own, p.mass, p.momentum, velocity, 1.0 / DT, recovery, 0.9, p.spacing
    )
    took, _ = solve(rows, rows.count, own, p.mass, velocity, fastest, tolerance, sweeps, p.spacing)
    if work is not None:
        add_friction_work(rows, rows.count, own, velocity, False, work, p.spacing)
    inverse = np.repeat(np.divide(1.0, p.mass, out=np.zeros_like(p.mass), where=p.mass > 0.0), p.dim)
    b, transposed = operator(p)
    after = inverse * (p.momentum.ravel() + transposed @ rows.force.ravel())
    held = np.isin(np.arange(len(p.mass)), rows.dof) & (p.mass > 0.0)
    np.testing.assert_allclose(velocity[held], after.reshape(velocity.shape)[held], rtol=0.0, atol=1e-10)
    return rows.force.copy(), (b @ after).reshape(-1, p.dim), own.allowed.copy(), took


def parts(p, vectors):
    """Normal parts (n,) and what is left (n, dim)."""
    normal = (vectors * p.rows.normal).sum(axis=1)
    return normal, vectors - normal[:, None] * p.rows.normal


def residuals(p, impulse, velocity, allowed):
    """Largest violation of each condition, velocities over their size and impulses over theirs."""
    j_n, j_t = parts(p, impulse)
    u_n, u_t = parts(p, velocity)
    fast, strong = np.abs(velocity).max(), np.abs(impulse).max()
    limit, size = p.friction[p.rows.pair] * j_n, np.linalg.norm(j_t, axis=1)
    slip = np.linalg.norm(u_t, axis=1)
    return {
        "approach": max(-(u_n + allowed).min(), 0.0) / fast,
        "pull": max(-j_n.min(), 0.0) / strong,
        "complementarity": np.abs((u_n + allowed) * j_n).max() / (fast * strong),
        "cone": max((size - limit).max(), 0.0) / strong,
        "dissipation": np.abs((u_t * j_t).sum(axis=1) + limit * slip).max() / (fast * strong),
    }


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("parts_of_rows", [{}, {"couples": True}, {"tilts": True}], ids=str)
@pytest.mark.parametrize("seed", range(3))
def test_all_conditions_are_met(seed, dim, parts_of_rows):
    p = problem(seed, dim, friction=0.3, **parts_of_rows)
    impulse, velocity, allowed, _ = solved(p)
    found = residuals(p, impulse, velocity, allowed)
    assert max(found.values()) < 1e-10, found
    j_n, j_t = parts(p, impulse)
    size, limit = np.linalg.norm(j_t, axis=1), p.friction[p.rows.pair] * j_n
    touches = j_n > 1e-6
    assert 5 < touches.sum() < p.rows.count  # some touch, some do not
    assert (size[touches] > 0.999999 * limit[touches]).any()  # some slip


def test_friction_takes_work_and_gives_none():
    p, work = problem(3, 2, friction=0.2), np.zeros(2)
    impulse, velocity, _, _ = solved(p, work=work)
    j_t, u_t = parts(p, impulse)[1], parts(p, velocity)[1]
    taken = -(j_t * u_t).sum(axis=1)
    np.testing.assert_allclose(work, np.bincount(p.rows.pair, taken), rtol=1e-9)
    assert (work > 0.0).all()
    assert taken.min() > -1e-10 * taken.max()


def test_nodes_of_hardly_any_mass_do_no_harm():
    """Light nodes take a large share of the velocity; those without mass take no part."""
    p = problem(4, 2, friction=0.3)
    p.mass[:5] *= 1e-12
    p.momentum[:5] *= 1e-12
    p.mass[5:8] = p.momentum[5:8] = 0.0
    impulse, velocity, allowed, took = solved(p)
    found = residuals(p, impulse, velocity, allowed)
    assert took < 20000
    assert np.isfinite(impulse).all()
    assert max(found.values()) < 1e-9, found


def test_a_gap_may_close_and_an_overlap_opens_by_the_share_that_is_asked_for():
    p = problem(6, 2)
    for recovery in (0.0, 0.25):
        _, _, allowed, _ = solved(p, recovery=recovery)
        expected = np.where(p.rows.gap > 0.0, p.rows.gap, recovery * p.rows.gap) / DT
        np.testing.assert_allclose(allowed, expected, rtol=1e-14)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_from_the_solution_it_takes_a_sweep_and_from_elsewhere_it_gets_there(friction):
    p = problem(8, 2, friction=friction)
    impulse, velocity, _, took = solved(p)
    *_, again = solved(p, tolerance=1e-9, begin=impulse)
    assert again == 1 < took
    _, elsewhere, _, _ = solved(p, begin=np.roll(impulse, 1, axis=0))
    np.testing.assert_allclose(elsewhere, velocity, atol=1e-9)


def test_a_row_that_takes_no_part_loses_the_impulse_that_it_began_with():
    """Open, and its area along the normal: the impulse of a step before must not act on."""
    p = problem(9, 2)
    p.rows.gap[:10], p.rows.tributary_area[:10], p.rows.area[:10] = 0.01, 1.0, 0.5
    impulse, *_ = solved(p, begin=np.ones((30, 2)))
    np.testing.assert_array_equal(impulse[:10], 0.0)
    assert np.abs(impulse[10:]).max() > 0.1


def cut_short(monkeypatch, missed):
    """Remarks on one sweep over a stiff problem, which misses the tolerance some hundred times."""
    p = problem(3, 2, friction=0.5)
    monkeypatch.setattr(lcp, "MISSED", missed)
    law = LcpContact(sweeps=1)
    state = SimpleNamespace(pairs=())
    law.prepare(SimpleNamespace(state=state, scheme="usl", dim=2))
    law.dt = DT
    grid = SimpleNamespace(mass=p.mass, momentum=p.momentum, spacing=p.spacing)
    law.impulses(p.rows, grid, None, projected=False)
    return law.concerns()


def test_what_misses_the_tolerance_by_more_than_missed_is_told(monkeypatch):
    """MISSED too large: nothing is ever said; too small: every solution is complained of."""
    assert cut_short(monkeypatch, lcp.MISSED) != []
    assert cut_short(monkeypatch, 1e6) == []


def test_rounding_is_no_reason_to_sweep_on_and_more_than_that_is(monkeypatch):
    """Of bodies that move as one the rows have velocities of rounding alone, which no sweep takes away."""

    def found(rounding, momentum, gap):
        p = problem(3, 2, friction=0.3)
        p.momentum = p.momentum if momentum is None else p.mass[:, None] * momentum
        p.rows.gap[:] = p.rows.gap if gap is None else gap
        monkeypatch.setitem(globals(), "solve", interpreted(compiled, ROUNDING=rounding))
        impulse, velocity, allowed, sweeps = solved(p, sweeps=400)
        return sweeps, max(residuals(p, impulse, velocity, allowed).values())

    compiled, together = solve, np.array([1.0, 0.3])
    assert found(ROUNDING, together, 0.0)[0] <= 2
    assert found(0.0, together, 0.0)[0] > 2
    assert found(ROUNDING, None, None)[1] < 1e-10
    assert found(0.1, None, None)[1] > 1e-4


def meeting(other, steps, look):
    """A measure of a frictionless body after some steps of lcp against a stiffer plane y = 0."""
    plane = rectangle([-0.8, -0.4], [0.8, 0.0], kind="stiff")
    made = scene({"plane": plane, "other": other}, friction=0.0, allow_overlap=True)
    simulation, overlap = Simulation({**made, "contact": {"method": "lcp", "friction": 0.0}}), 0.0
    simulation.start()
    for _ in range(steps):
        simulation.step()
        rows = simulation.contact.rows
        overlap = max(overlap, -rows.gap[: rows.count].min(initial=0.0) / CELL)
    velocity = simulation.state.particles.velocity[simulation.state.bodies[1].particles]
    return {
        "along": float(velocity[:, 0].mean()),
        "across": float(velocity[:, 1].mean()),
        "overlap": overlap,
    }[look]


def sliding(depth):
    """Speed left of a block that slides over the plane at 1 m/s, this deep in it [m]."""
    block = rectangle([-0.5, -depth], [-0.1, 0.4 - depth], velocity=[1.0, -0.05])
    return meeting(block, 40, "along")


def test_places_beside_a_corner_that_slides_would_stop_it(monkeypatch):
    """Ahead of it, where they are open, and just under it, where bodies overlap."""
    assert sliding(0.0) > 0.98
    assert sliding(0.2 * CELL) > 0.98
    monkeypatch.setattr(lcp, "FACING", 0.0)
    assert sliding(0.0) < 0.7


def test_places_that_lie_aslant_bear_as_well(monkeypatch):
    """A disc rebounds: asked to lie across altogether, open places let it in."""
    falling = disc([0.03, 0.31], 0.3, velocity=[0.0, -1.0])
    overlap = meeting(falling, 60, "overlap")
    assert meeting(falling, 60, "across") > 0.25
    monkeypatch.setattr(lcp, "FACING", 1.1)
    assert meeting(falling, 60, "overlap") > 1.5 * overlap


def deepest(contact, steps=120):
    """Deepest overlap of two blocks that meet at 1 m/s, over a cell."""
    found = [0.0]

    def look(sim):
        rows = sim.contact.rows
        found.append(-rows.gap[: rows.count].min() / CELL if rows.count else 0.0)

    sim = Simulation(impact(friction=0.0, slide=0.0), contact=contact)
    sim.start()
    run(sim, steps, each=look)
    return max(found)


def test_a_first_touch_leaves_no_overlap():
    assert deepest("surfaces+impulse", 12) > 1e-3
    assert deepest("lcp", 12) < 1e-4
    assert deepest("lcp") < 1e-3  # what the tolerance leaves of a hundred steps that press


def test_sweeps_and_residual_are_in_the_results_and_solutions_cut_short_are_told():
    """One sweep leaves more than many do; before bodies meet there is nothing to solve."""
    scene = {**impact(), "time": {"end": 0.03, "output_interval": 0.01}}
    tree = mpmfw.run(scene, contact="lcp")
    said = r"contact law 'lcp': \d+ of \d+ solutions ended after sweeps = 1 "
    with pytest.warns(ResultsWarning, match=said):
        one = mpmfw.run(scene, contact="lcp(sweeps=1)")["series"]
    assert not any("lcp" in warning for warning in tree.attrs.get("warnings", []))
    many = tree["series"]
    assert float(one["solver_sweeps"].max()) == 1.0
    assert float(many["solver_sweeps"].max()) > 2.0
    assert float(many["solver_residual"].max()) <= 1e-3 < float(one["solver_residual"].max())
