"""Cattaneo and Mindlin's partial slip.

Shear along the contact of a cylinder on a block, by nodal forces and by stress, at half of the load that
slides, and sliding, with two cell sizes. What every method has decides nothing."""
# cost: 600

from dataclasses import dataclass

import numpy as np
from common import fixed, nodes_of, polygon, rectangle, scene
from scipy.optimize import minimize_scalar

from mpmfw.plots.style import dress, new_figure, on_lines
from mpmfw.validation import CLASSICAL, Place, Runs, full, methods, together

RADIUS, HALF_WIDTH = 20.0, 1.0  #: of the cylinder, and of the contact that the load is chosen for [m]
YOUNG, POISSON, DENSITY, FRICTION = 1e6, 0.3, 1000.0, 0.3
#: 1/E* = 2 (1 − ν²)/E of two bodies of one solid [Pa]
E_STAR = YOUNG / (2.0 * (1.0 - POISSON**2))
#: P = π E* a² / (4 R) [N/m]; K. L. Johnson, Contact Mechanics (1985), section 4.2(c)
LOAD = np.pi * E_STAR * HALF_WIDTH**2 / (4.0 * RADIUS)
#: Half the width of both bodies, and the height of each [m]
SIDE, HEIGHT = 5.0, 5.0
#: The lowest point of the cylinder: off the grid lines [m]
TOUCH = (0.011, 0.017)
SHEAR, BULK = YOUNG / (2.0 * (1.0 + POISSON)), YOUNG / (3.0 * (1.0 - 2.0 * POISSON))  #: [Pa]
SOLID = {"model": "linear_elastic", "density": DENSITY, "bulk_modulus": BULK, "shear_modulus": SHEAR}


def pressed(crossings=24.0, drift=0.036):
    """Return a cylinder that is pressed by P while it settles, then drawn sideways by ``drift`` [m].

    That takes so many crossings of the height by shear waves; it slides after about 0.8 of that. The
    cylinder is its underside, cut off and guided above.
    """
    end = crossings * HEIGHT / float(np.sqrt(SHEAR / DENSITY))
    x = np.linspace(-SIDE, SIDE, 201)
    rim = np.column_stack([x, RADIUS - np.sqrt(RADIUS**2 - x**2)])
    outline = np.array(TOUCH) + np.vstack([rim, [[SIDE, HEIGHT], [-SIDE, HEIGHT]]])
    drawn = [{"side": side, "velocity": [drift / end, "free"]} for side in ("left", "right")]
    loaded = [*drawn, {"side": "top", "pressure": LOAD / (2.0 * SIDE)}]
    corners = (TOUCH[0] - SIDE, TOUCH[1] - HEIGHT, TOUCH[0] + SIDE, TOUCH[1])
    fitted = {"layout": "fitted", "size": "0.5 cells"}
    held = fixed(bottom="xy", left="x", right="x")
    bodies = {
        "cylinder": polygon(outline, segment="0.25 cells", sides=loaded),
        "block": rectangle(*corners, particles=fitted, segment="0.25 cells", sides=held),
    }
    more = {"contact": {"friction": FRICTION}, "settle": {"tolerance": 1e-3}}
    return scene(0.1, [-6.0, -5.5], [6.5, 6.0], end, end / 24.0, SOLID, bodies, **more)


#: Windows lie this far to both sides of the contact's middle [m]
REACH = 1.6
#: Share of the largest pressure below which a node's own friction is not looked at.
BEARS = 0.02


@dataclass(frozen=True)
class Tractions:
    """Means over windows of one cell, and the forces that they come from."""

    x: np.ndarray  #: middles of the windows, from that of the pressure [m]
    pressure: np.ndarray  #: [Pa]
    shear: np.ndarray  #: against the motion of the cylinder [Pa]
    normal_force: float  #: P [N/m]
    tangential_force: float  #: Q [N/m]
    cell_size: float  #: [m]

    @property
    def half_width(self):
        """a = √(4 P R / (π E*)) [m]."""
        return float(np.sqrt(4.0 * self.normal_force * RADIUS / (np.pi * E_STAR)))

    @property
    def stick(self):
        """c / a = √(1 − Q / (μ P)) of the closed form."""
        share = self.tangential_force / (FRICTION * self.normal_force)
        return float(np.sqrt(max(1.0 - share, 0.0)))

    @property
    def stick_of_fit(self):
        """c / a of the closed form's shear that is nearest, by least squares."""

        def missed(stick):
            return float(np.sum((self.shear - self.exact_shear(stick)) ** 2))

        return float(minimize_scalar(missed, bounds=(0.0, 1.0), method="bounded").x)

    def exact_pressure(self):
        """p = p0 √(1 − x²/a²), p0 = 2 P / (π a)."""
        a = self.half_width
        return 2.0 * self.normal_force / (np.pi * a) * self._arch(a)

    def exact_shear(self, stick):
        """q = μ p0 (√(1 − x²/a²) − (c/a) √(1 − x²/c²)), with c/a = ``stick``."""
        a = self.half_width
        peak = FRICTION * 2.0 * self.normal_force / (np.pi * a)
        return peak * (self._arch(a) - (stick * self._arch(stick * a) if stick > 0.0 else 0.0))

    def _arch(self, width):
        """Means of √(1 − x²/width²) over the windows."""
        across = self.cell_size * np.linspace(-0.5, 0.5, 41)
        return np.asarray(
            np.sqrt(np.maximum(1.0 - ((self.x[:, None] + across) / width) ** 2, 0.0)).mean(axis=1)
        )


