"""Options of the chosen plug-ins, validated by their models; other plug-ins are not imported."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import BaseModel

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import Kind, available, choices, load
from mpmfw.scene.contact_parts import PARTS, parts_of
from mpmfw.scene.problem import Path, Problem
from mpmfw.scene.wording import shown, unknown_key, unknown_name, with_options

#: Keys of the tables that the core reads itself.
CORE_KEYS: dict[str, tuple[str, ...]] = {
    "shape": ("method",),
    "contact": ("method", "detection", "law", "friction", "friction_law", "pairs"),
    "materials": ("model", "density", "damping"),
    **dict.fromkeys(("loads", "boundaries", "outputs"), ("model", "bodies")),
}

#: Groups of tables with names of the scene's choice, each with a model and its options, and the models' kind.
NAMED: dict[str, Kind] = {
    "materials": "material",
    "loads": "load",
    "boundaries": "boundary",
    "outputs": "output",
}


@dataclass
class Chosen:
    """Choices of a scene: the core's part of the mapping, options by path, and their problems."""

    core: dict[str, Any]
    whole: dict[str, Any] = field(default_factory=dict)  #: the mapping, its contact written with a method
    options: dict[Path, BaseModel] = field(default_factory=dict)
    plugins: dict[Path, type[Any]] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    #: Tables of ``[contact]`` whose options run: of its parts, where they are named; else of its method.
    contact_tables: tuple[str, ...] = ()
    #: Keys of the tables of pairs, in their order: ``a-b``, or an index.
    pairs: tuple[str | int, ...] = ()

    def placed(self, problem: Problem) -> Problem:
        """Return a problem with the key of its pair; the core's tables have an index there."""
        path = problem.path
        if path[:2] == ("contact", "pairs") and path[2:] and isinstance(path[2], int):
            path = (*path[:2], self.pairs[path[2]], *path[3:])
        return replace(problem, path=path)


def separate_options(mapping: Mapping[str, Any], contact_keys: Any = CORE_KEYS["contact"]) -> Chosen:
    """Separate the plug-ins' options from the core's tables, and validate those of the chosen plug-ins.

    The core reads ``contact_keys`` of ``[contact]``."""
    chosen = Chosen(dict(mapping))
    contact = mapping.get("contact")
    if isinstance(contact, Mapping):
        parts, problems = parts_of(contact)
        chosen.problems += problems
        if parts is not None:
            chosen.core["contact"], chosen.contact_tables = parts.table, parts.names
        chosen.whole = dict(chosen.core)
        by = "method" if parts is None else "law"
        table = _method_table(chosen, "contact", chosen.core["contact"], contact_keys, by)
        if "pairs" in table:
            table = {**table, "pairs": _pairs(chosen, table["pairs"])}
        # what is wrong with the parts was told
        chosen.core["contact"] = {**table, "method": ""} if problems and "method" not in table else table
    else:
        chosen.whole = dict(chosen.core)
    if isinstance(mapping.get("shape"), Mapping):
        chosen.core["shape"] = _method_table(chosen, "shape", mapping["shape"], CORE_KEYS["shape"])
    for group in NAMED:
        tables = mapping.get(group)
        if isinstance(tables, Mapping):
            chosen.core[group] = {name: _named(chosen, group, name, table) for name, table in tables.items()}
    return chosen


def _pairs(chosen: Chosen, given: Any) -> Any:
    """Return the tables of pairs, ``{a-b: …}`` or with ``bodies``, as a list without options."""
    if not isinstance(given, Mapping | list):
        text = f"expected tables [contact.pairs.a-b] of two bodies, or an array of tables, not {shown(given)}"
        chosen.problems.append(Problem(("contact", "pairs"), text))
        return []
    named, tables = isinstance(given, Mapping), []
    kept = ("friction",) if named else ("bodies", "friction")
    valid = [*kept, "method", *PARTS]
    for key, table in given.items() if isinstance(given, Mapping) else enumerate(given):
        path: Path = ("contact", "pairs", key)
        if named and str(key).count("-") != 1:
            chosen.problems.append(Problem(path, "expected the names of two bodies, joined by '-'"))
            continue
        if not isinstance(table, Mapping):
            text = f"expected a table with {', '.join(valid[:-1])} or {valid[-1]}, not {shown(table)}"
            chosen.problems.append(Problem(path, text))
            continue
        chosen.pairs += (key,)
        core = {name: value for name, value in table.items() if name in kept}
        core |= {"bodies": str(key).split("-")} if named else {}
        of_all = {"bodies", *CORE_KEYS["contact"]}.difference(valid)
        chosen.problems += [unknown_key((*path, name), valid) for name in table if name in of_all]
        contact = {name: value for name, value in table.items() if name not in {*kept, *of_all}}
        if contact:
            core |= _contact_of_pair(chosen, path, contact)
        tables.append(core)
    return tables


