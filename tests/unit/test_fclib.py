"""Problems of ``lcp`` as files of FCLIB, and its solutions beside those of a solver for cones."""

import sys
from pathlib import Path

import clarabel
import h5py
import numpy as np
import pytest
from scipy import sparse

from lcp_problems import DT, problem
from mpmfw.errors import MpmfwError
from mpmfw.simulation import Simulation
from mpmfw_contact import fclib
from mpmfw_contact._gauss_seidel import solve, state_problem
from mpmfw_contact.fclib import LocalProblem, last_problem, problem_of
from scenes_for_tests import two_blocks

#: Written by FCLIB itself: Siconos, a stack of boxes at 48 places (see the README beside it).
BOXES = Path(__file__).with_name("data") / "fclib-boxes-stack.hdf5"


def reference(p, *, tolerance=1e-8):
    """Impulses of the problem by an interior-point method.

    Coulomb's law is the minimum of r·W r / 2 + r·(q + s) over the cones with s_N = μ |u_T|, which is asked for anew until it
    no longer changes (Acary, Cadoux, Lemaréchal & Malick 2011).
    """
    n, size = len(p.friction), p.dim * len(p.friction)
    scale = np.ones((n, p.dim))
    scale[:, 0] = p.friction
    cones = [clarabel.SecondOrderConeT(p.dim)] * n
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    symmetric = sparse.triu(0.5 * (p.delassus + p.delassus.T)).tocsc()
    shift, r = np.zeros(n), np.zeros(size)
    for _ in range(200):
        q = p.velocity.reshape(n, p.dim).copy()
        q[:, 0] += shift
        minus = sparse.diags(-scale.ravel()).tocsc()
        solver = clarabel.DefaultSolver(symmetric, q.ravel(), minus, np.zeros(size), cones, settings)
        r = np.array(solver.solve().x)
        slip = np.linalg.norm((p.delassus @ r + p.velocity).reshape(n, p.dim)[:, 1:], axis=1)
        change = np.abs(p.friction * slip - shift).max()
        shift = p.friction * slip
        if change < tolerance * max(1.0, np.abs(p.velocity).max()):
            return r
    raise AssertionError(f"the reference still changes by {change}")


def random_problem(seed, dim, count, friction):
    """Solved by lcp's sweeps, to the end."""
    made = problem(seed, dim, count=count, couples=True, friction=friction, nodes=2 * count)
    velocity = np.zeros_like(made.momentum)
    fastest = state_problem(
        made.rows, count, made.rows.own, made.mass, made.momentum, velocity, 1.0 / DT, 0.0, 0.9, made.spacing
    )
    solve(made.rows, count, made.rows.own, made.mass, velocity, fastest, 1e-12, 20000, made.spacing)
    return problem_of(made.rows, made.mass)


@pytest.mark.parametrize(
    ("dim", "count", "friction"), [(2, 40, 0.1), (3, 40, 0.1), (2, 40, 0.4), (3, 300, 0.4), (2, 1000, 0.3)]
)
def test_the_sweeps_find_what_a_solver_for_cones_finds(dim, count, friction):
    p = random_problem(count, dim, count, friction)
    expected = reference(p)
    assert p.residual(expected) < 1e-5
    assert p.residual() < 1e-9
    assert p.residual(np.zeros_like(expected)) > 0.1
    found = p.delassus @ p.impulse + p.velocity
    np.testing.assert_allclose(found, p.delassus @ expected + p.velocity, atol=1e-5 * np.abs(found).max())
    slips = np.linalg.norm(p.impulse.reshape(-1, dim)[:, 1:], axis=1) > 0.999 * p.friction * p.impulse[::dim]
    touches = p.impulse[::dim] > 0.0
    assert (slips & touches).sum() > 0
    assert 0 < touches.sum() < len(touches)


