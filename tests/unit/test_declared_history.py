"""Declared history: values by place, of the type and shape of what was built, through a file and back."""

import zipfile

import numpy as np
import pytest

from checkpoints_for_tests import FACTS, write
from mpmfw.errors import MpmfwError
from mpmfw.runs.restart import is_foreign, read_snapshot, write_snapshot
from mpmfw.state.history import NotSaved, put, take


class Part:
    """Keeps one array and what bases name beside it."""

    history: tuple[str, ...] = ("values",)

    def __init__(self, values):
        self.values = values


class Thing(Part):
    """Keeps more."""

    history = ("kept", "part")

    def __init__(self, kept, values=0.0):
        super().__init__(values)
        self.kept, self.part, self.seen = kept, Part(np.zeros(2)), None

    def restored(self):
        self.seen = self.kept


def through_a_file(thing, other, path):
    write_snapshot(str(path), take({"thing": thing}))
    put(read_snapshot(str(path))[0], {"thing": other})
    return other


@pytest.mark.parametrize(
    ("saved", "built"),
    [
        (1.0, 1), (1, 1.0), (True, 1), (None, 1.0), ({"a": 1.0}, {"b": 1.0}), (np.zeros(2), None),
        ({"a": 1.0}, 2.0), (1.0, {"a": 1.0}), (1.0, np.zeros(0)),
        (np.zeros(2), np.zeros(3)), (np.zeros(2), np.zeros((0, 2))), (np.zeros(2), np.zeros(2, dtype="i8")),
        (1.0, np.zeros(1)),
        (np.zeros(1), 1.0), ({"a": np.zeros(1)}, {"b": np.zeros(1)}), ({"a": np.zeros(1)},
        {"a": np.zeros(1), "b": np.zeros(1)}),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_with_its_place(tmp_path, saved, built):
    with pytest.raises(NotSaved, match=r"^thing/kept(/[ab])? (does not fit|was not saved)"):
        through_a_file(Thing(saved), Thing(built), tmp_path / "file")


def test_other_parts_are_refused():
    with pytest.raises(NotSaved, match="other/values was not saved"):
        put(take({"one": Part(1.0)}), {"other": Part(1.0)})
    with pytest.raises(NotSaved, match="other/values has no place in what was built"):
        put(take({"one": Part(1.0), "other": Part(1.0)}), {"one": Part(1.0)})


@pytest.mark.parametrize(
    "value", [object(), 2**63, [1], {"a": "b"}, {1: 2.0}, np.array([object()]), np.zeros(1, dtype="c16"),
    (1, 2), "text", ["a"]],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_what_cannot_be_saved_is_named_with_its_place(value):
    with pytest.raises(NotSaved, match=r"^thing/kept is a .*; expected"):
        take({"thing": Thing(value)})


# -- the file


def crafted(path, name):
    """Write a file that says too much, too little or something else."""
    if name == "compressed":
        with open(path, "wb") as file:
            np.savez_compressed(file, **{FACTS: np.frombuffer(b"[1, null]", np.uint8), "a": np.zeros(10**6)})
    elif name == "a shape of 1e12 numbers":
        header = {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr(f"{FACTS}.npy", b"")
            with archive.open("a.npy", "w") as member:
                np.lib.format.write_array_header_1_0(member, header)
    elif name == "facts of many brackets":
        write(path, "[" * 100_000)
    else:
        write(path, None, a=np.array([object()]))


@pytest.mark.parametrize(
    "name", ["a shape of 1e12 numbers", "compressed", "facts of many brackets", "objects"]
)
def test_a_crafted_file_is_one_message(tmp_path, name):
    path = tmp_path / "file"
    crafted(path, name)
    with pytest.raises(MpmfwError, match=r"^'.*file' was cut short or is damaged$"):
        read_snapshot(str(path))


def test_files_of_other_versions_and_of_others_are_no_checkpoints(tmp_path):
    path = tmp_path / "file"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("values.json", "[]")
    assert is_foreign(str(path))
    with pytest.raises(MpmfwError, match="is not a checkpoint that this version of mpmfw wrote"):
        read_snapshot(str(path))
    with pytest.raises(MpmfwError, match=r"cannot read '.*nothing': No such file"):
        read_snapshot(str(tmp_path / "nothing"))
