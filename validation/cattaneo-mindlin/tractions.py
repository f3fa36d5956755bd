"""Pressure and shear along the contact, by nodal forces and by stress, beside the closed form."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr
from pressed import E_STAR, FRICTION, HEIGHT, RADIUS, SIDE, TOUCH
from scipy.optimize import minimize_scalar
from surface_pressure import nodes_of

Array = npt.NDArray[np.float64]

#: Windows lie this far to both sides of the contact's middle [m]
REACH = 1.6
#: Share of the largest pressure below which a node's own friction is not looked at.
BEARS = 0.02


@dataclass(frozen=True)
class Tractions:
    """Means over windows of one cell, and the forces that they come from."""

    x: Array  #: middles of the windows, from that of the pressure [m]
    pressure: Array  #: [Pa]
    shear: Array  #: against the motion of the cylinder [Pa]
    normal_force: float  #: P [N/m]
    tangential_force: float  #: Q [N/m]
    cell_size: float  #: [m]

    @property
    def half_width(self) -> float:
        """a = √(4 P R / (π E*)) [m]."""
        return float(np.sqrt(4.0 * self.normal_force * RADIUS / (np.pi * E_STAR)))

    @property
    def share(self) -> float:
        """Q / (μ P)."""
        return self.tangential_force / (FRICTION * self.normal_force)

    @property
    def stick(self) -> float:
        """c / a = √(1 − Q / (μ P)) of the closed form."""
        return float(np.sqrt(max(1.0 - self.share, 0.0)))

    @property
    def stick_of_fit(self) -> float:
        """c / a of the closed form's shear that is nearest, by least squares."""

        def missed(stick: float) -> float:
            return float(np.sum((self.shear - self.exact_shear(stick)) ** 2))

        return float(minimize_scalar(missed, bounds=(0.0, 1.0), method="bounded").x)

    def exact_pressure(self) -> Array:
        """p = p0 √(1 − x²/a²), p0 = 2 P / (π a)."""
        a = self.half_width
        return 2.0 * self.normal_force / (np.pi * a) * self._arch(a)

    def exact_shear(self, stick: float) -> Array:
        """q = μ p0 (√(1 − x²/a²) − (c/a) √(1 − x²/c²)), with c/a = ``stick``."""
        a = self.half_width
        peak = FRICTION * 2.0 * self.normal_force / (np.pi * a)
        return peak * (self._arch(a) - (stick * self._arch(stick * a) if stick > 0.0 else 0.0))

    def _arch(self, width: float) -> Array:
        """Means of √(1 − x²/width²) over the windows."""
        across = self.cell_size * np.linspace(-0.5, 0.5, 41)
        return np.asarray(
            np.sqrt(np.maximum(1.0 - ((self.x[:, None] + across) / width) ** 2, 0.0)).mean(axis=1)
        )


def of_forces(tree: xr.DataTree, k: int) -> Tractions:
    """At output ``k``, from the forces of the cylinder's nodes over the length that belongs to each."""
    position, force, length = _nodes(tree, k)
    x, whole = position[:, 0], force.sum(axis=0)
    middle = float(np.sum(x * force[:, 1]) / whole[1])
    return _tractions(x - middle, force[:, 1], -force[:, 0], length, whole, tree)


def of_stress(tree: xr.DataTree, k: int) -> Tractions:
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


def half_way(tree: xr.DataTree) -> int:
    """The output at which Q is nearest to half of μ P."""
    whole = tree["series"]["contact_force"].isel(pair=0).values
    share = -whole[1:, 0] / (FRICTION * whole[1:, 1])
    return 1 + int(np.argmin(np.abs(share - 0.5)))


def partial_slip(tree: xr.DataTree) -> dict[str, float]:
    """Return ``share`` and ``cone`` [1], errors of ``stick`` [1], ``pressure`` and ``shear`` [%]."""
    found = of_forces(tree, half_way(tree))
    return {**_errors(found), "cone": _over_the_cone(tree, half_way(tree))}


def partial_slip_by_stress(tree: xr.DataTree) -> dict[str, float]:
    """The same but for the cone, by the stress of points."""
    return _errors(of_stress(tree, half_way(tree)))


def sliding(tree: xr.DataTree) -> float:
    """Q over μ P in the last eighth of the time, less one [%]."""
    last = tree["series"]["contact_force"].isel(pair=0).values[-(tree["series"].sizes["time"] // 8) :]
    return float(100.0 * (-last[:, 0].sum() / (FRICTION * last[:, 1].sum()) - 1.0))


def stick_when_sliding(tree: xr.DataTree) -> float:
    """c / a of the fit at the last output, where nothing sticks."""
    return of_forces(tree, -1).stick_of_fit


def shear_before(tree: xr.DataTree) -> float:
    """Shear that pressing alone leaves, by rms over that of μ times the pressure [%]."""
    found = of_forces(tree, 0)
    return 100.0 * _rms(found.shear) / (FRICTION * _rms(found.exact_pressure()))


def _errors(found: Tractions) -> dict[str, float]:
    bound = FRICTION * found.exact_pressure()
    return {
        "share": found.share,
        "stick": found.stick_of_fit - found.stick,
        "pressure": 100.0 * _rms(found.pressure - found.exact_pressure()) / _rms(found.exact_pressure()),
        "shear": 100.0 * _rms(found.shear - found.exact_shear(found.stick)) / _rms(bound),
    }


def _over_the_cone(tree: xr.DataTree, k: int) -> float:
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


def _nodes(tree: xr.DataTree, k: int) -> tuple[Array, Array, Array]:
    """Return position [m], force [N/m], (n, 2) each, and length (n,) [m] of nodes of the underside."""
    position, force, length = nodes_of(tree, "cylinder", k)
    low = (position[:, 1] < TOUCH[1] + 0.3) & (np.abs(position[:, 0] - TOUCH[0]) < 0.9 * SIDE)
    return position[low], force[low], length[low]


def _tractions(
    x: Array, pressure: Array, shear: Array, size: Array, whole: Array, tree: xr.DataTree
) -> Tractions:
    """Loads over size in windows of one cell within the reach, and the ``whole`` force (2,)."""
    h = float(tree.attrs["cell_size"])
    count = 2 * int(REACH / h) + 1
    index = np.floor(x / h + 0.5 * count).astype(int)
    within = (index >= 0) & (index < count)
    sums = [np.bincount(index[within], of[within], count) for of in (pressure, shear, size)]
    p, q = (load / np.maximum(sums[2], 1e-30) for load in sums[:2])
    return Tractions(h * (np.arange(count) - count // 2), p, q, float(whole[1]), -float(whole[0]), h)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