def test_a_step_of_a_run_is_a_problem_that_it_has_solved(tmp_path):
    simulation = Simulation(two_blocks("lcp"), shape="cpdi")
    simulation.start()
    while simulation.contact.rows.count == 0 or not (last_problem(simulation).impulse[::2] > 0.0).sum() > 2:
        simulation.step()
    p = last_problem(simulation, title="μ = 0.3, at 2 °")
    # Rows say nearly the same: how they share the force is not the only way, what they do is
    expected = reference(p)
    np.testing.assert_allclose(
        p.delassus @ p.impulse, p.delassus @ expected, atol=1e-3 * np.abs(p.velocity).max()
    )
    assert p.impulse[::2].sum() == pytest.approx(expected[::2].sum(), rel=1e-3)
    assert p.impulse[::2].sum() == pytest.approx(abs(simulation.contact.records.impulse[0, 0]), rel=1e-9)
    assert p.residual() < 1e-2 * p.residual(np.zeros_like(p.impulse))
    p.write(tmp_path / "step.hdf5")
    again = LocalProblem.read(tmp_path / "step.hdf5")
    assert (again.delassus != p.delassus).nnz == 0
    for name in ("velocity", "friction", "impulse"):
        np.testing.assert_array_equal(getattr(again, name), getattr(p, name))
    assert (again.dim, again.title, again.description) == (p.dim, p.title, p.description)
    assert f"{simulation.state.time:.6g} s" in last_problem(simulation).title


def test_a_file_of_fclib_is_read_and_one_of_ours_has_the_same_members(tmp_path):
    boxes = LocalProblem.read(BOXES)
    assert (boxes.title, boxes.dim, boxes.delassus.shape) == ("Boxes Stack", 3, (144, 144))
    np.testing.assert_array_equal(boxes.friction, 0.7)
    assert boxes.residual(reference(boxes)) < 1e-7 < 1e-3 < boxes.residual(np.zeros(144))
    boxes.write(tmp_path / "again.hdf5")

    def members(path):
        found = {}
        with h5py.File(path) as file:
            file.visititems(lambda name, each: found.update({name: getattr(each, "dtype", None)}))
        return {
            name: kind
            for name, kind in found.items()
            if not name.startswith(("guesses", "fclib_local/info/"))
        }

    assert members(tmp_path / "again.hdf5") == members(BOXES)
    with h5py.File(BOXES) as file:
        assert file["fclib_local/W/nz"][0] == fclib.ROWS


@pytest.mark.parametrize("layout", ["columns", "triplets"])
def test_other_layouts_of_the_matrix_are_read(tmp_path, layout):
    p = random_problem(1, 2, 12, 0.3)
    p.write(tmp_path / "p.hdf5")
    with h5py.File(tmp_path / "p.hdf5", "a") as file:
        group = file["fclib_local/W"]
        matrix = p.delassus.tocsc() if layout == "columns" else p.delassus.tocoo()
        arrays = (
            {"nz": [fclib.COLUMNS], "p": matrix.indptr, "i": matrix.indices, "x": matrix.data}
            if layout == "columns"
            else {"nz": [matrix.nnz], "p": matrix.row, "i": matrix.col, "x": matrix.data}
        )
        for name, value in arrays.items():
            del group[name]
            group[name] = np.asarray(value)
    assert abs(LocalProblem.read(tmp_path / "p.hdf5").delassus - p.delassus).max() == 0.0


def test_what_cannot_be_done_is_said(tmp_path, monkeypatch):
    simulation = Simulation(two_blocks("penalty"))
    with pytest.raises(MpmfwError, match="contact 'penalty' solves no problem; expected lcp"):
        last_problem(simulation)
    (tmp_path / "text.hdf5").write_text("no HDF5")
    with pytest.raises(MpmfwError, match=r"cannot read '.*text.hdf5' as a problem of FCLIB"):
        LocalProblem.read(tmp_path / "text.hdf5")
    with h5py.File(tmp_path / "global.hdf5", "w") as file:
        file.create_group("fclib_global")
    with pytest.raises(MpmfwError, match="has no group fclib_local; expected a local problem"):
        LocalProblem.read(tmp_path / "global.hdf5")
    made = problem(0, 2)
    made.rows.hold(cohesion=True)
    made.rows.own.compliance[:] = made.rows.cohesion[:] = 1.0
    made.rows.count = 3
    with pytest.raises(MpmfwError, match="has cohesion, which a problem of FCLIB cannot have"):
        problem_of(made.rows, made.mass)
    p = random_problem(1, 2, 12, 0.3)
    with pytest.raises(MpmfwError, match="cannot write"):
        p.write(tmp_path / "none" / "p.hdf5")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MpmfwError, match=r'files of FCLIB need h5py: pip install "mpmfw\[fclib\]"'):
        p.write(tmp_path / "p.hdf5")
