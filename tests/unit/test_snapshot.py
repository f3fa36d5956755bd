"""What a snapshot takes and puts back: values by place, each object once, code as it was built."""

from __future__ import annotations

import io
import itertools
import json
import re
import sys
from collections import Counter, OrderedDict, defaultdict, deque
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pytest

from mpmfw.snapshot import NotSaved, Snapshot, put, take


class Pair(NamedTuple):
    first: Any
    second: Any


@dataclass(frozen=True)
class Fact:
    name: str


@dataclass(slots=True)
class Slotted:
    value: float = 1.0


@dataclass
class Thing:
    parts: dict[str, Any] = field(default_factory=dict)


def moved(values: dict[str, Any], into: dict[str, Any] | None = None) -> dict[str, Any]:
    """The values after a way through a file, in another object."""
    file, other = io.BytesIO(), Thing(into or {})
    take({"thing": Thing(values)}).write(file, {"told": 1})
    snapshot, facts = Snapshot.read(file)
    assert facts == {"told": 1}
    put(snapshot, {"thing": other})
    return other.parts


VALUES = [
    None, True, -7, 2**200, 0.1 + 0.2, float("inf"), "tëxt\ud800", 1 + 2j, b"\0x", slice(1, None, 2), range(3),
    np.float64(0.1), np.int32(4), np.bool_(True), (1, (2, 3)), [1, [2]], {"a": {1: 2}}, {3, 1}, frozenset({2}),
    deque([1, 2], maxlen=3), OrderedDict(b=1, a=2), Counter("aab"), Pair(1, [2]), Fact("x"), Slotted(3.0), float, np.zeros,
]  # fmt: skip


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_values_come_back(value):
    back = moved({"it": value})["it"]
    assert type(back) is type(value)
    assert back == value


@pytest.mark.parametrize("order", ["C", "F"])
def test_arrays_come_back_to_the_bit_in_their_order(order):
    array = np.array([[np.nan, -0.0, 1e-310], [1.0, 2.0, np.inf]], order=order)
    back = moved({"it": array})["it"]
    assert back.tobytes() == array.tobytes()
    assert back.flags.f_contiguous == array.flags.f_contiguous
    assert back.dtype == array.dtype


def test_views_of_one_array_stay_views_of_one():
    room = np.arange(24.0).reshape(4, 6)
    back = moved(
        {
            "part": room[1:, ::-2],
            "room": room,
            "turned": room.T,
            "none": room[:0],
            "flat": room.ravel().view("i8")[:3],
        }
    )
    np.testing.assert_array_equal(back["part"], room[1:, ::-2])
    back["room"][1, 5] = -1.0
    assert back["part"][0, 0] == -1.0
    assert back["turned"][5, 1] == -1.0
    assert back["none"].shape == (0, 6)


def test_what_is_held_twice_is_one_thing_afterwards():
    shared = [1]
    back = moved({"a": shared, "b": {"c": shared}, "array": (x := np.zeros(2)), "again": x})
    assert back["a"] is back["b"]["c"]
    assert back["array"] is back["again"]


def test_what_was_one_thing_and_is_two_comes_apart():
    one = np.zeros(3)
    back = moved({"a": np.ones(3), "b": np.full(3, 2.0)}, {"a": one, "b": one})
    assert (back["a"][0], back["b"][0]) == (1.0, 2.0)


def test_objects_and_arrays_that_are_there_keep_their_identity():
    array, part = np.zeros(2), Slotted()
    back = moved({"array": np.ones(2), "part": Slotted(5.0)}, {"array": array, "part": part})
    assert back["array"] is array
    assert back["part"] is part
    assert part.value == 5.0


def test_a_frozen_object_that_others_may_hold_is_left_alone():
    mine = Fact("mine")
    assert moved({"it": Fact("yours")}, {"it": mine})["it"] == Fact("yours")
    assert mine.name == "mine"


