"""Answers that a run cannot go on with are named: plug-in, hook or method, and what was expected."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mpmfw
from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import hookimpl
from mpmfw.errors import MpmfwError
from mpmfw_material.neo_hookean import NeoHookean
from mpmfw_shape.linear import Linear
from scenes_for_tests import two_blocks


class Twice(PlainContact):
    """Yields twice."""

    name = "twice"

    @hookimpl(wrapper=True)
    def add_nodal_force(self):
        yield
        yield


class Never(PlainContact):
    """Is a generator that yields nothing."""

    name = "never"

    @hookimpl(wrapper=True)
    def add_nodal_force(self):
        yield from ()


class Unanswered(Linear):
    """Gives no stencil."""

    name = "unanswered"

    @hookimpl
    def interpolate(self):
        return None


class Mute(NeoHookean):
    """Answers nothing."""

    name = "mute"

    def energy_density(self, deformation_gradient):  # noqa: ARG002
        return None


class Shear(NeoHookean):
    """Gives of a tensor one component."""

    name = "shear"

    def cauchy_stress(self, deformation_gradient):
        return super().cauchy_stress(deformation_gradient)[:, 0, 1]


class Negative(NeoHookean):
    """Has a modulus that no step is stable with."""

    name = "negative"
    bulk_modulus = -6e6


class Softened(NeoHookean):
    """Forgets to return a modulus."""

    name = "softened"
    shear_modulus = None


class Broken(NeoHookean):
    """Fails where a bundled plug-in calls it."""

    name = "broken"

    def cauchy_stress(self, deformation_gradient):  # noqa: ARG002
        raise KeyError("hardening")


def run(method: Any) -> None:
    scene = two_blocks("none", time__end=0.01, time__output_interval=0.005)
    place = f"{__name__}:{method.__name__}"
    if issubclass(method, NeoHookean):
        for table in scene["materials"].values():
            table["model"] = place
    else:
        scene["contact" if issubclass(method, PlainContact) else "shape"] = {"method": place}
    mpmfw.run(scene)


@pytest.mark.parametrize(
    ("method", "said"),
    [
        (Twice, "'twice' of .* failed in add_nodal_force: .* yields more than once; expected one yield"),
        (Never, "'never' of .* failed in add_nodal_force: .* yields never; expected one yield"),
        (Unanswered, "'unanswered' of .* failed in interpolate: .*returned None; expected a Stencil"),
        (Mute, r"'mute' of .* answered energy_of_points with None; expected an array of shape \(32,\)"),
        (Shear, r"'shear' of .* answered stress_of_points with .*; expected an array of shape \(32, 3, 3\)"),
        (Negative, "'negative' of .* has bulk_modulus -6000000.0; expected a number above 0 in Pa"),
        (Softened, "'softened' of .* has shear_modulus None; expected a number from 0 in Pa"),
        (Broken, "'broken' of .* failed in stress_of_points: KeyError: 'hardening'"),
    ],
)
def test_who_answers_wrongly_is_named(method, said):
    with pytest.raises(MpmfwError, match=rf"(?s)plug-in {said}"):
        run(method)


@pytest.mark.parametrize("key", ["bulk_modulus", "shear_modulus", "density"])
def test_a_negative_modulus_of_a_scene_is_refused(key):
    scene = two_blocks("none")
    (name,) = scene["materials"]
    scene["materials"][name][key] = -1e6
    with pytest.raises(MpmfwError, match=rf"materials\.{name}\.{key}: must be greater than 0"):
        mpmfw.run(scene)


def test_a_wrapper_that_yields_once_gets_the_result():
    results: list[Any] = []

    class Once(PlainContact):
        name = "once"

        @hookimpl(wrapper=True)
        def stable_timestep(self):
            answers = yield
            results.extend(answers)
            return answers

    mpmfw.run(two_blocks("none", time__end=0.01, time__output_interval=0.005), contact=Once())
    assert np.isfinite([limit for limit, _ in results]).all()
