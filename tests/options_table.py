"""For every option of a scene, and of plug-ins where the conformance kit does not ask, a tiny scene in which
its two values, or all its words, differ.

A key is ``Table.field`` for the scene's own tables and ``kind.plug-in.option`` for plug-ins.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from msh_files import write_msh
from scenes_for_tests import SOFT, block, one_body, two_blocks, with_changes

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


def geometry(kind: str, key: str, first: Any, second: Any) -> Acts:
    """Two values of one key of a geometry, the others as in :data:`SHAPES`."""
    shape = {"type": kind, **SHAPES[kind]}
    return Acts(body({**shape, key: first}), {}, {f"{SOLID}__geometry": {**shape, key: second}})


PLATE = {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]}
SECTION = {"type": "rectangle", "lower": [0.2, -0.4], "upper": [0.5, 0.4]}
SHAPES: dict[str, dict[str, Any]] = {
    "disc": {"centre": [0.03, 0.07], "radius": 0.5},
    "ring": {"centre": [0.03, 0.07], "inner_radius": 0.3, "outer_radius": 0.7},
    "rectangle": {"lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
    "polygon": {"points": [[-0.5, -0.5], [0.5, -0.5], [0.0, 0.5]]},
    "box": {"lower": [-0.5, -0.5, -0.5], "upper": [0.5, 0.5, 0.5]},
    "ball": {"centre": [0.03, 0.07, 0.05], "radius": 0.5},
    "cylinder": {"centre": [0.03, 0.07, 0.05], "radius": 0.5, "length": 0.6},
    "torus": {"centre": [0.03, 0.07, 0.05], "radius": 0.5, "tube_radius": 0.2},
    "extrusion": {"outline": PLATE, "low": -0.3, "high": 0.3},
    "revolution": {"outline": SECTION},
}
HOLE = [[-0.1, -0.2], [0.1, -0.2], [0.0, 0.0]]
SIDES = f"{SOLID}__sides"
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
THIRD = {
    "material": "soft",
    "particles": {"size": 0.25},
    "geometry": {"type": "rectangle", "lower": [0.505, -0.2], "upper": [0.9, 0.3]},
    "velocity": [-8.0, -3.0],
}
#: Plug-ins that the tests of the options announce.
TABLE, FAST = {"model": "shaken"}, {"model": "fastest"}
AIR = {"model": "drag", "rate": 30.0}
OVERLAPPING = pair(bodies__right__geometry={"type": "rectangle", "lower": [-0.1, -0.2], "upper": [0.4, 0.3]})

CORE: dict[str, Acts] = {
    "Tables.title": values(body(), "title", "one", "another"),
    "Tables.allow_overlap": values(OVERLAPPING, "allow_overlap", False, True),
    "Tables.allow_unstable": values(body(time__safety=0.9), "allow_unstable", False, True),
    "Tables.grid": values(body(), "grid__cell_size", 0.25, 0.3),
    "Tables.time": values(body(), "time__end", 6e-3, 4e-3),
    "Tables.stepping": values(body(), "stepping", {}, {"transfer": "pic"}),
    "Tables.shape": values(body(), "shape", {"method": "cpdi"}, {"method": "gimp"}),
    "Tables.contact": values(pair(), "contact", {"method": "penalty"}, {"method": "none"}),
    "Tables.materials": values(body(), "materials", {"soft": SOFT}, {"soft": {**SOFT, "shear_modulus": 1e6}}),
    "Tables.bodies": values(body(), f"{SOLID}__velocity", [1.0, 0.0], [0.0, 1.0]),
    "Tables.gravity": values(held(), "gravity", G, {"vector": [0, -50]}),
    "Tables.settle": Acts(held(), {}, {"settle": {"tolerance": 0.1, "max_time": 0.05}}),
    "Tables.sleep": Acts(RESTING, {}, {"sleep": {"strain": 1e-2, "crossings": 1.0}}),
    "Sleep.strain": values({**RESTING, "sleep": {"crossings": 1.0}}, "sleep__strain", 1e-9, 1e-2),
    "Sleep.crossings": values({**RESTING, "sleep": {"strain": 1e-2}}, "sleep__crossings", 1.0, 1e3),
    "Tables.output": values(body(), "output", {}, {"energy": False}),
    "Tables.reference": values(body(), "reference", {"kind": "sliding-block"}, {"kind": "none of them"}),
    "Reference.kind": values(body(), "reference", {"kind": "sliding-block"}, {"kind": "none of them"}),
    "Grid.cell_size": values(body(), "grid__cell_size", 0.25, 0.3),
    "Grid.lower": values(body(), "grid__lower", [-2.0, -2.0], [-2.1, -2.1]),
    "Grid.upper": values(body(), "grid__upper", [2.0, 2.0], [0.4, 0.4]),
    "Time.end": values(body(), "time__end", 6e-3, 4e-3),
    "Time.outputs": values(body(time__output_interval=2.2e-3), "time__outputs", "exact", "nearest"),
    "Time.output_interval": values(body(), "time__output_interval", 3e-3, 2e-3),
    "Time.safety": values(body(), "time__safety", 0.5, 0.3),
    "Time.step": values(body(), "time__step", 1e-3, 5e-4),
    "Stepping.scheme": values(body(), "stepping__scheme", "usl", "musl"),
    "Stepping.transfer": values(body(), "stepping__transfer", "flip", "apic"),
    "Stepping.transported": values(body(), "stepping__transported", True, False),
    "Stepping.pic_fraction": values(body(stepping__transfer="flip"), "stepping__pic_fraction", 0.0, 0.3),
    "Shape.method": values(body(), "shape__method", "cpdi", "bspline"),
    "Contact.method": values(pair(), "contact__method", "penalty", "bardenhagen"),
    "Contact.friction": values(pair(), "contact__friction", 0.1, 0.4),
    "Contact.friction_law": values(
        pair(contact__mohr_coulomb={"cohesion": 1e4}), "contact__friction_law", "coulomb", "mohr_coulomb"
    ),
    "Contact.pairs": values(pair(), "contact__pairs", [STICKY], [SMOOTH]),
    "PairFriction.bodies": values(
        pair(bodies__third=THIRD), "contact__pairs", [STICKY], [{**STICKY, "bodies": ["right", "third"]}]
    ),
    "PairFriction.friction": values(pair(), "contact__pairs", [STICKY], [{**STICKY, "friction": 0.1}]),
    "Material.model": values(held(), "materials__soft__model", "neo_hookean", "linear_elastic"),
    "Material.density": values(body(), "materials__soft__density", 1000.0, 1200.0),
    "Body.material": values(
        held(materials__other={**SOFT, "shear_modulus": 1e6}), f"{SOLID}__material", "soft", "other"
    ),
    "Body.geometry": values(body(), f"{SOLID}__geometry__upper", [0.5, 0.5], [0.4, 0.5]),
    "Body.particles": values(body(), f"{SOLID}__particles__size", 0.25, 0.125),
    "Body.segment": values(pair(), "bodies__left__segment", 0.0625, 0.125),
    "Body.velocity": values(body(), f"{SOLID}__velocity", [1.0, 0.0], [0.0, 1.0]),
    "Body.angular_velocity": values(body(), f"{SOLID}__angular_velocity", 3.0, 2.0),
    "Body.rotation": values(
        body(gravity={"vector": [0, -1]}, **{SIDES: [{"side": "top", "pressure": 1e4}]}),
        *(f"{SOLID}__rotation", "exact", "lumped"),
    ),
    "Body.sides": values(held(), SIDES, HELD, [{"side": "left", "fixed": True}]),
    "Side.side": values(held(), SIDES, HELD, [{"side": "right", "fixed": True}]),
    "Side.fixed": values(held(), SIDES, HELD, [{"side": "bottom", "fixed": ["x"]}]),
    "Side.velocity": values(
        held(), SIDES, [{"side": "top", "velocity": [0, 1]}], [{"side": "top", "velocity": ["free", 1]}]
    ),
    "Side.pressure": values(
        held(), SIDES, [{"side": "top", "pressure": 1e3}], [{"side": "top", "pressure": 2e3}]
    ),
    "Side.traction": values(
        held(), SIDES, [{"side": "top", "traction": [1e3, 0]}], [{"side": "top", "traction": [2e3, 0]}]
    ),
    "Side.force": values(
        held(), SIDES, [{"side": "top", "force": [1e3, 0]}], [{"side": "top", "force": [2e3, 0]}]
    ),
    "Body.thickness": values(body(), f"{SOLID}__thickness", 1.0, 0.1),
    "Tables.loads": Acts(held(), {}, {"loads": {"air": AIR}}),
    "Load.model": Acts(
        held(), {"loads": {"air": AIR}}, {"loads": {"air": {"model": "body_force", "force": [9.0, 0.0]}}}
    ),
    "Load.bodies": values(pair(loads={"air": AIR}), "loads__air__bodies", ["left"], ["left", "right"]),
    "Tables.boundaries": Acts(body(), {}, {"boundaries": {"table": TABLE}}),
    "Boundary.model": values(
        body(boundaries={"table": TABLE}), "boundaries__table__model", "shaken", "none of them"
    ),
    "Boundary.bodies": values(
        pair(boundaries={"table": TABLE}), "boundaries__table__bodies", ["left"], ["left", "right"]
    ),
    "Tables.outputs": Acts(body(), {}, {"outputs": {"fast": FAST}}),
    "Series.model": values(body(outputs={"fast": FAST}), "outputs__fast__model", "fastest", "none of them"),
    "Series.bodies": values(
        pair(outputs={"fast": FAST}), "outputs__fast__bodies", ["left"], ["left", "right"]
    ),
    "Gravity.vector": values(held(), "gravity", G, {"vector": [1, -100]}),
    "Gravity.magnitude": values(
        held(), "gravity", {"magnitude": 9.0, "tilt": 0.1}, {"magnitude": 8.0, "tilt": 0.1}
    ),
    "Gravity.tilt": values(
        held(), "gravity", {"magnitude": 9.0, "tilt": 0.1}, {"magnitude": 9.0, "tilt": 0.2}
    ),
    "Gravity.table": values(
        held(), "gravity", {"table": [[0, 0, -9], [1, 0, -9]]}, {"table": [[0, 0, -9], [0.01, 0, 9]]}
    ),
    "ConstantGravity.vector": values(SETTLED, "settle__gravity", {"vector": [0, -50]}, {"vector": [0, -20]}),
    "ConstantGravity.magnitude": values(
        SETTLED, "settle__gravity", {"magnitude": 9, "tilt": 0.1}, {"magnitude": 8, "tilt": 0.1}
    ),
    "ConstantGravity.tilt": values(
        SETTLED, "settle__gravity", {"magnitude": 9, "tilt": 0.1}, {"magnitude": 9, "tilt": 0.2}
    ),
    "Settle.tolerance": values(held(settle={"max_time": 0.5}), "settle__tolerance", 0.2, 0.05),
    "Settle.max_time": values(held(settle={"tolerance": 1e-6}), "settle__max_time", 0.01, 0.03),
    "Settle.gravity": Acts(SETTLED, {}, {"settle__gravity": {"vector": [0, -50]}}),
    "Output.gap": values(pair("separate"), "output__gap", True, False),
    "Output.particle_interval": values(
        body(time__output_interval=1e-3), "output__particle_interval", None, 2e-3
    ),
    "Output.particles": values(body(), "output__particles", True, False),
    "Output.surface": values(pair(), "output__surface", True, False),
    "Output.energy": values(body(), "output__energy", True, False),
    "Output.ledger": values(body(), "output__ledger", True, False),
    "Output.stability": values(body(), "output__stability", True, False),
    "Output.contact_moment": values(pair(), "output__contact_moment", "centre_of_mass", [0.0, 0.3]),
    "Particles.layout": values(
        body({"type": "disc", **SHAPES["disc"]}), f"{SOLID}__particles__layout", "lattice", "fitted"
    ),
    "Particles.size": values(body(), f"{SOLID}__particles__size", 0.25, 0.125),
    "Particles.offset": values(
        body({"type": "disc", **SHAPES["disc"]}), f"{SOLID}__particles__offset", [0.0], [0.3]
    ),
    "Disc.centre": geometry("disc", "centre", [0.03, 0.07], [0.05, 0.07]),
    "Disc.radius": geometry("disc", "radius", 0.5, 0.6),
    "Ring.centre": geometry("ring", "centre", [0.03, 0.07], [0.05, 0.07]),
    "Ring.inner_radius": geometry("ring", "inner_radius", 0.3, 0.4),
    "Ring.outer_radius": geometry("ring", "outer_radius", 0.7, 0.8),
    "Rectangle.lower": geometry("rectangle", "lower", [-0.5, -0.5], [-0.4, -0.5]),
    "Rectangle.upper": geometry("rectangle", "upper", [0.5, 0.5], [0.4, 0.5]),
    "Rectangle.angle": geometry("rectangle", "angle", 0.0, 0.3),
    "Polygon.points": geometry(
        "polygon", "points", SHAPES["polygon"]["points"], [[-0.5, -0.5], [0.5, -0.5], [0, 0.6]]
    ),
    "Polygon.holes": geometry("polygon", "holes", [], [HOLE]),
    "Box.lower": geometry("box", "lower", [-0.5] * 3, [-0.4, -0.5, -0.5]),
    "Box.upper": geometry("box", "upper", [0.5] * 3, [0.4, 0.5, 0.5]),
    "Ball.centre": geometry("ball", "centre", [0.03, 0.07, 0.05], [0.05, 0.07, 0.05]),
    "Box.angles": geometry("box", "angles", [0, 0, 0], [0.3, 0.2, 0.1]),
    "Ball.radius": geometry("ball", "radius", 0.5, 0.6),
    "Cylinder.centre": geometry("cylinder", "centre", [0.03, 0.07, 0.05], [0.05, 0.07, 0.05]),
    "Cylinder.radius": geometry("cylinder", "radius", 0.5, 0.6),
    "Cylinder.length": geometry("cylinder", "length", 0.6, 0.8),
    "Cylinder.axis": geometry("cylinder", "axis", "z", "x"),
    "Cylinder.angles": geometry("cylinder", "angles", [0, 0, 0], [0.3, 0.2, 0.1]),
    "Torus.centre": geometry("torus", "centre", [0.03, 0.07, 0.05], [0.05, 0.07, 0.05]),
    "Torus.radius": geometry("torus", "radius", 0.5, 0.6),
    "Torus.tube_radius": geometry("torus", "tube_radius", 0.2, 0.3),
    "Torus.axis": geometry("torus", "axis", "z", "x"),
    "Torus.angles": geometry("torus", "angles", [0, 0, 0], [0.3, 0.2, 0.1]),
    "Extrusion.outline": geometry("extrusion", "outline", PLATE, {**PLATE, "upper": [0.5, 0.4]}),
    "Extrusion.low": geometry("extrusion", "low", -0.3, -0.2),
    "Extrusion.high": geometry("extrusion", "high", 0.3, 0.4),
    "Extrusion.angles": geometry("extrusion", "angles", [0, 0, 0], [0.3, 0.2, 0.1]),
    "Revolution.outline": geometry("revolution", "outline", SECTION, {**SECTION, "upper": [0.5, 0.3]}),
    "Revolution.origin": geometry("revolution", "origin", [0, 0, 0], [0.1, 0, 0]),
    "Revolution.axis": geometry("revolution", "axis", "z", "x"),
    "Revolution.angles": geometry("revolution", "angles", [0, 0, 0], [0.3, 0.2, 0.1]),
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


def _friction(law: str, option: str, first: Any, second: Any, /, **beside: Any) -> Acts:
    scene = pair(contact__friction_law=law)
    return values(scene, f"contact__{law}", {**beside, option: first}, {**beside, option: second})


def _material(model: str, option: str, first: Any, second: Any) -> Acts:
    flow = {"materials__soft__yield_stress": 1e2} if model == "j2" else {}
    return values(held(materials__soft__model=model, **flow), f"materials__soft__{option}", first, second)


def _by_young(model: str, option: str, second: float) -> Acts:
    flow = {"yield_stress": 1e2} if model == "j2" else {}
    soft = {"model": model, "density": 1000.0, "youngs_modulus": 5e6, "poissons_ratio": 0.3, **flow}
    return values(held(), "materials__soft", soft, {**soft, option: second})


#: Plug-ins whose every option the conformance kit tries.
ASKED_BY_THE_KIT = ("contact.", "shape.")

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
    "friction.stribeck.static_ratio": _friction("stribeck", "static_ratio", 1.2, 2.0, velocity=1.0),
    "friction.stribeck.velocity": _friction("stribeck", "velocity", 1.0, 3.0),
    "friction.mohr_coulomb.cohesion": _friction("mohr_coulomb", "cohesion", 1e3, 1e4),
    **{
        f"material.{model}.{option}": _material(model, option, first, second)
        for model in ("neo_hookean", "linear_elastic", "j2")
        for option, first, second in (("bulk_modulus", 6e6, 5e6), ("shear_modulus", 3e6, 2e6))
    },
    **{
        f"material.{model}.{option}": _by_young(model, option, second)
        for model in ("neo_hookean", "linear_elastic", "j2")
        for option, second in (("youngs_modulus", 4e6), ("poissons_ratio", 0.2))
    },
    "material.j2.yield_stress": _material("j2", "yield_stress", 1e2, 1e3),
    "material.j2.hardening_modulus": _material("j2", "hardening_modulus", 0.0, 1e6),
    "material.neo_hookean.energy": _material("neo_hookean", "energy", "split", "log"),
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
PRESSED = body(
    {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.3]},
    **{SIDES: [{"side": "top", "pressure": 1e4}]},
)
EACH: dict[str, Each] = {
    "Stepping.scheme": chosen(held(), "stepping__scheme", "usl", "musl", "usf", auto="usl"),
    "Stepping.transfer": chosen(
        body(), "stepping__transfer", "flip", "pic", "apic", "tpic", "aflip", auto="aflip"
    ),
    "Body.rotation": chosen(PRESSED, f"{SOLID}__rotation", "spin", "exact", "lumped"),
    "Side.side": Each(
        CUBE,
        {
            side: {SIDES: [{"side": side, "fixed": True}]}
            for side in ("left", "right", "bottom", "top", "back", "front")
        },
    ),
    **{
        f"{kind.capitalize()}.axis": Each(
            body({"type": kind, **SHAPES[kind]}),
            {axis: {f"{SOLID}__geometry": {"type": kind, **SHAPES[kind], "axis": axis}} for axis in "xyz"},
        )
        for kind in ("cylinder", "torus", "revolution")
    },
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
