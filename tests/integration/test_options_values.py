"""Nothing is silently ignored, word by word: every value of an option that is one of several words acts as
none other.

The options are found in the models themselves: a word without an entry in a table of the tests fails here.
"""

from __future__ import annotations

import itertools
from typing import Any, Literal, get_args, get_origin

import pytest
from pydantic import BaseModel

from options_found import NO_OPTIONS, option_models, outcome
from options_table import ASKED_BY_THE_KIT, CORE, EACH, PLUGINS, Acts, Each
from scenes_for_tests import with_changes

pytestmark = pytest.mark.effects


def words_of(annotation: Any) -> set[str]:
    """Words that an annotation allows, however deep."""
    if get_origin(annotation) is Literal:
        return {word for word in get_args(annotation) if isinstance(word, str)}
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return set()
    return set().union(*(words_of(part) for part in get_args(annotation)))


WORDS = {
    f"{table}.{name}": words
    for table, model in option_models().items()
    if not table.startswith(ASKED_BY_THE_KIT)
    for name, field in model.model_fields.items()
    if name not in NO_OPTIONS and (words := words_of(field.rebuild_annotation()))
}


def tried(entry: Acts) -> set[str]:
    """Every word that an entry of the table of two values tries."""
    return set(itertools.chain(*(words_in(value) for value in (entry.first, entry.second))))


def words_in(value: Any) -> set[str]:
    """Every text in nested tables."""
    if isinstance(value, str):
        return {value}
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    return set().union(*map(words_in, parts))


def test_the_options_of_words_are_found() -> None:
    assert WORDS["Body.rotation"] == {"spin", "exact", "lumped"}
    assert {"Stepping.scheme", "Particles.layout"} <= set(WORDS)


@pytest.mark.parametrize("option", WORDS)
def test_every_word_is_tried(option: str) -> None:
    found = set(EACH[option].changes) if option in EACH else tried({**CORE, **PLUGINS}[option])
    assert found >= WORDS[option]
    assert option in EACH or len(WORDS[option]) <= 2  # two that differ are told by the table of two values


@pytest.mark.parametrize("option", EACH)
def test_every_word_acts_as_none_other(option: str) -> None:
    entry: Each = EACH[option]
    found = {word: outcome(with_changes(entry.scene, **changes)) for word, changes in entry.changes.items()}
    assert not any(one.startswith("refused") for one in found.values()), found
    if entry.auto is not None:
        assert found.pop("auto") == found[entry.auto]
    same = [pair for pair in itertools.combinations(found, 2) if found[pair[0]] == found[pair[1]]]
    assert same == []