def test_swapped_objects_are_swapped_afterwards():
    a, b = Slotted(1.0), Slotted(2.0)
    one, other = (
        Thing({"now": b, "old": a}),
        Thing({"now": (x := Slotted()), "old": (y := Slotted()), "held": x}),
    )
    one.parts["held"] = a
    put(take({"thing": one}), {"thing": other})
    assert (x.value, y.value) == (2.0, 1.0)
    assert other.parts["held"] is y


def test_an_attribute_that_was_not_there_goes():
    one, other = Thing(), Thing()
    other.later = 3  # type: ignore[attr-defined]
    put(take({"thing": one}), {"thing": other})
    assert not hasattr(other, "later")


def test_random_generators_go_on():
    one, other = np.random.default_rng(1), np.random.default_rng(2)
    one.random(5)
    put(take({"thing": Thing({"random": one})}), {"thing": Thing({"random": other})})
    assert one.random() == other.random()


def test_default_dicts_and_bound_methods():
    counts: Any = defaultdict(list, a=[1])
    back = moved(
        {"counts": counts, "add": counts["a"].append, "of": Slotted.__init__},
        {"counts": defaultdict(list), "add": [].append},
    )
    assert back["counts"]["b"] == []


def test_own_words_for_what_has_no_values():
    class Reader:
        def __init__(self) -> None:
            self.lines = iter(range(10))
            self.read = 0

        def next(self) -> int:
            self.read += 1
            return next(self.lines)

        def __getstate__(self) -> int:
            return self.read

        def __setstate__(self, read: int) -> None:
            self.__init__()  # type: ignore[misc]
            while self.read < read:
                self.next()

    one, other = Reader(), Reader()
    one.next()
    one.next()
    put(take({"thing": Thing({"it": one})}), {"thing": Thing({"it": other})})
    assert other.next() == 2


@pytest.mark.parametrize(
    "value",
    [itertools.count(), iter([1]), sys.stdout, (k for k in range(3)), np.array([object()]), type("Text", (str,), {})("a")],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_what_cannot_be_saved_is_named_with_its_place(value):
    with pytest.raises(
        NotSaved, match=r"^plug-in 'law'\.parts\['it'\]\[0\] is a .*, which cannot be saved; expected numbers"
    ):
        take({"plug-in 'law'": Thing({"it": (value,)})})


def test_code_that_is_not_there_is_named():
    with pytest.raises(
        NotSaved,
        match=r"thing.parts\['it'\] was .*<lambda>, which a run that is built anew does not have there",
    ):
        moved({"it": lambda: 1})


def test_a_class_that_is_not_there_is_named():
    snapshot = take({"thing": Thing({"it": Fact("x")})})
    text = str(snapshot.nodes).replace("Fact", "Fiction")
    snapshot.nodes[:] = eval(text)
    with pytest.raises(NotSaved, match=r"the plug-ins have no class test_snapshot.Fiction here"):
        put(snapshot, {"thing": Thing()})


@pytest.mark.parametrize(
    "name", ["os:system", "builtins:eval", "subprocess:run", "mpmfw.snapshot.archive:os.system"]
)
def test_a_file_names_no_function_of_others(name):
    snapshot = take({"thing": Thing({"it": np.zeros})})
    assert '{"code": "numpy' in json.dumps(snapshot.nodes)
    snapshot.nodes[:] = json.loads(
        re.sub('{"code": "numpy[^"]*"}', f'{{"code": "{name}"}}', json.dumps(snapshot.nodes))
    )
    with pytest.raises(NotSaved, match=r"which a run that is built anew does not have there"):
        put(snapshot, {"thing": Thing()})


@pytest.mark.parametrize("name", ["subprocess:Popen", "pathlib:Path", "test_snapshot:nobody"])
def test_a_file_names_no_class_of_others(name):
    snapshot = take({"thing": Thing({"it": Slotted()})})
    snapshot.nodes[:] = json.loads(json.dumps(snapshot.nodes).replace("test_snapshot:Slotted", name))
    with pytest.raises(NotSaved, match=r"the plug-ins have no class"):
        put(snapshot, {"thing": Thing()})
