"""Scenes that differ by few effects, and what of arrays, hooks, modules and variables each effect brings."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, box, two_blocks, with_changes


@dataclass(frozen=True)
class Brings:
    """What one effect adds to the least simulation: arrays or their groups, plug-ins with hooks, modules."""

    arrays: frozenset[str] = frozenset()
    owners: frozenset[str] = frozenset()
    modules: frozenset[str] = frozenset()
    series: frozenset[str] = frozenset()


def brings(owner: str = "", *, arrays: str = "", modules: str = "", series: str = "") -> Brings:
    """Names apart by blanks; modules of effects and of bundled plug-ins without what is common."""
    places = ((".", "mpmfw.effects."), ("~", "mpmfw.contact."), ("", "mpmfw_"))
    full = (
        next(place + name.removeprefix(mark) for mark, place in places if name.startswith(mark))
        for name in modules.split()
    )
    return Brings(*(frozenset(x) for x in (arrays.split(), [owner] * bool(owner), full, series.split())))


#: What every simulation has.
LEAST = Brings(
    owners=frozenset({"body_series", "von_mises", "verdict"}),
    arrays=frozenset(
        f"{group}/{name}"
        for group, names in (
            ("particles", "position velocity mass initial_volume volume stress first"),
            ("particles", "deformation_gradient velocity_gradient"),
            ("grid", "lower nodes window_lower window_shape offset position mass momentum"),
            ("grid", "start_velocity force velocity"),
        )
        for name in names.split()
    ),
    modules=brings(modules=".series .verdict").modules,
    series=frozenset(
        {
            *("centre_of_mass", "mean_velocity", "angular_velocity", "linear_momentum", "angular_momentum"),
            *("kinetic_energy", "strain_energy", "total_energy"),
        }
    ),
)

_SURFACES = "~surfaces " + " ".join(
    f"~surfaces.{name}"
    for name in ("detection", "near_facets", "search", "assembly", "outline", "surface_rows")
)
_CONTACT = "contact_force friction_force contact_count frictional_work contact_energy damping_work"
_ISOTROPIC = "material._isotropic"
_SOIL = " material._frictional material._return"
EFFECTS = {
    **{
        name: brings(name, modules=f"shape.{name} shape._tables")
        for name in ("linear", "bspline", "cubic_bspline", "ck")
    },
    "gimp": brings("gimp", arrays="gimp", modules="shape.gimp shape._tables"),
    "cpdi": brings("cpdi", arrays="layout", modules="shape.cpdi shape._tables"),
    "domain tracking": brings("cpdi2", arrays="cpdi2 layout", modules="shape.cpdi2 shape.cpdi shape._tables"),
    "neo_hookean": brings("neo_hookean soft", modules=f"material.neo_hookean {_ISOTROPIC}"),
    "linear_elastic": brings("linear_elastic soft", modules=f"material.linear_elastic {_ISOTROPIC}"),
    **{
        model: brings(
            f"{model} soft",
            arrays=model,
            series="material_dissipation",
            modules=f"material.{model} material._plastic {_ISOTROPIC}{more}",
        )
        for model, more in (("j2", ""), ("mohr_coulomb", _SOIL), ("drucker_prager", _SOIL))
    },
    "affine field": brings(arrays="particles/affine", series="affine_energy"),
    "affine moments": brings(arrays="particles/moment"),
    "gravity": brings("gravity", modules=".gravity"),
    "prescribed sides": brings(
        "constraint", modules=".constraint .side_impulses .side_rows", series="side_reaction side_work"
    ),
    "settling": brings(modules=".settling"),
    "pressure": brings("pressure on solid top", modules=".side_loads"),
    "damping": brings(
        "material_damping", arrays="material_damping", modules=".damping", series="viscous_dissipation"
    ),
    "averaged volume": brings("averaged_volume", modules=".averaged_volume"),
    "load": brings("body_force field", modules="load.body_force"),
    "thickness": brings(arrays="particles/thickness"),
    "initial stress": brings("initial_stress", modules=".initial_stress"),
    "axisymmetry": brings("axisymmetry", arrays="particles/thickness", modules=".axisymmetry"),
    "surfaces": brings("surface", arrays="surface", modules=".surface"),
    "least gap": brings("gap", series="min_gap"),
    "local spin": brings("local_spin", arrays="layout", modules=".local_spin"),
    "exact rotation": brings("rotation", arrays="layout", modules=".exact_rotation .local_spin"),
    "none": brings(modules="contact.baselines"),
    "separate": brings(modules="contact.baselines"),
    "bardenhagen": brings(
        "bardenhagen",
        arrays="bardenhagen",
        modules="contact.bardenhagen contact.impulse ~nodes ~shared_nodes",
        series=_CONTACT,
    ),
    "normals": brings(modules="~normal_bias"),
    "penalty": brings(
        "penalty",
        arrays="penalty",
        modules=f"contact.penalty contact._springs ~springs {_SURFACES}",
        series=f"{_CONTACT} spring_work",
    ),
    "flutter": brings("flutter", modules=".flutter"),
    "travel": brings("surface_travel"),
    "seams": brings(modules="~surfaces.seams"),
    "self-contact": brings(arrays="grid/sheets", modules="~surfaces.self_contact ~surfaces.one_part"),
    "interface layer": brings("surface_layer", arrays="surface_layer", modules="~surfaces.layer"),
    "ledger": brings(
        "energy_ledger",
        modules=".ledger .ledger_works",
        series="transfer_dissipation energy_residual",
    ),
    "ledger of gravity": brings(series="gravity_work"),
    "ledger of contact": brings(series="contact_work contact_residual inertia_work"),
    "rigid bodies": brings(
        "rigid",
        modules=".rigid .rigid_motion .rigid_kinematics .reaction .contact_moment",
        series="reaction reaction_moment reaction_work",
    ),
    "reaction": brings("reaction"),
    "pairs of rigid bodies": brings("rigid_pairs", modules=".rigid_pairs"),
    "forces on rigid bodies": brings("rigid_forces", modules=".rigid_forces"),
    "moment": brings("contact_moment", modules=".contact_moment", series="contact_moment"),
    "stability": brings(
        "time_step_series",
        series="time_step time_step_limit time_step_owner",
    ),
    "contact events": brings("contact_events", series="steps_per_contact penetration"),
}


@dataclass(frozen=True)
class Case:
    """A scene and the effects that are on in it."""

    scene: dict[str, Any]
    effects: tuple[str, ...]
    shape: str = "linear"
    material: str = "neo_hookean"

    def expected(self, what: str) -> frozenset[Any]:
        """Union of what the effects bring."""
        parts = [
            LEAST,
            EFFECTS[self.shape],
            EFFECTS[self.material],
            *(EFFECTS[name] for name in self.effects),
        ]
        return frozenset().union(*(getattr(part, what) for part in parts))


def _apart(scene: dict[str, Any]) -> dict[str, Any]:
    """The two blocks a metre apart and at rest: their boxes are farther from each other than any reach."""
    for name, left in (("left", -1.0), ("right", 0.5)):
        geometry = {"type": "rectangle", "lower": [left, -0.25], "upper": [left + 0.5, 0.25]}
        own = {f"bodies__{name}__geometry": geometry, f"bodies__{name}__velocity": [0, 0]}
        scene = with_changes(scene, **own)
    return scene


def _two(method: str, **changes: Any) -> dict[str, Any]:
    # Not the default of linear functions
    spin = {"bodies__left__rotation": "spin", "bodies__right__rotation": "spin"}
    return two_blocks(method, **{"shape__method": "linear", "output": {"gap": False}, **spin, **changes})


ONE = block(shape__method="linear", bodies__solid__rotation="lumped")
ELASTIC = {"model": "linear_elastic", "density": 1e3, "bulk_modulus": 1e6, "shear_modulus": 5e5}
REVOLVED = {
    "grid": {"cell_size": 0.25, "lower": [0.0, -2.0], "upper": [2.0, 2.0], "axisymmetric": True},
    "bodies__solid__geometry": {"type": "rectangle", "lower": [0.5, -0.5], "upper": [1.5, 0.5]},
}
YIELDS = {"model": "j2", "yield_stress": 1e4}
SOIL = {"friction_angle": 0.5, "cohesion": 1e4}
GRAVITY = {"vector": [0, -10]}
_RIGHT = {"type": "rectangle", "lower": [0.005, -0.25], "upper": [0.505, 0.25]}
HELD = [{"side": "bottom", "fixed": True}]
FRICTIONLESS = ("penalty", "travel", "surfaces", "local spin")
TOUCHED = (*FRICTIONLESS, "flutter")
LEDGER = ("ledger",)
BY_NODES = ("bardenhagen", "normals", "local spin", "flutter")
CASES = {
    "one body": Case(ONE, ()),
    "two bodies apart": Case(_apart(_two("penalty")), TOUCHED),
    "frictionless": Case(_two("penalty", contact__friction=0), FRICTIONLESS),
    "frictional": Case(_two("penalty"), TOUCHED),
    "rigid": Case(
        _two("penalty", bodies__right={"geometry": _RIGHT, "rigid": True}),
        (*TOUCHED, "rigid bodies", "reaction"),
    ),
    "rigid pair": Case(
        with_changes(
            _two("penalty", bodies__right={"geometry": _RIGHT, "rigid": {"density": 1e3}}),
            bodies__floor={
                "geometry": {"type": "half_space", "point": [0, -9], "normal": [0, 1]},
                "rigid": True,
            },
        ),
        (*TOUCHED, "seams", "rigid bodies", "reaction", "pairs of rigid bodies"),
    ),
    "pressed": Case(
        _two("penalty", bodies__right={"geometry": _RIGHT, "rigid": {"density": 1e3, "force": [-1.0, 0.0]}}),
        (*TOUCHED, "rigid bodies", "reaction", "forces on rigid bodies"),
    ),
    "contact with a layer": Case(
        _two("penalty", contact__penalty={"interface_thickness": 0.01}),
        (*(name for name in TOUCHED if name != "local spin"), "interface layer"),
    ),
    "self-contact": Case(
        _two("penalty", bodies__left__self_contact=True, bodies__left__rotation="lumped"),
        (*TOUCHED, "self-contact"),
    ),
    "gravity": Case(with_changes(ONE, gravity=GRAVITY), ("gravity",)),
    "settled": Case(
        with_changes(ONE, settle={"tolerance": 0.5}, gravity=GRAVITY, bodies__solid__sides=HELD),
        ("settling", "gravity", "prescribed sides"),
    ),
    "sleep": Case(_two("penalty", sleep={}), TOUCHED),
    "ledger": Case(with_changes(ONE, output={"ledger": True}), LEDGER),
    "ledger of a falling body": Case(
        with_changes(ONE, output={"ledger": True}, gravity=GRAVITY),
        (*LEDGER, "gravity", "ledger of gravity"),
    ),
    "ledger of contact": Case(
        _two("penalty", output={"gap": False, "ledger": True}), (*TOUCHED, *LEDGER, "ledger of contact")
    ),
    "stability of one body": Case(with_changes(ONE, output={"stability": True}), ("stability",)),
    "stability of contact": Case(
        _two("penalty", output={"gap": False, "stability": True}), (*TOUCHED, "stability", "contact events")
    ),
    "moment of forces": Case(
        _two("penalty", output={"gap": False, "contact_moment": "centre_of_mass"}),
        (*TOUCHED, "moment"),
    ),
    "moment of impulses": Case(
        _two("bardenhagen", output={"gap": False, "contact_moment": [0.0, 0.0]}), (*BY_NODES, "moment")
    ),
    "pressure": Case(
        with_changes(ONE, bodies__solid__sides=[{"side": "top", "pressure": 1e3}]), ("pressure", "surfaces")
    ),
    "load": Case(with_changes(ONE, loads={"field": {"model": "body_force", "force": [0, -9]}}), ("load",)),
    "damping": Case(with_changes(ONE, materials__soft__damping={"bulk": 1e-3}), ("damping",)),
    "averaged volume": Case(with_changes(ONE, bodies__solid__volumetric="averaged"), ("averaged volume",)),
    "thickness": Case(with_changes(ONE, bodies__solid__thickness=0.1), ("thickness",)),
    "axisymmetry": Case(with_changes(ONE, **REVOLVED), ("axisymmetry",)),
    "exact rotation": Case(with_changes(ONE, bodies__solid__rotation="exact"), ("exact rotation",)),
    "local spin": Case(with_changes(ONE, bodies__solid__rotation="spin"), ("local spin",)),
    "least gap": Case(_two("separate", output={}), ("separate", "least gap", "surfaces", "local spin")),
    "moving domains": Case(with_changes(ONE, shape__method="cpdi2"), ("affine field",), "domain tracking"),
    **{
        shape: Case(with_changes(ONE, shape__method=shape), ("affine field",), shape)
        for shape in ("gimp", "cpdi", "bspline", "cubic_bspline", "ck")
    },
    "linear elastic": Case(with_changes(ONE, materials__soft=ELASTIC), (), material="linear_elastic"),
    "plastic": Case(
        with_changes(ONE, materials__soft={**ELASTIC, **YIELDS}), ("averaged volume",), material="j2"
    ),
    **{
        model: Case(
            with_changes(ONE, materials__soft={**ELASTIC, **SOIL, "model": model}),
            ("averaged volume",),
            material=model,
        )
        for model in ("mohr_coulomb", "drucker_prager")
    },
    "initial stress": Case(
        with_changes(
            ONE,
            materials__soft={**ELASTIC, **SOIL, "model": "mohr_coulomb"},
            bodies__solid__initial_stress={"k0": 0.5},
            gravity=GRAVITY,
        ),
        ("initial stress", "averaged volume", "gravity"),
        material="mohr_coulomb",
    ),
    "three dimensions": Case(box(shape__method="linear", bodies__solid__rotation="lumped"), ()),
    "no contact": Case(_two("none"), ("none",)),
    "contact by velocity": Case(_two("bardenhagen"), BY_NODES),
    "contact by position": Case(
        _two("bardenhagen", contact__bardenhagen={"criterion": "position"}), BY_NODES
    ),
    "given normal": Case(
        _two("bardenhagen", contact__bardenhagen={"normal": "specified", "direction": [1.0, 0.0]}),
        ("bardenhagen", "local spin", "flutter"),
    ),
    "apic": Case(with_changes(ONE, stepping={"transfer": "apic"}), ("affine field", "affine moments")),
    "tpic": Case(with_changes(ONE, stepping={"transfer": "tpic"}), ("affine field",)),
    "aflip": Case(with_changes(ONE, stepping={"transfer": "aflip"}), ("affine field",)),
}


def arrays_of(sim: Simulation) -> set[str]:
    """Arrays with entries of points and grid, and groups of all others that the state holds."""
    state, names = sim.state, {name.partition("/")[0] for name in sim.state.arrays}
    for group in ("particles", "grid", "surface"):
        struct = getattr(state, group)
        for entry in () if struct is None else dataclasses.fields(struct):
            value = getattr(struct, entry.name)
            if isinstance(value, np.ndarray) and value.size:
                names.add(group if group == "surface" else f"{group}/{entry.name}")
    return names - {"particles", "grid"}


def hooks_of(sim: Simulation) -> set[tuple[str, str]]:
    """Pairs of hook and plug-in."""
    return {(hook, who) for hook, callers in sim.hook_callers().items() for who in callers}
