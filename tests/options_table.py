"""For every option of a scene, and of plug-ins where the conformance kit does not ask, a tiny scene in which
its two values, or all its words, differ.

A key is ``Table.field`` for the scene's own tables and ``kind.plug-in.option`` for plug-ins.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from mpmfw.plugin.discovery import load
from msh_files import write_msh
from scenes_for_tests import SOFT, block, one_body, solid, two_blocks, with_changes

Changes = dict[str, Any]


class Acts(NamedTuple):
    """A scene and two sets of changes, by ``a__b`` for the key ``a.b``."""

    scene: dict[str, Any]
    first: Changes
    second: Changes


TIME = {"time": {"end": 6e-3, "output_interval": 3e-3}}
G = {"vector": [0, -100]}
HELD = [{"side": "bottom", "fixed": True}]
SOLID = "bodies__solid"


def body(geometry: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """One body of few points that falls, turns and has been pushed; ``geometry`` in place of the square."""
    scene = block() if geometry is None else one_body(geometry, size=0.125)
    plane = len(scene["grid"]["lower"]) == 2
    spin = {f"{SOLID}__angular_velocity": 3.0} if plane else {f"{SOLID}__angular_velocity": [0.0, 0.0, 3.0]}
    gravity = {"vector": [0.0, -100.0] + [0.0] * (not plane)}
    return with_changes(
        scene, **{**TIME, **spin, "gravity": gravity, f"{SOLID}__particles__size": 0.25, **changes}
    )


BURIED = with_changes(
    block(), **TIME, gravity=G, bodies__solid__sides=HELD, bodies__solid__initial_stress={"k0": 0.5},
    materials__soft={**SOFT, "model": "mohr_coulomb", "friction_angle": 0.5, "cohesion": 1e5},
)  # fmt: skip
CLIP = with_changes(
    block(shape__method="cpdi"), **TIME, contact={"method": "penalty"}, bodies__solid__sides=HELD,
    bodies__solid__geometry={
        "type": "polygon",
        "points": [[-1, -1], [1, -1], [1, -0.1], [-0.5, -0.1], [-0.5, 0.1], [1, 0.1], [1, 1], [-1, 1]],
    },
    gravity={"vector": [0, -5e3]},
)  # fmt: skip
REVOLVED = with_changes(
    block(), **TIME, bodies__solid__geometry={"type": "rectangle", "lower": [0.5, -0.5], "upper": [1.5, 0.5]},
    bodies__solid__velocity=[1.0, 0.0], grid__lower=[0.0, -2.0],
)  # fmt: skip


def held(**changes: Any) -> dict[str, Any]:
    """One square that hangs from nothing: its bottom is fixed, its weight bears on it."""
    return with_changes(block(), **{**TIME, "gravity": G, f"{SOLID}__sides": HELD, **changes})


def pair(method: str = "penalty", **changes: Any) -> dict[str, Any]:
    """Two squares a millimetre apart that meet in the first steps and slip along each other."""
    scene = two_blocks(method, **TIME)
    right = {"type": "rectangle", "lower": [-0.004, -0.2], "upper": [0.496, 0.3]}
    return with_changes(scene, **{"bodies__right__geometry": right, **changes})


def values(scene: dict[str, Any], key: str, first: Any, second: Any) -> Acts:
    """Two values of one key."""
    return Acts(scene, {key: first}, {key: second})


PLATE = {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]}
SECTION = {"type": "rectangle", "lower": [0.2, -0.4], "upper": [0.5, 0.4]}
CENTRE, TURN = [0.03, 0.07, 0.05], [0.0, 0.0, 0.0]
ROUND = {"centre": CENTRE, "radius": 0.5}
SHAPES: dict[str, dict[str, Any]] = {
    "disc": {"centre": CENTRE[:2], "radius": 0.5},
    "ring": {"centre": CENTRE[:2], "inner_radius": 0.3, "outer_radius": 0.7},
    "rectangle": {"lower": [-0.5, -0.5], "upper": [0.5, 0.5], "angle": 0.0},
    "polygon": {"points": [[-0.5, -0.5], [0.5, -0.5], [0.0, 0.5]], "holes": []},
    "box": {"lower": [-0.5] * 3, "upper": [0.5] * 3, "angles": TURN},
    "ball": ROUND,
    "cylinder": {**ROUND, "length": 0.6, "axis": "z", "angles": TURN},
    "torus": {**ROUND, "tube_radius": 0.2, "axis": "z", "angles": TURN},
    "extrusion": {"outline": PLATE, "low": -0.3, "high": 0.3, "angles": TURN},
    "revolution": {"outline": SECTION, "origin": [0.0] * 3, "axis": "z", "angles": TURN},
}
HOLE = [[-0.1, -0.2], [0.1, -0.2], [0.0, 0.0]]
SIDES = f"{SOLID}__sides"


def other(value: Any) -> Any:
    """Another value: a number a bit larger, a list with another first entry, another axis or outline."""
    if isinstance(value, list):
        return [other(value[0]), *value[1:]] if value else [HOLE]
    if isinstance(value, dict):
        return {**value, "upper": other(value["upper"])}
    return "x" if value == "z" else value + 0.1


def geometry(kind: str, key: str) -> Acts:
    """Two values of one key of a geometry, the others as in :data:`SHAPES`."""
    shape = {"type": kind, **SHAPES[kind]}
    return Acts(body(shape), {}, {f"{SOLID}__geometry": {**shape, key: other(shape[key])}})


SETTLED = held(settle={"tolerance": 0.1, "max_time": 0.05})
RESTING = pair(
    time={"end": 0.1, "output_interval": 0.1},
    bodies__left__geometry={"type": "rectangle", "lower": [-1.8, -0.2], "upper": [-1.3, 0.3]},
    bodies__right__geometry={"type": "rectangle", "lower": [1.3, -0.2], "upper": [1.8, 0.3]},
    bodies__left__velocity=[0.01, 0.0],
    bodies__right__velocity=[0.0, 0.01],
)
STICKY, SMOOTH = (
    {"bodies": ["left", "right"], "friction": 0.5},
    {"bodies": ["left", "right"], "friction": 0.0},
)
THIRD = solid([0.505, -0.2], [0.9, 0.3], 0.25, velocity=[-8.0, -3.0])
#: Plug-ins that the tests of the options announce.
TABLE, FAST = {"model": "shaken"}, {"model": "fastest"}
AIR = {"model": "drag", "rate": 30.0}
OVERLAPPING = pair(bodies__right__geometry={"type": "rectangle", "lower": [-0.1, -0.2], "upper": [0.4, 0.3]})

ROUND_BODY = body({"type": "disc", **SHAPES["disc"]})
TILTED, STEEPER, WEAKER = ({"magnitude": g, "tilt": tilt} for g, tilt in ((9, 0.1), (9, 0.2), (8, 0.1)))
GRAVITIES = [
    *(("magnitude", TILTED, WEAKER), ("tilt", TILTED, STEEPER), ("vector", G, {"vector": [1, -100]})),
    ("table", {"table": [[0, 0, -9], [1, 0, -9]]}, {"table": [[0, 0, -9], [0.01, 0, 9]]}),
]
LOADS = [("pressure", 1e3, 2e3), ("traction", [1e3, 0], [2e3, 0]), ("force", [1e3, 0], [2e3, 0])]
DAMPINGS: list[tuple[str, dict[str, float]]] = [
    *(("bulk", {}), ("shear", {}), ("critical", {"frequency": 1.0}), ("frequency", {"critical": 1e-6}))
]
OTHER_MATERIAL = {**SOFT, "shear_modulus": 1e6}
FIELD = {"model": "body_force", "force": [9.0, 0.0]}
PARTS = [
    {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
    {"type": "disc", "centre": [0.5, 0.5], "radius": 0.3},
]
OTHER_PART = {"type": "disc", "centre": [0.5, 0.5], "radius": 0.2}
RIGID = {"type": "rectangle", "lower": [0.005, -0.25], "upper": [0.505, 0.25]}
WALL = {"type": "half_space", "point": [0.005, 0.0], "normal": [-1.0, 0.0], "extent": 9.0}
NUDGED = {"velocity": [-1.0, 0.0], "angular_velocity": 2.0, "about": [0.2, 0.0]}


def against(rigid: Any, **own: Any) -> dict[str, Any]:
    """A square that meets a rigid one."""
    return pair(bodies__right={"geometry": RIGID, "rigid": rigid, **own})


#: Scene, key and its two values; the key is the option's, with two underscores for the dot, where it is "".
ROWS: dict[str, tuple[dict[str, Any], str, Any, Any]] = {
    "Tables.title": (body(), "title", "one", "another"),
    "Tables.allow_overlap": (OVERLAPPING, "allow_overlap", False, True),
    "Tables.allow_unstable": (body(time__safety=0.9), "allow_unstable", False, True),
    "Tables.bodies": (body(), f"{SOLID}__velocity", [1.0, 0.0], [0.0, 1.0]),
    "Tables.gravity": (held(), "gravity", G, {"vector": [0, -50]}),
    "Tables.outputs": (body(), "outputs", {}, {"fast": FAST}),
    "Sleep.strain": ({**RESTING, "sleep": {"crossings": 1.0}}, "", 1e-9, 1e-2),
    "Sleep.crossings": ({**RESTING, "sleep": {"strain": 1e-2}}, "", 1.0, 1e3),
    "Reference.kind": (body(), "", "sliding-block", "none of them"),
    "Grid.cell_size": (body(), "", 0.25, 0.3),
    "Grid.lower": (body(), "", [-2.0, -2.0], [-2.1, -2.1]),
    "Grid.axisymmetric": (REVOLVED, "", False, True),
    "Grid.upper": (body(), "", [2.0, 2.0], [0.4, 0.4]),
    "Time.end": (body(), "", 6e-3, 4e-3),
    "Time.outputs": (body(time__output_interval=2.2e-3), "", "exact", "nearest"),
    "Time.output_interval": (body(), "", 3e-3, 2e-3),
    "Time.safety": (body(), "", 0.5, 0.3),
    "Time.step": (body(), "", 1e-3, 5e-4),
    "Stepping.scheme": (body(), "", "usl", "musl"),
    "Stepping.transfer": (body(), "", "flip", "apic"),
    "Stepping.transported": (body(), "", True, False),
    "Stepping.pic_fraction": (body(stepping__transfer="flip"), "", 0.0, 0.3),
    "Shape.method": (body(), "", "cpdi", "bspline"),
    "Contact.method": (pair(), "", "penalty", "bardenhagen"),
    "Contact.friction": (pair(), "", 0.1, 0.4),
    "Contact.friction_law": (pair(contact__mohr_coulomb={"cohesion": 1e4}), "", "coulomb", "mohr_coulomb"),
    "Contact.pairs": (pair(), "", [STICKY], [SMOOTH]),
    "ContactPair.bodies": (
        *(pair(bodies__third=THIRD), "contact__pairs"),
        *([STICKY], [{**STICKY, "bodies": ["right", "third"]}]),
    ),
    "ContactPair.friction": (pair(), "contact__pairs", [STICKY], [{**STICKY, "friction": 0.1}]),
    "ContactPair.method": (pair(), "contact__pairs", [STICKY], [{**STICKY, "method": "tied"}]),
    "Material.model": (held(), "materials__soft__model", "neo_hookean", "linear_elastic"),
    "Material.density": (body(), "materials__soft__density", 1000.0, 1200.0),
    "Material.damping": (body(), "materials__soft__damping", {"bulk": 1e-3}, {"shear": 1e-3}),
    **{
        f"Damping.{key}": (body(), "materials__soft__damping", {**beside, key: 1e-3}, {**beside, key: 2e-3})
        for key, beside in DAMPINGS
    },
    "Body.material": (held(materials__other=OTHER_MATERIAL), f"{SOLID}__material", "soft", "other"),
    "Body.geometry": (body(), f"{SOLID}__geometry__upper", [0.5, 0.5], [0.4, 0.5]),
    "Body.particles": (body(), f"{SOLID}__particles__size", 0.25, 0.125),
    "Body.segment": (pair(), "bodies__left__segment", 0.0625, 0.125),
    "Body.velocity": (body(), f"{SOLID}__velocity", [1.0, 0.0], [0.0, 1.0]),
    "Body.angular_velocity": (body(), f"{SOLID}__angular_velocity", 3.0, 2.0),
    "Body.rotation": (
        *(body(gravity={"vector": [0, -1]}, **{SIDES: [{"side": "top", "pressure": 1e4}]}),),
        *(f"{SOLID}__rotation", "exact", "lumped"),
    ),
    "Body.volumetric": (held(), f"{SOLID}__volumetric", "auto", "averaged"),
    "Body.self_contact": (CLIP, f"{SOLID}__self_contact", False, True),
    "Body.initial_stress": (BURIED, f"{SOLID}__initial_stress", None, {"k0": 0.5}),
    "InitialStress.k0": (BURIED, f"{SOLID}__initial_stress", {"k0": 0.5}, {"k0": 0.7}),
    "InitialStress.density": (BURIED, f"{SOLID}__initial_stress", {"k0": 0.5}, {"k0": 0.5, "density": 2e3}),
    "InitialStress.top": (BURIED, f"{SOLID}__initial_stress", {"k0": 0.5}, {"k0": 0.5, "top": 1.0}),
    "InitialStress.table": (
        *(BURIED, f"{SOLID}__initial_stress", {"table": [[0, 0, 0], [1, 1e4, 5e3]]}),
        {"table": [[0, 0, 0], [1, 1e4, 6e3]]},
    ),
    "Body.sides": (held(), SIDES, HELD, [{"side": "left", "fixed": True}]),
    "Body.thickness": (body(), f"{SOLID}__thickness", 1.0, 0.1),
    "RigidBody.rigid": (against(True), "bodies__right__rigid", True, {"density": 1e3}),
    "RigidBody.geometry": (against(True), "bodies__right__geometry__upper", [0.505, 0.25], [0.505, 0.0]),
    "RigidBody.segment": (against(True), "bodies__right__segment", 0.0625, 0.125),
    "RigidBody.velocity": (against({"density": 1e3}), "bodies__right__velocity", [-1.0, 0.0], [-2.0, 0.0]),
    "RigidBody.angular_velocity": (against({"density": 1e3}), "bodies__right__angular_velocity", 1.0, 2.0),
    "RigidBody.thickness": (
        against({"density": 1e3}, velocity=[-1.0, 0.0]),
        "bodies__right__thickness",
        1.0,
        0.1,
    ),
    **{
        f"HalfSpace.{key}": (
            pair(bodies__right={"geometry": WALL, "rigid": True}),
            *(f"bodies__right__geometry__{key}", WALL[key], other),
        )
        for key, other in (("point", [0.0, 1.0]), ("normal", [-1.0, 0.1]), ("extent", 99.0))
    },
    "Rigid.motion": (against({"motion": NUDGED}), "bodies__right__rigid__motion__velocity", [-1, 0], [0, 1]),
    "Rigid.density": (
        against({"density": 1e3}, velocity=[-1.0, 0.0]),
        "bodies__right__rigid__density",
        1e3,
        2e3,
    ),
    **{
        f"Rigid.{key}": (
            *(against({"mass": 100.0, "inertia": 10.0}, angular_velocity=1.0),),
            *(f"bodies__right__rigid__{key}", 100.0, 50.0),
        )
        for key in ("mass", "inertia")
    },
    **{
        f"Rigid.{key}": (
            *(against({"density": 1e3, "force": [-9e5, 0.0]}), f"bodies__right__rigid__{key}"),
            *(one, other),
        )
        for key, one, other in (
            ("force", [-9e5, 0.0], [[0.0, -9e5, 0.0], [3e-3, 0.0, 0.0]]),
            ("torque", 0.0, 9e4),
        )
    },
    "Rigid.held": (
        against({"density": 1e3}, velocity=[-1.0, 0.0]),
        *("bodies__right__rigid__held", [], ["x"]),
    ),
    **{
        f"Motion.{key}": (against({"motion": NUDGED}), f"bodies__right__rigid__motion__{key}", one, other)
        for key, one, other in (
            ("velocity", [-1.0, 0.0], [[0.0, -1.0, 0.0], [3e-3, 0.0, 0.0]]),
            ("angular_velocity", 2.0, [[0.0, 2.0], [3e-3, 0.0]]),
            ("about", [0.2, 0.0], [0.0, 0.0]),
            ("surface_velocity", [0.0, 0.0], [0.0, 5.0]),
        )
    },
    "Side.side": (held(), SIDES, HELD, [{"side": "right", "fixed": True}]),
    "Side.within": (
        *(held(), SIDES, [{"side": "top", "pressure": 1e4}]),
        [{"side": "top", "pressure": 1e4, "within": [[-1.0, -1.0], [0.0, 1.0]]}],
    ),
    "Side.fixed": (held(), SIDES, HELD, [{"side": "bottom", "fixed": ["x"]}]),
    "Side.velocity": (
        *(held(), SIDES),
        *(
            [{"side": "top", "velocity": [0, 1]}],
            [{"side": "top", "velocity": [[0, "free", 1], [1, "free", 2]]}],
        ),
    ),
    **{
        f"Side.{key}": (held(), SIDES, [{"side": "top", key: first}], [{"side": "top", key: second}])
        for key, first, second in LOADS
    },
    "Load.model": (held(), "loads__air", AIR, FIELD),
    "Load.bodies": (pair(loads={"air": AIR}), "loads__air__bodies", ["left"], ["left", "right"]),
    "Boundary.model": (body(boundaries={"a": TABLE}), "boundaries__a__model", "shaken", "none of them"),
    "Boundary.bodies": (pair(boundaries={"a": TABLE}), "boundaries__a__bodies", ["left"], ["left", "right"]),
    "Series.model": (body(outputs={"a": FAST}), "outputs__a__model", "fastest", "none of them"),
    "Series.bodies": (pair(outputs={"a": FAST}), "outputs__a__bodies", ["left"], ["left", "right"]),
    **{f"Gravity.{key}": (held(), "gravity", first, second) for key, first, second in GRAVITIES},
    "Settle.tolerance": (held(settle={"max_time": 0.5}), "", 0.2, 0.05),
    "Settle.max_time": (held(settle={"tolerance": 1e-6}), "", 0.01, 0.03),
    "Settle.gravity": (SETTLED, "", G, {"vector": [0, -50]}),
    "Output.gap": (pair("separate"), "", True, False),
    "Output.surface": (pair(), "", True, False),
    **{f"Output.{key}": (body(), "", True, False) for key in ("particles", "energy", "ledger", "stability")},
    "Output.particle_interval": (body(time__output_interval=1e-3), "", None, 2e-3),
    "Output.side_moment": (held(), "", None, [0.0, 0.3]),
    "Output.contact_moment": (pair(), "", "centre_of_mass", [0.0, 0.3]),
    **{
        f"{kind}.parts": (
            body(**{f"{SOLID}__geometry": {"type": kind.lower(), "parts": PARTS}}),
            f"{SOLID}__geometry__parts",
            PARTS,
            [PARTS[0], OTHER_PART],
        )
        for kind in ("Union", "Difference")
    },
    "Particles.layout": (ROUND_BODY, f"{SOLID}__particles__layout", "lattice", "fitted"),
    "Particles.size": (body(), f"{SOLID}__particles__size", 0.25, 0.125),
    "Particles.offset": (ROUND_BODY, f"{SOLID}__particles__offset", [0.0], [0.3]),
}
CORE: dict[str, Acts] = {
    "Tables.settle": Acts(held(), {}, {"settle": {"tolerance": 0.1, "max_time": 0.05}}),
    **{
        option: values(scene, key or option.lower().replace(".", "__"), first, second)
        for option, (scene, key, first, second) in ROWS.items()
    },
    **{f"{kind.capitalize()}.{key}": geometry(kind, key) for kind in SHAPES for key in SHAPES[kind]},
}


def mesh_file(folder: Path) -> Acts:
    """Two meshes of one quadrilateral each."""
    paths = []
    for width in (1.0, 0.8):
        points = [[-0.5, -0.5, 0.0], [width - 0.5, -0.5, 0.0], [width - 0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]]
        paths.append(folder / f"{width}.msh")
        write_msh(paths[-1], points, {"quad": [[0, 1, 2, 3]]})
    first, second = ({f"{SOLID}__geometry": {"type": "mesh", "path": str(path)}} for path in paths)
    return Acts(body(**{f"{SOLID}__particles__layout": "fitted"}), first, second)


def surface_mesh(folder: Path, key: str) -> Acts:
    """A tetrahedron in a file, in two files or with two values of another key."""
    paths = []
    for height in (0.6, 0.5):
        points = [[-0.5, -0.5, -0.5], [0.6, -0.5, -0.5], [-0.5, 0.6, -0.5], [-0.5, -0.5, height]]
        triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
        paths.append(write_msh(folder / f"{height}.msh", points, {"triangle": triangles}))
    shape = {"type": "surface_mesh", "path": str(paths[0])}
    other = {"path": str(paths[1]), "unit": "dm", "angles": [0, 0, 0.2], "shift": [0.1, 0.0, 0.0]}[key]
    return Acts(
        body({"type": "box", **SHAPES["box"]}),
        {f"{SOLID}__geometry": shape, f"{SOLID}__particles__size": 0.1},
        {f"{SOLID}__geometry": {**shape, key: other}, f"{SOLID}__particles__size": 0.1},
    )


PENALTY, BARDENHAGEN = "contact__penalty", "contact__bardenhagen"


#: Options that a material must have beside its moduli.
FLOW: dict[str, dict[str, float]] = {
    "j2": {"yield_stress": 1e2},
    "mohr_coulomb": {"friction_angle": 0.5, "cohesion": 1e2},
    "drucker_prager": {"friction_angle": 0.5, "cohesion": 1e2},
}
MODELS = ("neo_hookean", "linear_elastic", *FLOW)


def _made_of(model: str, **changes: Any) -> dict[str, Any]:
    """The square that is held, of this material."""
    flow = {f"materials__soft__{key}": value for key, value in FLOW.get(model, {}).items()}
    return held(materials__soft__model=model, **flow, **changes)


#: Two values of every option of a material; cohesion bounds the tension, which acts where the square hangs.
VALUES: dict[str, tuple[Any, Any]] = {
    "bulk_modulus": (6e6, 5e6), "shear_modulus": (3e6, 2e6), "youngs_modulus": (5e6, 4e6),
    "poissons_ratio": (0.3, 0.2), "yield_stress": (1e2, 1e3), "hardening_modulus": (0.0, 1e6),
    "hardening_exponent": (1.0, 0.3), "rate_factor": (0.0, 0.05), "reference_rate": (1.0, 1e-3),
    "friction_angle": (0.5, 0.3), "dilation_angle": (0.0, 0.2), "cohesion": (1e2, 2e2), "tension": (1e1, 5e1),
    "fit": ("plane_strain", "extension"), "energy": ("split", "log"), "pressure_exponent": (0.5, 0.3),
    "reference_pressure": (1e3, 2e3),
}  # fmt: skip
#: Options without which another has no effect.
BESIDE = {
    "hardening_exponent": {"hardening_modulus": 1e6}, "reference_rate": {"rate_factor": 0.05},
    "pressure_exponent": {"reference_pressure": 1e3}, "reference_pressure": {"pressure_exponent": 0.5},
}  # fmt: skip
YOUNG = {"youngs_modulus": 5e6, "poissons_ratio": 0.3}


def _material(model: str, option: str) -> Acts:
    scene = _made_of(model, **({"gravity": {"vector": [0.0, 100.0]}} if option == "tension" else {}))
    if needed := BESIDE.get(option):
        scene = _made_of(model, **{f"materials__soft__{key}": value for key, value in needed.items()})
    if option in YOUNG:
        soft = {"model": model, "density": 1000.0, **YOUNG, **FLOW.get(model, {})}
        scene = {**scene, "materials": {"soft": soft}}
    return values(scene, f"materials__soft__{option}", *VALUES[option])


#: Plug-ins whose every option the conformance kit tries.
ASKED_BY_THE_KIT = ("contact.", "friction.", "shape.")

PLUGINS: dict[str, Acts] = {
    "load.drag.rate": values(body(loads={"air": AIR}), "loads__air__rate", 30.0, 40.0),
    "load.drag.medium": values(body(loads={"air": AIR}), "loads__air__medium", [0.0, 0.0], [1.0, 0.0]),
    "load.body_force.force": values(
        body(loads={"field": {"model": "body_force"}}), "loads__field__force", [9e4, 0.0], [0.0, 9e4]
    ),
    "load.point_force.at": values(
        body(loads={"push": {"model": "point_force", "force": [1e4, 0]}}), "loads__push__at", [0, 0], [0, 0.2]
    ),
    "load.point_force.force": values(
        body(loads={"push": {"model": "point_force", "at": [0, 0]}}), "loads__push__force", [1e4, 0], [0, 1e4]
    ),
    **{
        f"material.{model}.{option}": _material(model, option)
        for model in MODELS
        for option in load("material", model).Options.model_fields
    },
}


class Each(NamedTuple):
    """A scene, the changes that choose each value, and what ``auto`` stands for there."""

    scene: dict[str, Any]
    changes: dict[str, Changes]
    auto: str | None = None


def chosen(scene: dict[str, Any], key: str, *words: str, auto: str | None = None) -> Each:
    """Words that need nothing beside them; ``auto`` is one more where it stands for something."""
    all_words = (*words, "auto") if auto is not None else words
    return Each(scene, {word: {key: word} for word in all_words}, auto)


#: A block as wide and high as deep, that hangs by one of its six sides.
CUBE = body(
    {"type": "box", "lower": [-0.5] * 3, "upper": [0.5] * 3},
    gravity={"vector": [-20.0, -100.0, -50.0]},
    **{f"{SOLID}__angular_velocity": [0.0, 0.0, 0.0]},
)
#: A ring with a load in its hole.
HOLLOW = body({"type": "ring", **SHAPES["ring"]}, **{SIDES: [{"side": "inner", "pressure": 1e4}]})
#: Spins of the block below [rad/s].
SPINS = {"x": 3.0, "y": 2.0, "z": 1.0}
#: A rigid block beside it, which falls and tumbles.
FALLS = with_changes(
    CUBE,
    contact={"method": "penalty"},
    bodies__tool={
        "geometry": {"type": "box", "lower": [1.5, -0.5, -0.5], "upper": [2.5, 0.5, 0.0]},
        "rigid": {"density": 1e3},
        "angular_velocity": [*SPINS.values()],
        "segment": 1.0,
    },
)
PRESSED = body(
    {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.3]},
    **{SIDES: [{"side": "top", "pressure": 1e4}]},
)
EACH: dict[str, Each] = {
    "Stepping.scheme": chosen(held(), "stepping__scheme", "usl", "musl", "usf", auto="usl"),
    "Stepping.transfer": chosen(
        body(), "stepping__transfer", "flip", "pic", "apic", "tpic", "aflip", auto="aflip"
    ),
    "material.drucker_prager.fit": chosen(
        _made_of("drucker_prager"), "materials__soft__fit", "plane_strain", "compression", "extension"
    ),
    "Body.rotation": chosen(PRESSED, f"{SOLID}__rotation", "spin", "exact", "lumped"),
    "Body.volumetric": chosen(held(), f"{SOLID}__volumetric", "averaged", "pointwise", auto="pointwise"),
    "Side.side": Each(
        CUBE,
        {
            side: {SIDES: [{"side": side, "fixed": True}]}
            for side in ("left", "right", "bottom", "top", "back", "front")
        }
        | {"outer": {SIDES: [{"side": "outer", "pressure": 1e4}]}, "inner": HOLLOW},
    ),
    **{
        f"{kind.capitalize()}.axis": Each(
            body({"type": kind, **SHAPES[kind]}),
            {axis: {f"{SOLID}__geometry": {"type": kind, **SHAPES[kind], "axis": axis}} for axis in "xyz"},
        )
        for kind in ("cylinder", "torus", "revolution")
    },
    "Rigid.held": Each(
        FALLS,
        {word: {"bodies__tool__rigid__held": [word]} for word in ("x", "y", "z", "rotation")}
        | {
            f"rotation-{axis}": {
                "bodies__tool__rigid__held": [f"rotation-{axis}"],
                "bodies__tool__angular_velocity": [w * (axis != a) for a, w in SPINS.items()],
            }
            for axis in "xyz"
        },
    ),
    "Side.fixed": Each(CUBE, {axis: {SIDES: [{"side": "left", "fixed": [axis]}]} for axis in "xyz"}),
}

#: Options where they can have no effect, and a word of the refusal.
REFUSED: dict[str, tuple[dict[str, Any], Changes, str]] = {
    "tangential_ratio, μ = 0": (pair(contact__friction=0), {PENALTY: {"tangential_ratio": 0.5}}, "friction"),
    "a friction law, μ = 0": (pair(contact__friction=0), {"contact__friction_law": "coulomb"}, "friction"),
    "a friction law, literal friction": (
        pair("hamad2017", contact__hamad2017={"friction_law": "literal"}),
        {"contact__friction_law": "coulomb"},
        "literal",
    ),
    "friction_law, μ = 0": (
        pair("hamad2017", contact__friction=0),
        {"contact__hamad2017": {"friction_law": "literal"}},
        "friction",
    ),
    "master, two passes": (pair(), {PENALTY: {"master": "left"}}, "no effect"),
    "master that is no body": (pair(), {PENALTY: {"passes": "one", "master": "nobody"}}, "nobody"),
    "cut_off, velocity": (pair("bardenhagen"), {BARDENHAGEN: {"cut_off": 0.5}}, "no effect"),
    "direction, averaged": (pair("bardenhagen"), {BARDENHAGEN: {"direction": [1.0, 0.0]}}, "direction"),
    "contact of one body": (body(), {"contact": {"method": "penalty", "penalty": {"kappa": 2}}}, "no effect"),
    "offset, fitted": (
        body(),
        {f"{SOLID}__particles": {"layout": "fitted", "size": 0.25, "offset": [0.3]}},
        "offset",
    ),
    "settling under nothing": (block(), {"settle": {}}, "no effect"),
    "exact rotation, held": (held(), {f"{SOLID}__rotation": "exact"}, "exact"),
}
