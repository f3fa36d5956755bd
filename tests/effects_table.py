"""Scenes that differ by few effects, and what of arrays, hooks, modules and variables each effect brings."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, box, two_blocks, with_changes

Pairs = set[tuple[str, str]]


@dataclass(frozen=True)
class Brings:
    """What one effect adds to the least simulation; hooks are pairs of hook and plug-in."""

    arrays: frozenset[str] = frozenset()
    hooks: frozenset[tuple[str, str]] = frozenset()
    modules: frozenset[str] = frozenset()
    series: frozenset[str] = frozenset()
    points: frozenset[str] = frozenset()
    surface: frozenset[str] = frozenset()


def brings(
    plugin: str = "", *, hooks: str = "", arrays: str = "", modules: str = "", series: str = "", **more: str
) -> Brings:
    """Names apart by blanks; arrays without a group belong to the plug-in."""
    owned = (name if "/" in name else f"{plugin}/{name}" for name in arrays.split())
    return Brings(
        arrays=frozenset(owned),
        hooks=frozenset((hook, plugin) for hook in hooks.split()),
        modules=frozenset(modules.split()),
        series=frozenset(series.split()),
        points=frozenset(more.get("points", "").split()),
        surface=frozenset(more.get("surface", "").split()),
    )


#: What every simulation has.
LEAST = Brings(
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
    hooks=frozenset(
        (hook, who)
        for who, hooks in (
            ("body_series", "declare_fields setup diagnostics"),
            ("von_mises", "declare_fields diagnostics"),
            ("verdict", "diagnostics concerns"),
        )
        for hook in hooks.split()
    ),
    modules=frozenset(
        f"mpmfw.effects.{name}" for name in ("series", "verdict", "ledger_energies", "rotation")
    ),
    series=frozenset(
        {
            *("centre_of_mass", "mean_velocity", "angular_velocity", "linear_momentum", "angular_momentum"),
            *("kinetic_energy", "strain_energy", "total_energy"),
        }
    ),
    points=frozenset(
        ["position", "velocity", "mass", "volume", "deformation_gradient", "stress", "von_mises"]
    ),
)

_SHAPE = "setup particle_reach interpolate interpolate_surface"
_SURFACES = " ".join(
    ["mpmfw.contact.surfaces"]
    + [
        f"mpmfw.contact.surfaces.{name}"
        for name in (*("detection", "near_facets", "search", "assembly", "outline", "tracking", "covering"),)
    ]
)
EFFECTS = {
    "linear": brings("linear", hooks=_SHAPE, modules="mpmfw_shape.linear mpmfw_shape._tables"),
    "gimp": brings(
        "gimp",
        hooks=f"{_SHAPE} declare_fields",
        arrays="half_length",
        modules="mpmfw_shape.gimp mpmfw_shape._tables",
    ),
    "cpdi": brings(
        "cpdi",
        hooks=_SHAPE,
        arrays="layout/half_edges",
        modules="mpmfw_shape.cpdi mpmfw_shape._tables",
    ),
    "bspline": brings("bspline", hooks=_SHAPE, modules="mpmfw_shape.bspline mpmfw_shape._tables"),
    "cubic_bspline": brings(
        "cubic_bspline", hooks=_SHAPE, modules="mpmfw_shape.cubic_bspline mpmfw_shape._tables"
    ),
    "ck": brings("ck", hooks=_SHAPE, modules="mpmfw_shape.ck mpmfw_shape._tables"),
    "neo_hookean": brings(
        "neo_hookean soft",
        hooks="setup update_stress",
        modules="mpmfw_material.neo_hookean mpmfw_material._isotropic",
    ),
    "linear_elastic": brings(
        "linear_elastic soft",
        hooks="setup update_stress",
        modules="mpmfw_material.linear_elastic mpmfw_material._isotropic",
    ),
    "j2": brings(
        "j2 soft",
        hooks="setup update_stress declare_fields diagnostics",
        arrays="j2/plastic_strain j2/plastic_metric j2/plastic_work",
        series="material_dissipation",
        points="plastic_strain",
        modules="mpmfw_material.j2 mpmfw_material._isotropic",
    ),
    "domain tracking": brings(
        "cpdi2",
        hooks=f"{_SHAPE} declare_fields update_particle_domains diagnostics",
        arrays="corners layout/half_edges",
        modules="mpmfw_shape.cpdi2 mpmfw_shape.cpdi mpmfw_shape._tables",
        points="corners",
    ),
    "affine field": brings(arrays="particles/affine", series="affine_energy"),
    "affine moments": brings(arrays="particles/moment"),
    "gravity": brings("gravity", hooks="add_nodal_force", modules="mpmfw.effects.gravity"),
    "prescribed sides": brings(
        "constraint",
        hooks="setup constrain_momentum advect end_step",
        modules="mpmfw.effects.constraint mpmfw.effects.side_rows",
    ),
    "settling": brings(modules="mpmfw.effects.settling"),
    "sleep": brings(),
    "pressure": brings(
        "pressure on solid top",
        hooks="add_nodal_force end_step",
        modules="mpmfw.effects.side_loads",
    ),
    "load": brings("body_force field", hooks="add_nodal_force end_step", modules="mpmfw_load.body_force"),
    "thickness": brings(arrays="particles/thickness"),
    "surfaces": brings(
        "surface",
        hooks="setup detect advect",
        arrays="position displacement tributary facets neighbours star_first star body first body_first "
        "facet_first cell_mass",
        modules="mpmfw.effects.surface",
        surface="position next",
    ),
    "least gap": brings("gap", hooks="declare_fields diagnostics", series="min_gap"),
    "local spin": brings(
        "local_spin",
        hooks="declare_fields setup correct_inertia",
        arrays="change common layout/half_edges",
        modules="mpmfw.effects.local_spin mpmfw.effects.second_moments",
    ),
    "exact rotation": brings(
        "rotation",
        hooks="setup correct_inertia",
        arrays="layout/half_edges",
        modules="mpmfw.effects.exact_rotation mpmfw.effects.second_moments",
    ),
    "none": brings(modules="mpmfw_contact.baselines"),
    "separate": brings(modules="mpmfw_contact.baselines"),
    "bardenhagen": brings(
        "bardenhagen",
        hooks="declare_fields setup add_pairs detect after_momentum_projection after_momentum_update "
        "after_second_projection advect diagnostics concerns",
        arrays="impulse friction_impulse frictional_work damping_work energy count volume_gradient",
        modules="mpmfw_contact.bardenhagen mpmfw_contact.impulse mpmfw.contact.nodes "
        "mpmfw.contact.shared_nodes",
        series="contact_force friction_force contact_count frictional_work contact_energy damping_work",
    ),
    "averaged normals": brings(
        "leaning_normals",
        hooks="declare_fields setup add_pairs after_momentum_projection add_nodal_force "
        "after_momentum_update concerns",
        arrays="normal_impulse mean_normal lean",
        modules="mpmfw.contact.normal_bias",
    ),
    "distance of bodies": brings("bardenhagen", arrays="mean_position"),
    "penalty": brings(
        "penalty",
        hooks="declare_fields setup add_pairs detect add_nodal_force advect stable_timestep diagnostics "
        "concerns",
        arrays="impulse friction_impulse frictional_work damping_work spring_work energy count force master "
        "facet share gap "
        "normal inside inside_facet",
        modules=f"mpmfw_contact.penalty mpmfw_contact._springs mpmfw.contact.springs {_SURFACES}",
        series="contact_force friction_force contact_count frictional_work contact_energy damping_work "
        "spring_work",
        surface="force",
    ),
    "flutter": brings("flutter", hooks="diagnostics concerns", modules="mpmfw.effects.flutter"),
    "travel": brings("surface_travel", hooks="setup stable_timestep"),
    "interface layer": brings(
        "surface_layer",
        hooks="declare_fields setup after_momentum_projection after_second_projection advect",
        arrays="interface_mass interface_velocity",
        modules="mpmfw.contact.surfaces.layer",
    ),
    "ledger": brings(
        "energy_ledger",
        hooks="declare_fields end_step diagnostics",
        modules="mpmfw.effects.ledger mpmfw.effects.ledger_energies mpmfw.effects.ledger_half_step "
        "mpmfw.effects.energy_guard",
        series="transfer_dissipation energy_residual",
    ),
    "ledger of gravity": brings("energy_ledger", series="gravity_work"),
    "ledger of contact": brings("energy_ledger", series="contact_work contact_residual inertia_work"),
    "moment": brings(
        "contact_moment",
        hooks="declare_fields diagnostics",
        modules="mpmfw.effects.contact_moment",
        series="contact_moment",
    ),
    "watched": brings("verdict", hooks="end_step"),
    "stability": brings(
        "time_step_series",
        hooks="declare_fields diagnostics",
        modules="mpmfw.effects.time_step_series",
        series="time_step time_step_limit time_step_owner",
    ),
    "contact events": brings(
        "contact_events",
        hooks="declare_fields setup add_pairs end_step diagnostics concerns",
        series="steps_per_contact penetration",
    ),
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
    spin = {
        "bodies__left__rotation": "spin",
        "bodies__right__rotation": "spin",
    }  # not the default of linear functions
    return two_blocks(method, **{"shape__method": "linear", "output": {"gap": False}, **spin, **changes})


ONE = block(shape__method="linear", bodies__solid__rotation="lumped")
ELASTIC = {"model": "linear_elastic", "density": 1e3, "bulk_modulus": 1e6, "shear_modulus": 5e5}
YIELDS = {"model": "j2", "yield_stress": 1e4}
GRAVITY = {"vector": [0, -10]}
HELD = [{"side": "bottom", "fixed": True}]
FRICTIONLESS = ("penalty", "travel", "surfaces", "local spin", "watched")
TOUCHED = (*FRICTIONLESS, "flutter")
LEDGER = ("ledger",)
CASES = {
    "one body": Case(ONE, ()),
    "two bodies apart": Case(_apart(_two("penalty")), TOUCHED),
    "frictionless": Case(_two("penalty", contact__friction=0), FRICTIONLESS),
    "frictional": Case(_two("penalty"), TOUCHED),
    "contact with a layer": Case(
        _two("penalty", contact__penalty={"interface_thickness": 0.01}),
        (*(name for name in TOUCHED if name != "local spin"), "interface layer"),
    ),
    "damped contact": Case(_two("penalty", contact__penalty={"damping": 0.1}), TOUCHED),
    "gravity": Case(with_changes(ONE, gravity=GRAVITY), ("gravity",)),
    "settled": Case(
        with_changes(ONE, settle={"tolerance": 0.5}, gravity=GRAVITY, bodies__solid__sides=HELD),
        ("settling", "gravity", "prescribed sides"),
    ),
    "sleep": Case(_two("penalty", sleep={}), (*TOUCHED, "sleep")),
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
        _two("bardenhagen", output={"gap": False, "contact_moment": [0.0, 0.0]}),
        (
            "bardenhagen",
            "watched",
            "averaged normals",
            "local spin",
            "flutter",
            "moment",
        ),
    ),
    "pressure": Case(
        with_changes(ONE, bodies__solid__sides=[{"side": "top", "pressure": 1e3}]), ("pressure", "surfaces")
    ),
    "load": Case(with_changes(ONE, loads={"field": {"model": "body_force", "force": [0, -9]}}), ("load",)),
    "thickness": Case(with_changes(ONE, bodies__solid__thickness=0.1), ("thickness",)),
    "exact rotation": Case(with_changes(ONE, bodies__solid__rotation="exact"), ("exact rotation",)),
    "local spin": Case(with_changes(ONE, bodies__solid__rotation="spin"), ("local spin",)),
    "least gap": Case(_two("separate", output={}), ("separate", "least gap", "surfaces", "local spin")),
    "moving domains": Case(with_changes(ONE, shape__method="cpdi2"), ("affine field",), "domain tracking"),
    "gimp": Case(with_changes(ONE, shape__method="gimp"), ("affine field",), "gimp"),
    "cpdi": Case(with_changes(ONE, shape__method="cpdi"), ("affine field",), "cpdi"),
    "bspline": Case(with_changes(ONE, shape__method="bspline"), ("affine field",), "bspline"),
    "cubic_bspline": Case(
        with_changes(ONE, shape__method="cubic_bspline"), ("affine field",), "cubic_bspline"
    ),
    "ck": Case(with_changes(ONE, shape__method="ck"), ("affine field",), "ck"),
    "linear elastic": Case(with_changes(ONE, materials__soft=ELASTIC), (), material="linear_elastic"),
    "plastic": Case(with_changes(ONE, materials__soft={**ELASTIC, **YIELDS}), (), material="j2"),
    "three dimensions": Case(box(shape__method="linear", bodies__solid__rotation="lumped"), ()),
    "no contact": Case(_two("none"), ("none", "watched")),
    "contact by velocity": Case(
        _two("bardenhagen"), ("bardenhagen", "watched", "averaged normals", "local spin", "flutter")
    ),
    "contact by position": Case(
        _two("bardenhagen", contact__bardenhagen={"criterion": "position"}),
        ("bardenhagen", "watched", "averaged normals", "distance of bodies", "local spin", "flutter"),
    ),
    "one body's normal": Case(
        _two("bardenhagen", contact__bardenhagen={"normal": "master"}),
        ("bardenhagen", "watched", "local spin", "flutter"),
    ),
    "flip": Case(with_changes(ONE, stepping={"transfer": "flip"}), ()),
    "pic": Case(with_changes(ONE, stepping={"transfer": "pic"}), ()),
    "apic": Case(with_changes(ONE, stepping={"transfer": "apic"}), ("affine field", "affine moments")),
    "tpic": Case(with_changes(ONE, stepping={"transfer": "tpic"}), ("affine field",)),
    "aflip": Case(with_changes(ONE, stepping={"transfer": "aflip"}), ("affine field",)),
}


def arrays_of(sim: Simulation) -> set[str]:
    """Names of all arrays with entries that the state holds, the plug-ins' own included."""
    state, names = sim.state, set(sim.state.arrays)
    for group in ("particles", "grid", "surface"):
        struct = getattr(state, group)
        for entry in () if struct is None else dataclasses.fields(struct):
            value = getattr(struct, entry.name)
            if isinstance(value, np.ndarray) and value.size:
                names.add(f"{group}/{entry.name}")
    return names


def hooks_of(sim: Simulation) -> Pairs:
    """Pairs of hook and plug-in."""
    return {(hook, who) for hook, callers in sim.hook_callers().items() for who in callers}
