"""Makes ``tests`` importable, and says what all tests share."""

import gc
from importlib.metadata import EntryPoint

import pytest
from hypothesis import HealthCheck, settings

from python_files import write_metadata

# How long an example takes says what else the machine has to do
settings.register_profile("tests", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tests")


#: The files that take longest. Workers begin with them, so that none is left over at the end.
LONGEST = ("test_conformance", "test_hard_cases", "test_tutorial", "test_contact", "test_validation")


def pytest_collection_modifyitems(items):
    """Put the longest files first."""
    items.sort(key=lambda item: item.path.stem not in LONGEST)


def pytest_collection_finish():
    """Let the collector of garbage leave alone what stays to the end: it took seven percent of all time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Make a distribution: its entry points of one kind, and the source of its only module."""

    def make(distribution, entries, source="", kind="contact"):
        folder = tmp_path / distribution
        write_metadata(folder, distribution, {f"mpmfw.{kind}": entries})
        (folder / f"{distribution}.py").write_text(source)
        monkeypatch.syspath_prepend(str(folder))

    return make


@pytest.fixture
def announce(monkeypatch):
    """Announce a class of a module, by its kind and name, as an installation would."""
    from mpmfw.plugin import discovery

    known, own = discovery.entry_points, []

    def found(**group):
        return (
            [*known(**group), *(entry for entry in own if entry.group == group["group"])]
            if group
            else known()
        )

    monkeypatch.setattr(discovery, "entry_points", found)
    return lambda kind, name, target: own.append(EntryPoint(name, target, f"mpmfw.{kind}"))
