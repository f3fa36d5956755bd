"""The conformance kit as the ordinary tests ask it: entry points are read once, and searches try less."""

import contextlib
import functools
import itertools
import os

import pytest

import mpmfw.plugin.discovery
from mpmfw_testing.contact import impact, symmetry
from mpmfw_testing.examination import examine_one
from mpmfw_testing.parametrised import checks_of
from mpmfw_testing.searching import search, try_all
from mpmfw_testing.shape import cases as placements

#: ``MPMFW_EXAMPLES=all`` tries all examples of the kit, each of which is a simulation.
ALL = os.environ.get("MPMFW_EXAMPLES") == "all"


def check_of(kind, name):
    """The check of a kind with this name."""
    return next(check for check in checks_of(kind) if check.name == name)


@contextlib.contextmanager
def quickly():
    """A third of the examples of a search, at least two, and half of the cases of symmetries."""

    def fewer(cases, trial, *, examples, **others):
        search(cases, trial, examples=max(2, examples // 3), **others)

    def every_other(cases, trial, **others):
        count = itertools.count()
        try_all(cases, lambda **numbers: next(count) % 2 or trial(**numbers), **others)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(impact, "search", fewer)
        patch.setattr(placements, "search", fewer)
        patch.setattr(symmetry, "try_all", every_other)
        yield


def asked(subject, name, lacking=""):
    """What comes of a check that is expected to pass, or to fail for the reason given."""
    with contextlib.nullcontext() if lacking or ALL else quickly():
        return examine_one(subject, check_of(subject.kind, name), lacking)


@pytest.fixture(autouse=True, scope="module")
def entry_points_are_read_once():
    """Nothing is installed meanwhile; reading it anew for every simulation takes most of the time."""
    with pytest.MonkeyPatch.context() as patch:
        read = functools.cache(mpmfw.plugin.discovery.entry_points)
        patch.setattr(mpmfw.plugin.discovery, "entry_points", read)
        yield
