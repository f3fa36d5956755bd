"""Records: one JSON file for each result of a comparison, which others can collect and rank."""

from __future__ import annotations

import hashlib
import json
import math
import stat
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import xarray as xr
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, field_validator

from mpmfw.campaigns.keys import is_numerical, is_own_method
from mpmfw.campaigns.measures import names_of_measures
from mpmfw.errors import SceneError, status_code
from mpmfw.plots.records import Dot
from mpmfw.report.table import CHOICES, COLUMNS, COSTS, column_of, method_dims, table
from mpmfw.results.replacing import replace_bytes
from mpmfw.results.selection import points_of
from mpmfw.results.stored_scene import own_attributes, scene_of, scene_of_results
from mpmfw.runs.identity import meaning_of
from mpmfw.scene import Scene
from mpmfw.scene.sources import code_in

#: Bytes of the largest record, and characters of its longest text.
LARGEST, LONGEST = 100_000, 500

#: Tables of a scene that do not change the problem.
_METHODS = ("allow_overlap", "allow_unstable", "grid", "shape", "stepping", "output", "outputs", "sleep")

#: One line without control characters.
Text = Annotated[str, Field(max_length=LONGEST, pattern=r"^[^\p{C}\p{Zl}\p{Zp}]*$")]
Hash = Annotated[str, Field(pattern="^[0-9a-f]{16}$")]


def _not_blank(name: str) -> str:
    if not name.strip():
        raise ValueError(f"expected a name, not {name!r}")
    return name


Name = Annotated[Text, AfterValidator(_not_blank)]


