"""Plug-ins that fail or misbehave are named with place and step; what was written stays."""

import sys
import textwrap

import numpy as np
import pytest

import mpmfw
from mpmfw.errors import MpmfwError, PluginError, ResultsWarning, SceneError
from mpmfw_material.neo_hookean import NeoHookean
from scenes_for_tests import two_blocks

HEAD = """
import os, sys
import numpy as np
from pydantic import BaseModel, field_validator
from mpmfw.api import ContactStrategy, Field, ShapeFunction, hookimpl

class Law(ContactStrategy):
    name = "oddity"
"""


@pytest.fixture
def law(tmp_path, monkeypatch, install):
    """Make the distribution ``strange`` with a contact plug-in ``oddity``, of the body of its class."""

    def make(body, head=HEAD):
        source = head + textwrap.indent(textwrap.dedent(body), "    ")
        install("strange", {"oddity": "strange:Law"}, source)
        monkeypatch.setattr(sys, "dont_write_bytecode", True)
        monkeypatch.delitem(sys.modules, "strange", raising=False)

    monkeypatch.chdir(tmp_path)
    return make


def run(**further):
    scene = two_blocks(
        "oddity", time={"end": 0.1, "output_interval": 0.05}, output={"gap": False, "particles": False}
    )
    return mpmfw.run(scene, **further)


WHO = "plug-in 'oddity' of distribution strange"

#: Body of the class, the error, its message.
BEFORE = {
    "exit in the constructor": (
        "def __init__(self): sys.exit(0)",
        f"{WHO} failed in its constructor: SystemExit: 0 (strange.py, line 9)",
    ),
    "error in a validator": (
        """
        class Options(BaseModel):
            a: float = 1.0
            @field_validator("a")
            @classmethod
            def check(cls, value): return {}[value]
        """,
        "contact.oddity: Options of plug-in 'oddity' of distribution strange cannot judge them: KeyError: "
        "2.0",
    ),
    "a field of the core's": (
        "@hookimpl\ndef declare_fields(self): return [Field('mass', ('particle',), 'kg m-1', 'mass')]",
        f"{WHO} and the core both declare a field 'mass'",
    ),
    "the name of another plug-in": (
        "def parts(self):\n    class Part:\n        name = 'cpdi'\n    return [Part()]",
        "have one name; expected another for one of them",
    ),
    "a hook that there is not": (
        "@hookimpl\ndef add_nodal_forces(self, grid): pass",
        f"{WHO}: unknown hook 'add_nodal_forces'",
    ),
    "an argument that a hook has not": ("@hookimpl\ndef add_nodal_force(self, gird): pass", "gird"),
    "a hook without its mark": (
        "def after_momentum_update(self, grid): pass",
        f"{WHO}: after_momentum_update has the name of a hook; expected @hookimpl above it",
    ),
}  # fmt: skip

DURING = {
    "error in a hook": (
        "@hookimpl\ndef end_step(self, state): state.steps > 2 and {}['k']",
        f"{WHO} failed in end_step: KeyError: 'k' (strange.py, line 10), in step 4: at time",
    ),
    "diagnostics that are not finite": (
        "@hookimpl\ndef declare_fields(self): return [Field('a', (), '1', 'a', 'series', output=True)]\n"
        "@hookimpl\ndef diagnostics(self, state): return {'a': np.nan}",
        f"series/a of {WHO} is not finite: at time 0 s",
    ),
    "a limit that becomes NaN": (
        "@hookimpl\ndef stable_timestep(self, state): return (np.nan if state.steps > 1 else 1.0, 'law')",
        "answered stable_timestep with (nan, 'law'); expected a time [s] above 0 and its owner, in step 3",
    ),
    "masses": (
        "@hookimpl\ndef after_momentum_update(self, particles): particles.mass *= 2.0",
        "a plug-in changed the material points' masses or initial volumes",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BEFORE)
def test_a_plugin_that_fails_before_the_run_is_named(case, law):
    body, message = BEFORE[case]
    law(body)
    further = {"set": {"contact.oddity.a": 2.0}} if "validator" in case else {}
    with pytest.raises(SceneError) as caught:
        run(**further)
    assert message in str(caught.value)


@pytest.mark.parametrize("case", DURING)
def test_a_plugin_that_fails_in_the_run_is_named_and_what_was_written_stays(case, law, tmp_path):
    body, message = DURING[case]
    law(body)
    path = tmp_path / "run.nc"
    with pytest.raises(MpmfwError) as caught:
        run(output=path)
    assert message in str(caught.value)
    assert "not finite" in message or isinstance(caught.value, PluginError)
    with pytest.warns(ResultsWarning, match=r"run.nc is not complete: failed: .* it holds [0-3] outputs"):
        tree = mpmfw.open(path)
    assert tree.attrs["status"].startswith("failed: ")
    assert message in tree.attrs["status"]
    assert np.isfinite(tree["series/kinetic_energy"]).all() if "series/kinetic_energy" in tree else True


def test_no_plugin_that_exits_brings_down_the_others_of_a_comparison(law):
    law("@hookimpl\ndef end_step(self, state):\n    if state.time > 0.06: sys.exit(0)")
    scene = two_blocks("separate", time={"end": 0.1, "output_interval": 0.05}, output={"gap": False})
    dataset = mpmfw.compare(scene, ["oddity", "separate"], ["cpdi"])
    status = dataset.status.values.ravel()
    assert status[0].startswith(f"failed: {WHO} failed in end_step: SystemExit: 0")
    assert status[1] == "ok"


class Mute(NeoHookean):
    """Answers nothing."""

    name = "mute"

    def energy_density(self, deformation_gradient):  # noqa: ARG002
        return None


def test_a_material_that_answers_wrongly_is_named():
    scene = two_blocks("none", time__end=0.01, time__output_interval=0.005)
    for table in scene["materials"].values():
        table["model"] = f"{__name__}:Mute"
    with pytest.raises(MpmfwError, match=r"'mute' of .* failed in energy_of_points: ValueError: values"):
        mpmfw.run(scene)


def test_a_folder_that_is_changed_loses_no_file(law, tmp_path):
    law("@hookimpl\ndef end_step(self, state): os.chdir('/')")
    with pytest.warns(ResultsWarning, match="suspect"):  # nothing keeps its bodies apart
        assert run(output="run.nc").attrs["status"].startswith("suspect: left-right: penetration")
    assert mpmfw.open(tmp_path / "run.nc")["series"].sizes["time"] == 3
