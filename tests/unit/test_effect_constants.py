"""What each constant of the effects is for: which way it fails where it is smaller or larger."""

import contextlib
import math

import numpy as np
import numpy_twins as twin
import pytest

from interpreted import interpreted
from mpmfw.api import SceneError
from mpmfw.effects import constraint, side_loads, side_rows
from mpmfw.effects.constraint import AGREED, PASSES
from mpmfw.effects.side_impulses import meet
from mpmfw.effects.side_rows import (
    QUADRATURE,
    TABULATED,
    PlaneSides,
    SideTable,
    factor_column,
    list_rows,
    tabulate,
)  # fmt: skip
from mpmfw.effects.surface import CRITICAL_MASS, EMPTY, LIGHT, weigh_by_mass, weigh_plain
from mpmfw.kernels.stencil import LEAST_SHARE, linear_weights
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, scene_of, solid


# -- the map of the surface
def weighed(kernel, share, masses, **constants):
    """Weights of a surface node between two nodes of these masses, ``share`` from the first."""
    weight = np.array([1.0 - share, share])
    given = np.ones(1), np.array([EMPTY]), np.array(masses)
    interpreted(kernel, **constants)(np.array([0, 2]), np.array([0, 1]), weight, *given)
    return weight


def test_a_node_that_points_have_barely_reached_gets_no_force():
    """Without the share a force of 1 N/m would accelerate it by 3e8 m/s²."""
    barely = [1.0, 1e-9]
    assert weighed(weigh_plain, 0.3, barely, LIGHT=LIGHT)[1] == 0.0
    assert weighed(weigh_plain, 0.3, barely, LIGHT=0.0)[1] / barely[1] == pytest.approx(3e8)


def test_a_larger_critical_mass_ties_the_surface_to_the_inner_node():
    """Half a cell out it is read from this much farther inside [cells]."""
    boundary = [1.0, 0.125]
    near, far = (weighed(weigh_by_mass, 0.5, boundary, CRITICAL_MASS=m)[1] for m in (CRITICAL_MASS, 10.0))
    assert 0.5 - near < 0.13
    assert 0.5 - far > 0.35


@pytest.mark.parametrize("kernel", [weigh_plain, weigh_by_mass])
def test_a_surface_node_that_has_left_its_points_stays(kernel):
    """EMPTY: a node that a point barely reaches has v = Δt f / m without a bound."""
    assert weighed(kernel, 0.5, [0.5 * EMPTY, 0.0]).tolist() == [0.0, 0.0]
    assert weighed(kernel, 0.5, [5.0 * EMPTY, 0.0]).sum() == pytest.approx(1.0)


# -- prescribed sides
def upper_side(place):
    """The side y = ``place`` of a body below it, in a column of 8 nodes."""
    wide = np.full((1, 2), np.inf)
    return PlaneSides(
        normal=np.array([[0.0, 1.0]]),
        place=np.array([place]),
        box_lower=-wide,
        box_upper=wide,
        alone=np.array([1]),
        cell_mass=np.ones(1),
        reach=np.ones(1),
        tabulated=np.zeros(2, dtype=np.int64),
        weight=np.zeros(0),
        column=np.array([[0, 8, 1, 8, 1]]),
        lower=np.zeros(2),
        grids=np.array([1]),
    )


def side_table(rows, entries, dim=2):
    """An empty table."""
    whole = {name: np.zeros(rows, dtype=np.int64) for name in ("row", "side", "first")}
    real = {name: np.zeros(rows) for name in ("target", "c", "distance")}
    return SideTable(
        nodes=np.zeros(entries, dtype=np.int64),
        weights=np.zeros(entries),
        impulse=np.zeros((rows, dim)),
        applied=np.zeros((0, dim)),
        factor=np.zeros((rows, 5)),
        push=np.zeros((40, dim)),
        **{
            name: np.zeros((rows, dim))
            for name in ("missing", "divided", "answer", "search", "change", "step")
        },
        **whole,
        **real,
    )


def rows_at(place, mass, **constants):
    """Target and weights of every row of the side y = ``place``, in one column of 8 nodes."""
    position = np.column_stack([np.zeros(8), np.arange(8.0)])
    table = side_table(20, 60)
    side = upper_side(place)
    count = interpreted(list_rows, **constants)(1, side, position, np.array(mass), table, (1.0, 1.0))
    return [
        (
            float(table.target[r]),
            {
                int(table.nodes[a]): round(float(table.weights[a]), 9)
                for a in range(table.row[r], table.row[r + 1])
            },
        )
        for r in range(count)
    ]


def impulse_on(node, weights, mass):
    """Change of a node's velocity [m/s] by which a row is met that misses 1 m/s."""
    return weights.get(node, 0.0) / mass[node] / sum(w**2 / mass[k] for k, w in weights.items())


