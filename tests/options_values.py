"""For every option that is one of several words: each word, and a tiny scene in which all of them differ.

Options of two words are in ``options_table`` with both.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from options_table import BARDENHAGEN, PENALTY, SHAPES, SIDES, SOLID, Changes, body, held, pair
from scenes_for_tests import SOFT


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
#: The right block is stiffer, and the faces that meet are not parallel.
UNEQUAL = pair(
    "bardenhagen",
    materials__stiff={**SOFT, "bulk_modulus": 6e7},
    bodies__right__material="stiff",
    bodies__right__geometry={"type": "rectangle", "lower": [-0.004, -0.2], "upper": [0.496, 0.3],
    "angle": 0.05},
    allow_overlap=True,
)  # fmt: skip

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
    "contact.bardenhagen.criterion": Each(
        UNEQUAL,
        {word: {BARDENHAGEN: {"criterion": word}} for word in ("velocity", "position", "auto")},
        "velocity",
    ),
    "contact.penalty.map": Each(
        pair(), {word: {PENALTY: {"map": word}} for word in ("plain", "mass_weighted", "auto")}, "plain"
    ),
    "contact.hamad2017.map": Each(
        pair("hamad2017"),
        {word: {"contact__hamad2017": {"map": word}} for word in ("plain", "mass_weighted", "auto")},
        "plain",
    ),
    **{
        f"contact.{contact}.map": Each(
            pair(contact),
            {word: {f"contact__{contact}": {"map": word}} for word in ("plain", "mass_weighted", "auto")},
            "plain",
        )
        for contact in ("lcp", "hybrid", "impulse", "barrier", "adhesion")
    },
    "contact.bardenhagen.normal": Each(
        UNEQUAL,
        {
            "averaged": {BARDENHAGEN: {"normal": "averaged"}},
            "master": {BARDENHAGEN: {"normal": "master"}},
            "specified": {BARDENHAGEN: {"normal": "specified", "direction": [1.0, 0.0]}},
        },
    ),
}
