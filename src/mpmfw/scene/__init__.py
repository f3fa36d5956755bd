"""Scenes: what to simulate, from a TOML file or a mapping."""

from mpmfw.scene.bodies import Body
from mpmfw.scene.loading import load_scene, located, shipped_scenes
from mpmfw.scene.scene import Scene
from mpmfw.scene.schema import json_schema
from mpmfw.scene.sources import Source

__all__ = ["Body", "Scene", "Source", "json_schema", "load_scene", "located", "shipped_scenes"]