def test_an_empty_node_does_not_take_the_side_s_impulse():
    """Without a share that counts as empty it runs away at five times the missing velocity."""
    barely = [0.5, 1, 1, 1, 0.68, 1e-4, 0, 0]
    (_, weights) = rows_at(4.2, barely, LIGHT=side_rows.LIGHT)[-1]
    assert 5 not in weights
    (_, weights) = rows_at(4.2, barely, LIGHT=0.0)[-1]
    assert impulse_on(5, weights, barely) > 4.9


def test_of_a_body_that_reaches_a_cell_by_next_to_nothing_that_node_is_held_in_line():
    """With a larger least weight an ordinary side is read from inside as well."""
    thin, straight = [0.5, 1, 1, 1, 0.5, 1e-3, 0, 0], [0.5, 1, 1, 1, 0.82, 0.08, 0, 0]
    in_line = (0.0, {5: 1.0, 4: -2.0, 3: 1.0})
    assert in_line in rows_at(4.01, thin, THIN=side_rows.THIN)
    assert in_line not in rows_at(4.01, thin, THIN=0.0)
    assert in_line not in rows_at(4.4, straight, THIN=side_rows.THIN)
    assert in_line in rows_at(4.4, straight, THIN=0.5)


def weights_of_oblique_side(monkeypatch, points, values):
    """Weights of the nodes of 21 columns, (21, 9), by so many points and values in a cell."""
    monkeypatch.setattr(side_rows, "QUADRATURE", points)
    monkeypatch.setattr(side_rows, "TABULATED", values)
    reach, table = tabulate(np.array([math.sin(0.6), math.cos(0.6)]), 1, 1, 1)
    away = np.abs(np.arange(len(table)) - len(table) // 2) / values
    assert table[away > reach].max(initial=0.0) < 1e-12
    side = upper_side(0.0)
    side.set(tabulated=np.array([0, len(table)]), weight=table)
    weight_at = interpreted(side_rows.weight_at, TABULATED=values)
    x = np.subtract.outer(np.linspace(0.0, 1.0, 21), np.arange(-4, 5))
    return np.array(
        [[weight_at(each, 0, 1, side) if abs(each) < reach else 0.0 for each in row] for row in x]
    )


def test_an_oblique_side_has_points_and_values_enough_for_its_weights(monkeypatch):
    """More change them by less than 1e-3; of two a cell they would be off by up to 3 % of a node."""
    exact = weights_of_oblique_side(monkeypatch, 400, 1024)
    ours = weights_of_oblique_side(monkeypatch, QUADRATURE, TABULATED)
    assert np.abs(ours - exact).max() < 1e-3
    assert np.abs(weights_of_oblique_side(monkeypatch, 2, TABULATED) - exact).max() > 0.01
    assert np.abs(weights_of_oblique_side(monkeypatch, QUADRATURE, 2) - exact).max() > 0.01
    np.testing.assert_allclose(ours.sum(axis=1), 1.0, atol=1e-12)
    nodes = np.arange(-4, 5)
    np.testing.assert_allclose(ours @ nodes, np.linspace(0.0, 1.0, 21), atol=1e-12)


def test_facets_of_a_turned_side_lie_on_it_but_for_rounding(monkeypatch):
    """Without an allowance some are lost; with a large one some round the corner are taken too."""

    def loaded(flat):
        monkeypatch.setattr(side_loads, "FLAT", flat)
        turned = block(
            bodies__solid__geometry__angle=0.3, bodies__solid__sides=[{"side": "top", "pressure": 1.0}]
        )
        with contextlib.suppress(SceneError):  # there is none
            return len(Simulation(turned).registry.plugins["pressure on solid top"].facets)
        return 0

    assert loaded(side_loads.FLAT) == 16
    assert loaded(1.0) > 16
    assert loaded(0.0) < 16


@pytest.mark.parametrize("dim", [2, 3])
def test_rows_are_met_by_the_least_change_of_momentum(dim):
    """Against the solution of the constrained least squares, (M, Aᵀ; A, 0)."""
    spacing, rng = (0.1,) * dim, np.random.default_rng(7)
    row, nodes, weights = twin.random_table(rng, 6, 40)
    mass, momentum = 0.1 + rng.random(40), rng.normal(size=(40, dim))
    side, target = np.array([0, 0, 1, 1, 0, 1]), np.array([1.0, 0.0, 1.0, 1.0, 1.0, 0.0])
    directions = np.array([np.linalg.qr(rng.normal(size=(dim, dim)))[0], np.eye(dim)])
    velocity = np.array([[0.3, np.nan, -0.2][:dim], [np.nan, 0.1, 0.7][:dim]])
    rows, wanted = [], []
    for r, dense_row in enumerate(twin.matrix_of(row, nodes, weights, 40)):
        for e in range(dim):
            if not np.isnan(velocity[side[r], e]):
                rows.append(np.outer(dense_row, directions[side[r], e]).ravel())
                wanted.append(target[r] * velocity[side[r], e])
    a, m = np.array(rows), np.repeat(mass, dim)
    v = momentum.ravel() / m
    v = v + (a / m).T @ np.linalg.solve(a @ (a / m).T, np.array(wanted) - a @ v)
    met = momentum.copy()
    conditions = side_table(6, 1, dim).set(
        row=row, nodes=nodes.astype(np.int64), weights=weights, target=target, side=side
    )
    for begin, end in ((0, 2), (2, 4), (4, 5), (5, 6)):  # columns of one or two rows
        factor_column(begin, end, mass, conditions)
    passes = meet(6, conditions, directions, velocity, 2000, 1e-13, mass, met, spacing)
    assert passes < 2000
    np.testing.assert_allclose(met, (m * v).reshape(40, dim), atol=1e-10)


def missed(simulation):
    """Largest velocity by which rows of prescribed sides are not met after a step [m/s]."""
    held, grid = simulation.registry.plugins["constraint"], simulation.state.grid
    table, worst = held.table, 0.0
    for r in range(held.rows):
        entries = slice(table.row[r], table.row[r + 1])
        nodes = table.nodes[entries]
        velocity = table.weights[entries] @ (grid.momentum[nodes] / grid.mass[nodes, None])
        velocity = held.directions[table.side[r]] @ velocity
        wanted = table.target[r] * held.velocity[table.side[r]]
        worst = max(worst, float(np.nanmax(np.abs(velocity - wanted))))
    return worst


def passes_and_miss(monkeypatch, **constants):
    """Passes of the first step of a turned block, whose left side and top share nodes and are fixed, and what
    they miss [m/s]."""
    for name, value in constants.items():
        monkeypatch.setattr(constraint, name, value)
    simulation = Simulation(
        block(
            bodies__solid__geometry__angle=0.3,
            bodies__solid__velocity=[1.0, 0.3],
            bodies__solid__sides=[{"side": "left", "fixed": True}, {"side": "top", "fixed": True}],
        )
    )
    simulation.advance(1)
    return simulation.registry.plugins["constraint"].passes, missed(simulation)


def test_sides_that_share_nodes_are_met_together(monkeypatch):
    """Fewer passes, or a coarser agreement, leave the corner with a velocity of its own."""
    passes, miss = passes_and_miss(monkeypatch, PASSES=PASSES, AGREED=AGREED)
    assert 3 <= passes < PASSES // 5
    assert miss < 1e-7
    assert passes_and_miss(monkeypatch, PASSES=2)[1] > 1e-3
    assert passes_and_miss(monkeypatch, PASSES=PASSES, AGREED=1e-3)[1] > 1e-5


@pytest.mark.parametrize("place", [0.0, 0.03])
def test_sides_that_contradict_one_another_meet_in_between(place):
    """Of two bodies in one velocity field, whose nodes both sides read."""
    bodies = {
        name: solid([lower, -0.5], [lower + 1.0, 0.5], 0.125, sides=[{"side": side, "velocity": ["free", v]}])
        for name, lower, side, v in (("a", place - 1.0, "right", 1.0), ("b", place, "left", 0.0))
    }
    made = scene_of(bodies, 0.25, [-2.0] * 2, [2.0] * 2, end=0.02, contact={"method": "none"})
    simulation = Simulation(made)
    simulation.advance(1)
    grid, sides = simulation.state.grid, simulation.registry.plugins["constraint"]
    assert 0.1 < np.abs(grid.velocity[grid.mass > 0.0]).max() < 1.0
    assert sides.passes < PASSES // 5
    given = sides.table.impulse.sum(axis=0)
    np.testing.assert_allclose(given, grid.momentum.sum(axis=0), atol=1e-9 * given[1])
    assert np.abs(sides.table.impulse).max() <= 2.0 * given[1]


def test_one_pass_meets_an_oblique_side():
    """The bottom of a turned box in space: columns of one side share no nodes."""
    held = [{"side": "bottom", "fixed": True}]
    box = solid([-0.8, -0.2, -0.5], [0.8, 0.0, 0.5], "0.5 cells", layout="fitted", sides=held)
    box["geometry"]["angles"] = [0.35, 0.61, 0.87]
    gravity = {"vector": [1.0, -10.0, 0.5]}
    simulation = Simulation(scene_of({"plane": box}, 0.1, [-1.2] * 3, [1.2] * 3, end=0.02, gravity=gravity))
    simulation.advance(1)
    assert simulation.registry.plugins["constraint"].passes == 1
    assert missed(simulation) < 1e-13


# -- linear functions, whose least share keeps nodes at the edge
def test_a_point_on_a_grid_line_reaches_the_next_node_by_next_to_nothing():
    """Without a share the node has a gradient and no mass; a larger one would move the point."""

    def at(xi, least):
        base, weight, slope = np.zeros(1), np.zeros((1, 2)), np.zeros((1, 2))
        interpreted(linear_weights, LEAST_SHARE=least)(xi, 1.0, 0, base, weight, slope)
        return weight[0, 1], abs(base[0] + weight[0, 1] - xi)

    share, moved = at(3.0, LEAST_SHARE)
    assert share > 0.0
    assert moved < 1e-12
    assert at(3.0, 0.0)[0] == 0.0
    assert at(3.0, 1e-3)[1] == pytest.approx(1e-3)