def _contact_of_pair(chosen: Chosen, path: Path, table: Mapping[str, Any]) -> dict[str, Any]:
    """Validate the contact of the pair at ``path``, written as in ``[contact]``; return its method."""
    own = separate_options({"contact": table}, ("friction", "method", *PARTS))
    core: dict[str, Any] = own.core["contact"]
    used = {*own.contact_tables, core.get("method"), *CORE_KEYS["contact"]}
    if not own.problems and "method" not in core:
        own.problems.append(Problem(("contact", "method"), "missing; expected method, or detection and law"))
    elif not own.problems:
        text = "has no effect: it belongs to another contact than the pair's"
        own.problems += [Problem(("contact", name), text) for name in table if name not in used]
    chosen.problems += [replace(problem, path=(*path, *problem.path[1:])) for problem in own.problems]
    chosen.options |= {(*path, *name[1:]): options for name, options in own.options.items()}
    chosen.plugins |= {(*path, *name[1:]): plugin for name, plugin in own.plugins.items()}
    return {"method": "", **core} if own.problems else core  # what is wrong was told


def _method_table(
    chosen: Chosen, kind: Kind, table: Mapping[str, Any], core_keys: tuple[str, ...], named_by: str = "method"
) -> dict[str, Any]:
    """Return the core's part of a table; a problem of the method is reported at the key ``named_by``."""
    installed = choices(kind)
    if kind == "contact":
        for part in ("detection", "law", "friction"):
            installed.update(available(part))
    plain = [each for each in installed if "+" not in each]
    for key, value in table.items():
        if key in core_keys:
            continue
        if key not in installed and isinstance(value, Mapping):
            names = [*plain, *core_keys]
            chosen.problems.append(unknown_name((kind, key), key, names, f"no such {kind} plug-in: "))
        elif key not in installed:
            chosen.problems.append(unknown_key((kind, key), [*core_keys, *plain]))
        elif not isinstance(value, Mapping):
            message = f"expected a table of options of '{key}', not {shown(value)}"
            chosen.problems.append(Problem((kind, key), message))
    named: list[tuple[str, str, Kind]] = [("method", named_by, kind)]
    if kind == "contact":
        named.append(("friction_law", "friction_law", "friction"))
    for key, at, of in named:
        name = table.get(key)
        if isinstance(name, str) and isinstance(options := table.get(name, {}), Mapping):
            _validate(chosen, of, name, (kind, at), (kind, name), options)
    return {key: value for key, value in table.items() if key in core_keys and key not in PARTS}


def _named(chosen: Chosen, group: str, name: str, table: Any) -> Any:
    """Take the model's options out of a table such as ``[materials.NAME]`` or ``[loads.NAME]``."""
    if not isinstance(table, Mapping):
        return table
    core_keys = CORE_KEYS[group]
    path: Path = (group, name)
    options = {key: value for key, value in table.items() if key not in core_keys}
    if isinstance(table.get("model"), str):
        _validate(chosen, NAMED[group], table["model"], (*path, "model"), path, options, core_keys)
    elif "model" not in table:
        # Without a model the other keys cannot be judged, but one that is nearly "model" is the cause
        found = [unknown_key((*path, key), list(core_keys)) for key in options]
        chosen.problems += [problem for problem in found if problem.suggestion]
    return {key: value for key, value in table.items() if key in core_keys}


def _validate(
    chosen: Chosen,
    kind: Kind,
    name: str,
    name_path: Path,
    table_path: Path,
    options: Mapping[str, Any],
    core_keys: tuple[str, ...] = (),
) -> None:
    """Validate one plug-in's options; collect problems with the path of the name or of the option."""
    installed = choices(kind)
    alone = name.partition("(")[0]
    if alone != name and alone in installed:
        message = f"expected the name alone, '{alone}', and its options in the table [{kind}.{alone}]"
        chosen.problems.append(Problem(name_path, message))
        return
    if name not in installed:
        chosen.problems.append(unknown_name(name_path, name, list(installed), f"no such {kind} plug-in: "))
        return
    try:
        plugin = load(kind, name)
    except SceneError as error:
        chosen.problems.append(Problem(name_path, str(error)))
        return
    chosen.plugins[table_path] = plugin
    made, problems = with_options(plugin, options, table_path, core_keys)
    chosen.problems += problems
    if made is not None:
        chosen.options[table_path] = made