def of_forces(tree, k):
    """Return them at output ``k``, from forces of the cylinder's nodes over the length of each."""
    position, force, length = _nodes(tree, k)
    x, whole = position[:, 0], force.sum(axis=0)
    middle = float(np.sum(x * force[:, 1]) / whole[1])
    return _tractions(x - middle, force[:, 1], -force[:, 0], length, whole, tree)


def of_stress(tree, k):
    """Return them at output ``k`` from the stress of points within half a cell of the block's top."""
    h = float(tree.attrs["cell_size"])
    surface, points = (tree[f"{group}/block"].to_dataset().isel(time=k) for group in ("surface", "particles"))
    top = surface["position"].values[surface["position"].values[:, 1] > TOUCH[1] - 0.5 * HEIGHT]
    top = top[np.argsort(top[:, 0])]
    position = points["position"].values
    rim = position[:, 1] > np.interp(position[:, 0], top[:, 0], top[:, 1]) - 0.5 * h
    x, volume, stress = (points[name].values[rim] for name in ("position", "volume", "stress"))
    weight = stress[:, 1, 1] ** 2 * volume  # squared: the rest of the top is wide, and bears a little
    middle = float(np.sum(x[:, 0] * weight) / np.sum(weight))
    pressure, shear = -stress[:, 1, 1] * volume, stress[:, 0, 1] * volume
    whole = tree["series"]["contact_force"].isel(time=k, pair=0).values
    return _tractions(x[:, 0] - middle, pressure, shear, volume, whole, tree)


def half_way(tree):
    """The output at which Q is nearest to half of μ P."""
    whole = tree["series"]["contact_force"].isel(pair=0).values
    share = -whole[1:, 0] / (FRICTION * whole[1:, 1])
    return 1 + int(np.argmin(np.abs(share - 0.5)))


def partial_slip(tree):
    """Return ``cone`` [1], errors of ``stick`` [1], ``pressure`` and ``shear`` [%]."""
    found = of_forces(tree, half_way(tree))
    return {**_errors(found), "cone": _over_the_cone(tree, half_way(tree))}


def partial_slip_by_stress(tree):
    """The same but for the cone, by the stress of points."""
    return _errors(of_stress(tree, half_way(tree)))