class Record(BaseModel):
    """One result: what was computed, by which method and code, where, and with which figures."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    version: Literal[1] = Field(default=1, description="of this schema")
    scene: Text = Field(description="title of the scene")
    problem: Hash = Field(description="hash of what is computed, methods left out")
    tables: Hash = Field(description="hash of the scene's tables, methods included")
    method: Name = Field(description="contact, or another code with its settings")
    shape: Text
    code: Name = Field(description="version, float width and processor of another code; or mpmfw's version")
    settings: dict[Text, Text | float] = Field(description="keys that were set or varied, and the cell size")
    machine: Text = Field(description="model of the processor")
    status: Text
    figures: dict[Text, float] = Field(description="by the names of the columns of mpmfw compare")

    @field_validator("settings", "figures")
    @classmethod
    def _has_its_own_columns(cls, given: dict[str, Any], info: Any) -> dict[str, Any]:
        """Refuse settings with the name of another column, and figures of unknown columns."""
        figures = {*COLUMNS, *(f"{name.replace('-', '_')}_error" for name in names_of_measures())}
        taken = given.keys() & {*cls.model_fields, *figures, "style"}
        wrong = taken if info.field_name == "settings" else given.keys() - figures
        if wrong:
            raise ValueError(f"'{min(wrong)}' does not name one of the {info.field_name}")
        return given

    @field_validator("settings", mode="before")
    @classmethod
    def _has_a_cell_size(cls, settings: Any) -> Any:
        size = settings.get("grid.cell_size") if isinstance(settings, dict) else None
        if not isinstance(size, int | float) or isinstance(size, bool) or not 0.0 < size < math.inf:
            raise ValueError(f"grid.cell_size: expected a positive number [m], not {size!r}")
        return settings

    @field_validator("figures")
    @classmethod
    def _costs_something(cls, figures: dict[str, float]) -> dict[str, float]:
        for name in COSTS:
            if figures.get(name, 0.0) < 0.0:
                raise ValueError(f"{name}: expected 0 or more, not {figures[name]:g}")
        return figures

    @property
    def cell_size(self) -> float:
        """Size of a cell [m]."""
        return float(self.settings["grid.cell_size"])


def records_of(dataset: xr.Dataset) -> list[Record]:
    """Return a record of each row of a comparison that has figures, failed, or was refused by a code.

    A code ignores shape functions; of rows that differ in these alone, the first counts."""
    found: dict[str, Record] = {}
    attributes = dataset.attrs
    codes = json.loads(attributes.get("codes", "{}"))
    version = json.loads(attributes.get("versions", "{}")).get("mpmfw", "?")
    varied, shared = (json.loads(attributes.get(name, "{}")) for name in ("varied", "set"))
    points = [one for _, one in points_of(dataset, method_dims(dataset))]
    for row, one in zip(table(dataset), points, strict=True):
        labels = {str(dim): row.pop(str(dim)) for dim in method_dims(dataset)}
        figures = {name: float(value) for name, value in row.items() if isinstance(value, int | float)}
        figures = {name: value for name, value in figures.items() if math.isfinite(value)}
        scene, written = scene_of_results(own_attributes(one)), scene_of(own_attributes(one))
        title = codes.get(labels["contact"])
        if scene is None or not (figures or title or status_code(row["status"]) == "failed"):
            continue
        for kind in ("contact", "shape"):  # the first run's
            written.get(kind, {}).pop("method", None)
        settings = {key: value for key, value in shared.items() if is_numerical(key)}
        settings |= {varied[dim]: label for dim, label in labels.items() if dim in varied}
        settings = {key: value for key, value in settings.items() if not (title and is_own_method(key))}
        settings |= {"grid.cell_size": scene.grid.cell_size}
        settings |= {name: row[name] for name in CHOICES if row.get(name) and name != "code"}
        record = Record(
            scene=_cleaned(attributes.get("title", "")),
            problem=_problem(scene, written["materials"]),
            tables=_hash(written),
            method=_cleaned(labels["contact"]),
            shape="its own" if title else _cleaned(labels["shape"]),
            code=_cleaned(row.get("code") or title or f"mpmfw {version}, float64, CPU"),
            settings={key: _cleaned(value) for key, value in settings.items()},
            machine=_cleaned(attributes.get("processor", "")),
            status=_cleaned(row["status"].replace("\n", "; ")),
            figures=figures,
        )
        same = record.model_dump(exclude={"status", "figures", "code"})
        found.setdefault(_hash(same), record)
    return list(found.values())


def write_records(dataset: xr.Dataset, folder: Path) -> list[Path]:
    """Write the records of a comparison to a folder, over those of the same runs; return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for record in records_of(dataset):
        run = _hash(record.model_dump(exclude={"status", "figures"}))
        paths.append(folder / f"{record.problem}-{run}.json")
        replace_bytes(record.model_dump_json(indent=1).encode(), paths[-1])
    return paths


def read_records(folder: Path) -> list[Record]:
    """Return the records of a folder; a SceneError has a line for each file that does not hold one."""
    paths = sorted(folder.glob("*.json")) if folder.is_dir() else []
    if not paths:
        raise SceneError(f"{folder}: holds no records; expected files of mpmfw compare --records")
    found, wrong = [], []
    for path in paths:
        try:
            about = path.lstat()
            if not stat.S_ISREG(about.st_mode) or about.st_size > LARGEST:
                raise ValueError(f"expected a plain file of at most {LARGEST} bytes")
            found.append(Record.model_validate_json(path.read_bytes()))
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            wrong.append(f"{path}: {'.'.join(map(str, first['loc']))!r}: {first['msg']}")
        except (OSError, ValueError) as error:
            wrong.append(f"{path}: {error}")
    if wrong:
        raise SceneError("\n".join(wrong))
    return found


def ranked(records: Sequence[Record]) -> dict[str, list[dict[str, Any]]]:
    """Return rows by problem: ok first, then by the largest error (missing is infinite), then by cost."""
    problems: dict[str, list[Record]] = {}
    for record in sorted(records, key=lambda record: record.scene):
        problems.setdefault(record.problem, []).append(record)
    return {f"{same[0].scene} ({problem})": _rows(same) for problem, same in problems.items()}


