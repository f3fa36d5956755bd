"""Scenes: what to simulate, from a TOML file or a mapping."""

from mpmfw.scene.gravity import ConstantGravity, Gravity
from mpmfw.scene.loading import load_scene, located, shipped_scenes
from mpmfw.scene.scene import Scene
from mpmfw.scene.schema import json_schema
from mpmfw.scene.sources import Source
from mpmfw.scene.tables import (
    Body,
    Contact,
    Grid,
    Material,
    Output,
    PairFriction,
    Reference,
    Settle,
    Shape,
    Side,
    Stepping,
    Time,
)

__all__ = [
    "Body",
    "ConstantGravity",
    "Contact",
    "Gravity",
    "Grid",
    "Material",
    "Output",
    "PairFriction",
    "Reference",
    "Scene",
    "Settle",
    "Shape",
    "Side",
    "Source",
    "Stepping",
    "Time",
    "json_schema",
    "load_scene",
    "located",
    "shipped_scenes",
]
