"""Options that cannot have an effect are refused, and what could not be solved is told."""

from __future__ import annotations

import pytest
from mpmfw_surface_impulse import SurfaceImpulse
from pydantic import ValidationError
from scenes import bars

import mpmfw
from mpmfw.api import SceneError


def test_mpmfw_finds_it_by_name():
    scene = {**bars(steps=2)}
    assert mpmfw.run(scene)["series"].sizes["time"] == 3


def test_slave_needs_one_pass():
    with pytest.raises(ValidationError, match='passes = "one"'):
        SurfaceImpulse(slave="left")


def test_slave_must_be_a_body():
    with pytest.raises(SceneError, match="no body 'lft'; expected one of left, right"):
        mpmfw.run(bars(steps=1, passes="one", slave="lft"))


def test_too_few_sweeps_are_told():
    with pytest.warns(UserWarning, match="try a larger contact.surface_impulse.sweeps"):
        mpmfw.run(bars(steps=120, friction=0.3, slide=0.2, sweeps=1, tolerance=1e-14))
