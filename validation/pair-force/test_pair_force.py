"""Pair force: penalty contact's kernel on a slave node and a segment, against finite differences."""

# cost: 3

import numpy as np

from mpmfw.contact.springs import add_friction
from mpmfw.contact.surfaces.assembly import assemble
from mpmfw.contact.surfaces.outline import Candidates
from mpmfw.contact.surfaces.surface_rows import SurfaceRows
from mpmfw.kernels import struct
from mpmfw.kernels.contact import Records, pair_table
from mpmfw.kernels.facets import project
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Surface
from mpmfw.validation import Case
from mpmfw_contact.penalty import Penalty, spring_forces

# Only an error of the closed form is left: the step's truncation is h² / l² ~ 1e-12, its rounding 1e-16 / h ~
# 1e-10.
STEP = 1e-6  # of the central differences, in segment lengths
VARIATION, BALANCE = 1e-8, 1e-14
STIFFNESS, FRICTION = 1e4, 0.3  # N/m², 1: of the kernel's own call

#: Arrays of the law.
OWN = Penalty().row_arrays(friction=True)


def test_pair_force(case: Case) -> None:
    """The closed forms, those of [H17] that are not the variation, and the force of the compiled kernel."""
    count = 200 if case.quick else 5000
    rng = np.random.default_rng(20170)
    with case.timed():
        pairs = [random_pair(rng) for _ in range(count)]
        found = measure(pairs)
        force, moment = kernel_balance(pairs[: 200 if case.quick else 1000], rng)
    for quantity, name, key, binds in (
        ("δg_n − N, largest", "N", "of gap", True),
        ("l δξ − C_t, largest", "C_t", "of slip", True),
        ("δg_n − (N − g_n Q / l), largest", "C_n with Q", "of gap", False),
        ("l δξ − T, without P, largest", "C_t without P", "of slip", False),
    ):
        case.gate(quantity, found[name][key], 0.0, (-np.inf, VARIATION), binds=binds)
    for name, errors in found.items():
        for quantity in ("net force", "net moment"):
            binds = name in ("N", "C_t")
            case.gate(f"{quantity} of {name}", errors[quantity], 0.0, (-np.inf, BALANCE), binds=binds)
    case.gate("net force of the kernel's pairs", force, 0.0, (-np.inf, BALANCE))
    case.gate("net moment of the kernel's pairs", moment, 0.0, (-np.inf, BALANCE))


def random_pair(rng: np.random.Generator) -> FloatArray:
    """x_s, x_1, x_2 (3, 2) with the projection within a segment of length 0.3 to 2 and |g_n| to 0.5 [m]."""
    start, angle, length = rng.normal(size=2), rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.3, 2.0)
    tangent = np.array([np.cos(angle), np.sin(angle)])
    normal = np.array([tangent[1], -tangent[0]])
    slave = start + rng.uniform(0.02, 0.98) * length * tangent + rng.uniform(-0.5, 0.5) * normal
    return np.array([slave, start, start + length * tangent])


def gap_and_coordinate(points: FloatArray) -> tuple[float, float]:
    """g_n and ξ of eq. 3 and 4 of [H17], written out here and not taken from the product."""
    slave, one, two = points
    along = two - one
    length = np.hypot(*along)
    tangent = along / length
    normal = np.array([tangent[1], -tangent[0]])
    return float((slave - one) @ normal), float((slave - one) @ tangent / length)


