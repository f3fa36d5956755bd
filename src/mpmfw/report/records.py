"""Records: one JSON file for each result of a comparison, which others can collect and rank."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import xarray as xr
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from mpmfw.errors import SceneError
from mpmfw.report.table import CHOICES, method_dims, table
from mpmfw.results.references import own_attributes, scene_of_results
from mpmfw.results.replacing import replace_bytes
from mpmfw.results.selection import points_of

#: Bytes of a file above which it is no record.
LARGEST = 100_000

#: Keys of a scene and of its bodies that choose how it is computed, and not what.
_METHODS = {"title", "reference", "threads", "grid", "shape", "stepping", "output", "outputs", "sleep"}
_OF_BODIES = ("particles", "segment", "rotation", "volumetric")


class Record(BaseModel):
    """One result: what was computed, by which method and code, where, and what came of it."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    version: Literal[1] = Field(default=1, description="of this schema")
    scene: str = Field(description="title of the scene")
    problem: str = Field(pattern="^[0-9a-f]{16}$", description="hash of what is computed, methods left out")
    method: str = Field(description="contact, or another code with its settings")
    shape: str
    code: str = Field(description="version, float width and processor of another code; or mpmfw's version")
    settings: dict[str, str | float] = Field(description="values of varied keys, and the cell size")
    machine: str = Field(description="model of the processor")
    status: str
    figures: dict[str, float] = Field(description="by the names of the columns of mpmfw compare")


def records_of(dataset: xr.Dataset) -> list[Record]:
    """Return a record of each row of a comparison that has figures."""
    found, attributes = [], dataset.attrs
    version = json.loads(attributes.get("versions", "{}")).get("mpmfw", "?")
    points = [one for _, one in points_of(dataset, method_dims(dataset))]
    for row, one in zip(table(dataset), points, strict=True):
        labels = {str(dim): row.pop(str(dim)) for dim in method_dims(dataset)}
        figures = {name: float(value) for name, value in row.items() if isinstance(value, int | float)}
        figures = {name: value for name, value in figures.items() if math.isfinite(value)}
        scene = scene_of_results(own_attributes(one))
        if not figures or scene is None:
            continue
        settings = {dim: label for dim, label in labels.items() if dim not in ("contact", "shape")}
        settings |= {name: str(row[name]) for name in CHOICES if row.get(name) and name != "code"}
        record = Record(
            scene=str(attributes.get("title", "")),
            problem=_problem(scene),
            method=str(labels["contact"]),
            shape=str(labels["shape"]),
            code=str(row.get("code") or f"mpmfw {version}, float64, CPU"),
            settings={"cell_size": float(scene.grid.cell_size), **settings},
            machine=str(attributes.get("processor", "")),
            status=str(row["status"]),
            figures=figures,
        )
        found.append(record)
    return found


def write_records(dataset: xr.Dataset, folder: Path) -> list[Path]:
    """Write the records of a comparison to a folder, over those of the same runs; return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for record in records_of(dataset):
        run = record.model_dump_json(exclude={"status", "figures"})
        paths.append(folder / f"{record.problem}-{hashlib.sha256(run.encode()).hexdigest()[:16]}.json")
        replace_bytes(record.model_dump_json(indent=1).encode(), paths[-1])
    return paths


def read_records(folder: Path) -> list[Record]:
    """Return the records of a folder; a SceneError has a line for each file that is none."""
    paths = sorted(folder.glob("*.json")) if folder.is_dir() else []
    if not paths:
        raise SceneError(f"{folder}: holds no records; expected files of mpmfw compare --records")
    found, wrong = [], []
    for path in paths:
        try:
            if path.is_symlink() or path.stat().st_size > LARGEST:
                raise ValueError(f"is a link, or above {LARGEST} bytes")
            found.append(Record.model_validate_json(path.read_bytes()))
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            wrong.append(f"{path}: {'.'.join(map(str, first['loc']))}: {first['msg']}")
        except (OSError, ValueError) as error:
            wrong.append(f"{path}: {error}")
    if wrong:
        raise SceneError("\n".join(wrong))
    return found


def ranked(records: Sequence[Record]) -> dict[str, list[dict[str, Any]]]:
    """Return rows by scene, the one whose largest error is least first, then the cheapest."""
    scenes: dict[str, list[dict[str, Any]]] = {}
    for record in records:
        row: dict[str, Any] = {"method": record.method, "shape": record.shape, "code": record.code}
        row |= {**record.settings, "status": record.status, **record.figures, "machine": record.machine}
        scenes.setdefault(f"{record.scene} ({record.problem})", []).append(row)

    def order(row: dict[str, Any]) -> tuple[float, float]:
        errors = [abs(value) for name, value in row.items() if name.endswith("_error")]
        return max(errors, default=math.inf), row.get("cpu_time", math.inf)

    return {scene: sorted(rows, key=order) for scene, rows in sorted(scenes.items())}


def _problem(scene: Any) -> str:
    """Return a hash of the tables that say what is computed."""
    tables = scene.model_dump(exclude=_METHODS)
    for body in tables["bodies"].values():
        for key in _OF_BODIES:
            body.pop(key, None)
    tables["time"] = {"end": tables["time"]["end"]}
    tables["contact"] = None if scene.contact is None else [scene.pairs, scene.contact.friction_law]
    text = json.dumps(tables, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