def dots_of(records: Sequence[Record]) -> list[Dot]:
    """Return a dot of each record that is ok, in order of their rows, mpmfw's methods first."""

    def order(one: Record) -> tuple[str, str, float, str, bool, str]:
        code = not one.code.startswith("mpmfw")
        return one.scene, one.problem, -one.cell_size, one.machine, code, one.method

    found = []
    for record in sorted((one for one in records if one.status == "ok"), key=order):
        errors, cost = _errors(record), record.figures.get("cpu_time", math.nan)
        spin = errors.pop("spin_error", math.nan)
        motion = max((each for name, each in errors.items() if "force" not in name), default=math.nan)
        row = record.problem, record.scene, record.cell_size, record.machine
        found.append(Dot(row, record.method, record.code.split()[0], motion, spin, cost))
    return found


def _errors(record: Record) -> dict[str, float]:
    """Return the sizes of a record's errors [%]."""
    names = (name for name in record.figures if "_error" in name)
    return {
        name: abs((100.0 if column_of(name).unit == "1" else 1.0) * record.figures[name]) for name in names
    }


def _rows(records: Sequence[Record]) -> list[dict[str, Any]]:
    names = {name for record in records for name in _errors(record)}

    def order(record: Record) -> tuple[bool, float, float]:
        errors = [_errors(record).get(name, math.inf) for name in names]
        return record.status != "ok", max(errors, default=math.inf), record.figures.get("cpu_time", math.inf)

    return [
        {"method": record.method, "shape": record.shape, "code": record.code, **record.settings}
        | {"status": record.status, **record.figures, "machine": record.machine}
        for record in sorted(records, key=order)
    ]


def _cleaned(value: Any) -> Any:
    """Return a number, or a text without control characters, shortened."""
    if isinstance(value, int | float):
        return float(value)
    return "".join(c if c.isprintable() else " " for c in str(value))[:LONGEST]


def _problem(scene: Scene, materials: Mapping[str, Any]) -> str:
    """Return a hash of the scene's meaning, without methods, names and inactive keys, so that new keys and
    options of materials of later versions do not change it. Materials by code count as written."""
    tables, meshes = meaning_of(scene, {}).values()
    for name, material in scene.materials.items():
        given = {} if material.options is None else material.options.model_dump(exclude_defaults=True)
        options = tables["materials"][name]["options"] or {}
        tables["materials"][name]["options"] = {key: options[key] for key in options if key in given}
    for name, body in tables["bodies"].items():
        for side in body["sides"]:  # records are older than this key, and lists are not cleaned below
            if side["within"] is None:
                del side["within"]
        own = {"material": tables["materials"].get(body["material"])}
        tables["bodies"][name] = {k: v for k, v in body.items() if not is_numerical(f"bodies.body.{k}")} | own
    tables["materials"] = [one for one in materials.values() if next(code_in(one), None)]
    tables["time"] = tables["time"]["end"]
    if scene.contact is not None:
        pairs = [(a, b, f"{friction:.15g}") for a, b, friction in scene.pairs]
        by_pair = [(pair.bodies, pair.method) for pair in scene.contact.pairs if pair.method]
        options = tables["contact"].get("friction_options")
        tables["contact"] = [pairs, scene.contact.friction_law, options, *([by_pair] if by_pair else [])]
    tables["settle"] = scene.settle and [tables["settle"]["gravity"]]
    for group in ("loads", "boundaries"):
        tables[group] = sorted(json.dumps(one, sort_keys=True) for one in tables[group].values())
    return _hash([_given({key: tables[key] for key in tables if key not in _METHODS}), meshes])


def _given(value: Any) -> Any:
    """Return tables without keys that are None, false or empty."""
    if not isinstance(value, Mapping):
        return value
    tables = {key: _given(one) for key, one in value.items()}
    return {key: one for key, one in tables.items() if one is not False and one not in (None, {}, [], ())}


def _hash(content: Any) -> str:
    text = json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