def sliding(tree):
    """Q over μ P in the last eighth of the time, less one [%]."""
    last = tree["series"]["contact_force"].isel(pair=0).values[-(tree["series"].sizes["time"] // 8) :]
    return float(100.0 * (-last[:, 0].sum() / (FRICTION * last[:, 1].sum()) - 1.0))


def _errors(found):
    bound = FRICTION * found.exact_pressure()
    return {
        "stick": found.stick_of_fit - found.stick,
        "pressure": 100.0 * _rms(found.pressure - found.exact_pressure()) / _rms(found.exact_pressure()),
        "shear": 100.0 * _rms(found.shear - found.exact_shear(found.stick)) / _rms(bound),
    }


def _over_the_cone(tree, k):
    """Return the largest |T| over μ N; the contact has half of the cylinder's slope: both bodies yield."""
    position, force, length = _nodes(tree, k)
    middle = np.sum(position[:, 0] * force[:, 1]) / force[:, 1].sum()
    moved = tree["surface/cylinder"]["position"].isel(time=[0, k]).values[:, :, 0]
    corner = int(np.argmin(moved[0]))
    lowest = TOUCH[0] + float(moved[1, corner] - moved[0, corner])
    slope = 0.5 * (position[:, 0] - lowest) / RADIUS
    normal = (force[:, 1] - slope * force[:, 0]) / np.sqrt(1.0 + slope**2)
    along = np.abs(force[:, 0] + slope * force[:, 1]) / np.sqrt(1.0 + slope**2)
    peak = 2.0 * force[:, 1].sum() / (np.pi * np.ptp(position[force[:, 1] > 0.0, 0]) / 2.0)
    bears = (normal > BEARS * peak * length) & (np.abs(position[:, 0] - middle) < REACH)
    return float(np.max(along[bears] / (FRICTION * normal[bears])))


def _nodes(tree, k):
    """Return position [m], force [N/m], (n, 2) each, and length (n,) [m] of nodes of the underside."""
    position, force, length = nodes_of(tree, "cylinder", k)
    low = (position[:, 1] < TOUCH[1] + 0.3) & (np.abs(position[:, 0] - TOUCH[0]) < 0.9 * SIDE)
    return position[low], force[low], length[low]


def _tractions(x, pressure, shear, size, whole, tree):
    """Loads over size in windows of one cell within the reach, and the ``whole`` force (2,)."""
    h = float(tree.attrs["cell_size"])
    count = 2 * int(REACH / h) + 1
    index = np.floor(x / h + 0.5 * count).astype(int)
    within = (index >= 0) & (index < count)
    sums = [np.bincount(index[within], of[within], count) for of in (pressure, shear, size)]
    p, q = (load / np.maximum(sums[2], 1e-30) for load in sums[:2])
    return Tractions(h * (np.arange(count) - count // 2), p, q, float(whole[1]), -float(whole[0]), h)


def _rms(values):
    return float(np.sqrt(np.mean(values**2)))


COLOURS = ("#0072B2", "#E69F00", "#009E73", "#7F3C8D", "#D55E00")
MARKERS = ("o", "s", "^", "D", "v")
#: Contacts that are drawn by stress.
CONTACTS = ("penalty", *CLASSICAL, "nairn")


def draw(runs):
    """Draw penalty contact by its forces at both cell sizes, and all methods by stress at the coarse one."""
    figure = new_figure(2, 1, 66.0)
    axes = figure.subplots(1, 2, sharey=True)
    penalty = [run for run in runs if str(run.method) == "penalty, cpdi"]
    for run, colour, marker in zip(penalty, COLOURS, MARKERS, strict=False):
        found = of_forces(run.results, half_way(run.results))
        peak = found.exact_pressure().max()
        _points(axes[0], found, found.pressure / peak, colour, marker, "none", f"p, {run.place.at}")
        _points(axes[0], found, found.shear / (FRICTION * peak), colour, marker, "full", f"q, {run.place.at}")
    _theory(axes[0], of_forces(penalty[-1].results, half_way(penalty[-1].results)), pressure=True)
    coarse = [run for run in runs if run.place.at == penalty[0].place.at]
    for contact, colour, marker in zip(CONTACTS, COLOURS, MARKERS, strict=False):
        for run in (run for run in coarse if str(run.method) == f"{contact}, cpdi"):
            found = of_stress(run.results, half_way(run.results))
            bound = FRICTION * found.exact_pressure().max()
            _points(axes[1], found, found.shear / bound, colour, marker, "full", on_lines(contact))
    _theory(axes[1], of_stress(penalty[0].results, half_way(penalty[0].results)), pressure=False)
    titles = ("(a) penalty, from forces of surface nodes", f"(b) q from stresses, {penalty[0].place.at}")
    for panel, title, label in zip(axes, titles, ("p / p0, q / (μ p0) [1]", ""), strict=True):
        dress(panel, "x / a [1]", label, title)
        panel.set_xlim(-1.6, 1.6)
        panel.set_ylim(-0.25, 1.9)
        panel.legend(loc="upper center", ncols=2)
    return figure


def _points(panel, found, values, colour, marker, fill, label):
    panel.plot(
        found.x / found.half_width, values, color=colour, marker=marker, fillstyle=fill, markersize=3.5,
        linewidth=0.6, linestyle=":", label=label,
    )  # fmt: skip


def _theory(panel, found, *, pressure):
    """The closed form with this run's c/a."""
    x = np.linspace(-1.0, 1.0, 801)
    arch = np.sqrt(1.0 - x**2)
    inner = np.sqrt(np.maximum(1.0 - (x / found.stick) ** 2, 0.0))
    panel.plot(x, arch - found.stick * inner, color="0.2", linewidth=1.0, label="Cattaneo, Mindlin")
    if pressure:
        panel.plot(x, arch, color="0.2", linewidth=1.0, linestyle="--", label="Hertz")


OTHERS = ["penalty(kappa=16)", *CONTACTS[1:]]
slip = Runs(
    "",
    pressed,
    [*methods(), *methods(OTHERS, when="full")],
    [
        Place("a/h = 5", set={"grid.cell_size": 0.2}),
        Place("a/h = 10", set={"grid.cell_size": 0.1}, when="full"),
    ],
)


@slip
def test_slip(run):
    if run.method.matches("penalty*"):
        run.gates(
            partial_slip,
            ("c / a by the shear, error, {at}", "stick", 0.0, 0.05),
            ("shear, error in L2 of μ p, {at}", "shear", 0.0, (0.0, 10.0), "%"),
            ("pressure, error in L2, {at}", "pressure", 0.0, (0.0, 5.0), "%"),
            ("largest |T| / (μ N) of a node, {at}", "cone", 1.0, (0.0, 1.05)),
        )
    run.gates(sliding, ("Q over μ P when it slides, less one, {at}", None, 0.0, 1.0, "%"))
    run.gates(
        partial_slip_by_stress,
        ("c / a by the points' shear, error, {at}", "stick", 0.0, 0.05),
        ("points' shear, error in L2 of μ p, {at}", "shear", 0.0, (0.0, 10.0), "%"),
        ("points' pressure, error in L2, {at}", "pressure", 0.0, (0.0, 5.0), "%"),
        binds=False,
    )


@full
@together(slip)
def test_figure(case, runs):
    case.figure("", draw(runs))