def variations(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """δg_n and l δξ by central differences, (3, 2) each."""
    length = np.hypot(*(points[2] - points[1]))
    of_gap, of_slip = np.empty((2, 3, 2))
    for index in np.ndindex(3, 2):
        ahead, behind = points.copy(), points.copy()
        ahead[index] += STEP * length
        behind[index] -= STEP * length
        (gap_a, xi_a), (gap_b, xi_b) = gap_and_coordinate(ahead), gap_and_coordinate(behind)
        width = ahead[index] - behind[index]
        of_gap[index], of_slip[index] = (gap_a - gap_b) / width, length * (xi_a - xi_b) / width
    return of_gap, of_slip


def product_rows(points: FloatArray) -> dict[str, FloatArray]:
    """The rows (3, 2) that the product's own functions give, and the two of [H17] and of common practice."""
    share, e_n = np.zeros((2, 2))
    gap = project(points[0], points[1:], share, e_n, (1.0, 1.0))
    xi, length, tx, ty = share[1], float(np.hypot(*(points[2] - points[1]))), -e_n[1], e_n[0]
    made = row_of(points, np.zeros((3, 2)), tilts=True)
    lean, made.tilt = made.tilt, made.tilt[:0]
    normal, tangential, q = np.zeros((3, 3, 2))
    for force, out in (((ty, -tx), normal), ((tx, ty), tangential)):
        made.force[0] = force
        made.add_to(out, (1.0, 1.0))
    q[made.dof[:3]] = -length / gap * lean[:3]
    without_p = np.outer([1.0, xi - 1.0, -xi], [tx, ty])
    return {
        "N": normal,
        "C_t": tangential,
        "C_n with Q": normal - gap / length * q,
        "C_t without P": without_p,
    }


def measure(pairs: list[FloatArray]) -> dict[str, dict[str, float]]:
    """Largest errors over all pairs, by the name of the rows.

    They are departures from δg_n, ``of gap``, and l δξ, ``of slip``; ``net force`` and ``net moment``.
    """
    found: dict[str, dict[str, float]] = {}
    for points in pairs:
        of_gap, of_slip = variations(points)
        for name, rows in product_rows(points).items():
            net, moment = balance(points, rows)
            away = {"of gap": np.abs(rows - of_gap).max(), "of slip": np.abs(rows - of_slip).max()}
            largest = found.setdefault(name, {})
            for key, error in {**away, "net force": net, "net moment": moment}.items():
                largest[key] = max(largest.get(key, 0.0), float(error))
    return found


def balance(points: FloatArray, force: FloatArray) -> tuple[float, float]:
    """Net force over Σ |f| and net moment about the origin over Σ |x| |f|."""
    sizes = np.hypot(*force.T)
    moment = np.sum(points[:, 0] * force[:, 1] - points[:, 1] * force[:, 0])
    lever = np.hypot(*points.T)
    return float(np.hypot(*force.sum(axis=0)) / sizes.sum()), float(abs(moment) / (lever @ sizes))


def kernel_balance(pairs: list[FloatArray], rng: np.random.Generator) -> tuple[float, float]:
    """Return the balance of the kernel's forces on touching pairs that slide, with friction."""
    worst = np.zeros(2)
    for points in pairs:
        gap, _ = gap_and_coordinate(points)
        touching = points if gap < 0.0 else points[[0, 2, 1]]  # the other sense turns the outward normal
        worst = np.maximum(worst, balance(touching, kernel_force(touching, 1e-3 * rng.normal(size=(3, 2)))))
    return float(worst[0]), float(worst[1])


def kernel_force(points: FloatArray, moved: FloatArray) -> FloatArray:
    """Force on x_s, x_1, x_2 [N/m] by the kernel that runs in a step, for one slave node of body 0."""
    rows = row_of(points, moved)
    old = SurfaceRows(2, couples=True, own=OWN)
    rows.previous[:] = -1
    rows.own.k[:] = rows.own.effective_area[:] = STIFFNESS
    rows.own.entered[:] = 1.0
    records = Records(**{name: np.zeros((1, 2) if name == "impulse" else 1) for name in Records.member_names})
    rows.set(friction=np.full(len(rows.gap), FRICTION))
    spring_forces(rows, 1, rows.own, old, 1.0, 0.0, np.inf, records)
    add_friction(rows, 1, rows.own, old, 0, old.own, records, np.zeros(1))
    force = np.zeros((3, 2))
    rows.add_to(force, (1.0, 1.0))
    return force


def row_of(points: FloatArray, moved: FloatArray, *, tilts: bool = False) -> SurfaceRows:
    """Return the row of one slave node and one segment; the grid's nodes are the three points."""
    gap, _ = gap_and_coordinate(points)
    body, follow = np.array([0, 1, 1]), np.array([0, 2, 1])
    candidates = Candidates(facet=np.array([[1], [-1], [-1]]), gap=np.full((3, 1), gap))
    outline = Surface(
        position=points, displacement=moved, tributary=np.ones(3), body=body, body_first=np.array([0, 1, 3]),
        facet_first=np.array([0, 1, 3]), facets=np.stack([np.arange(3), follow], axis=1),
        neighbours=np.stack([follow, follow], axis=1), star_first=np.arange(4), star=np.arange(3),
        covered=np.zeros(0, dtype=np.int64),
    )  # fmt: skip
    table = struct(row=np.arange(4), nodes=np.arange(3, dtype=np.int32), weight=np.ones(3))
    pair_of = pair_table(np.array([0]), np.array([1]))
    rows = SurfaceRows(2, couples=True, tilts=tilts, own=OWN)
    rows.count = assemble(
        np.arange(2), False, False, candidates, outline, pair_of, np.array([0]), table, np.zeros(3,
        dtype=np.int64), rows,
        rows.places, (1.0, 1.0),
    )  # fmt: skip
    return rows
