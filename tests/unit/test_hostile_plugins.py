"""Plug-ins that fail or misbehave are named: plug-in, distribution, place and step; what was written stays."""

import importlib
import json
import os
import re
import sys
import textwrap

import numpy as np
import pytest

import mpmfw
from mpmfw.api import ContactStrategy
from mpmfw.contact.joined import joined
from mpmfw.errors import MpmfwError, PluginError, ResultsWarning, SceneError
from mpmfw.plugin.blame import bundled, described
from mpmfw.report import write_report
from mpmfw.results.reading import read
from mpmfw.results.writing import WRITTEN_EVERY
from mpmfw_contact.impulse import Impulse
from mpmfw_contact.nodes import Nodes
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
def install(tmp_path, monkeypatch):
    """Make the distribution ``strange`` with a contact plug-in ``oddity``; returns nothing."""

    def make(body, head=HEAD):
        folder = tmp_path / "site"
        info = folder / "strange-1.0.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: strange\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text("[mpmfw.contact]\noddity = strange_law:Law\n")
        (folder / "strange_law.py").write_text(head + textwrap.indent(textwrap.dedent(body), "    "))
        monkeypatch.syspath_prepend(str(folder))
        monkeypatch.setattr(sys, "dont_write_bytecode", True)
        monkeypatch.delitem(sys.modules, "strange_law", raising=False)

    monkeypatch.chdir(tmp_path)
    return make


def run(**further):
    scene = two_blocks(
        "oddity", time={"end": 0.1, "output_interval": 0.05}, output={"gap": False, "particles": False}
    )
    return mpmfw.run(scene, **further)


WHO = "plug-in 'oddity' of distribution strange"
OWNED = "the material points' masses, initial volumes, positions or velocities"

#: Body of the class, the error, its message.
BEFORE = {
    "exit in the constructor": (
        "def __init__(self): sys.exit(0)",
        f"contact {WHO} cannot be made from the scene's options: SystemExit: 0 (strange_law.py, line 9)",
    ),
    "error in the constructor": (
        "def __init__(self): {}['k']",
        f"contact {WHO} cannot be made from the scene's options: KeyError: 'k'",
    ),
    "error in a validator": (
        """
        class Options(BaseModel):
            a: float = 1.0
            @field_validator("a")
            @classmethod
            def check(cls, value): return {}[value]
        """,
        "contact.oddity: Options of plug-in 'oddity' of distribution strange cannot judge them: KeyError: 2.0",
    ),
    "options that are no model": (
        "Options = dict",
        "contact.oddity: Options of plug-in 'oddity' of distribution strange: expected a pydantic model, found <class",
    ),
    "exit in setup": (
        "@hookimpl\ndef setup(self, setup): sys.exit(0)",
        f"{WHO} failed in setup: SystemExit: 0 (strange_law.py, line 10)",
    ),
    "error in declare_fields": ("@hookimpl\ndef declare_fields(self): 1 / 0", f"{WHO} failed in declare_fields: ZeroDivision"),
    "error in reach": ("def reach(self, cell_size): 1 / 0", f"{WHO} failed in reach: ZeroDivisionError"),
    "error in parts": ("def parts(self): raise BaseException('no')", f"{WHO} failed in parts: BaseException: no"),
    "no list of fields": (
        "@hookimpl\ndef declare_fields(self): return 'x'",
        f"{WHO} answered declare_fields with 'x'; expected a list of mpmfw.api.Field",
    ),
    "a field of no group": (
        "@hookimpl\ndef declare_fields(self): return [Field('a', (), '1', 'a', 'nowhere')]",
        f"{WHO} declares a field 'a'; expected one that has one of the groups particles, grid, surface",
    ),
    "a field of objects": (
        "@hookimpl\ndef declare_fields(self): return [Field('a', (), '1', 'a', 'series', 'O')]",
        f"{WHO} declares a field 'a'; expected one that has a NumPy type of numbers, not 'O'",
    ),
    "a field of the core's": (
        "@hookimpl\ndef declare_fields(self): return [Field('mass', ('particle',), 'kg m-1', 'mass')]",
        f"{WHO} declares a field 'mass'; expected one that does not take the place of the core's own particles/mass",
    ),
    "a series of another plug-in": (
        "@hookimpl\ndef declare_fields(self): return [Field('kinetic_energy', ('body',), 'J', 'e', 'series')]",
        "both declare a field 'kinetic_energy'; expected another name for one of them",
    ),
    "the name of another plug-in": (
        "def parts(self):\n    class Part:\n        name = 'cpdi'\n    return [Part()]",
        "have one name; expected another for one of them",
    ),
    "a limit that is no number": (
        "@hookimpl\ndef stable_timestep(self, state): return (float('nan'), 'law')",
        f"{WHO} answered stable_timestep with (nan, 'law'); expected a time in seconds above 0 and its owner, or None",
    ),
    "a limit that is text": (
        "@hookimpl\ndef stable_timestep(self, state): return 'soon'",
        f"{WHO} answered stable_timestep with 'soon'; expected a time",
    ),
}  # fmt: skip

DURING = {
    "exit in a hook": (
        "@hookimpl\ndef add_nodal_force(self, grid, state): sys.exit(0)",
        f"{WHO} failed in add_nodal_force: SystemExit: 0 (strange_law.py, line 10), in step 1: at time 0 s",
    ),
    "error in a hook": (
        "@hookimpl\ndef end_step(self, state): state.steps > 2 and {}['k']",
        f"{WHO} failed in end_step: KeyError: 'k' (strange_law.py, line 10), in step 4: at time",
    ),
    "error in diagnostics": (
        "@hookimpl\ndef diagnostics(self, state): raise ValueError('no')",
        f"{WHO} failed in diagnostics: ValueError: no",
    ),
    "error in concerns": ("@hookimpl\ndef concerns(self): raise ValueError('no')", f"{WHO} failed in concerns: ValueError: no"),
    "concerns that are no list": ("@hookimpl\ndef concerns(self): return 'no'", f"{WHO} answered concerns with 'no'; expected"),
    "undeclared diagnostics": (
        "@hookimpl\ndef diagnostics(self, state): return {'a': 1.0}",
        f"{WHO} answered diagnostics with 'a', which nobody declared in declare_fields",
    ),
    "diagnostics that are no table": (
        "@hookimpl\ndef diagnostics(self, state): return [1.0]",
        f"{WHO} answered diagnostics with [1.0]; expected a dict of arrays by name",
    ),
    "diagnostics of text": (
        "@hookimpl\ndef declare_fields(self): return [Field('a', (), '1', 'a', 'series', output=True)]\n"
        "@hookimpl\ndef diagnostics(self, state): return {'a': 'x'}",
        f"{WHO} answered diagnostics with 'x' for 'a'; expected numbers",
    ),
    "diagnostics of another shape": (
        "@hookimpl\ndef declare_fields(self): return [Field('a', (), '1', 'a', 'series', output=True)]\n"
        "@hookimpl\ndef diagnostics(self, state): return {'a': [1.0, 2.0]}",
        f"{WHO} answered diagnostics with an array of shape (2,) for 'a'; expected the dims () that it declared",
    ),
    "diagnostics that are not finite": (
        "@hookimpl\ndef declare_fields(self): return [Field('a', (), '1', 'a', 'series', output=True)]\n"
        "@hookimpl\ndef diagnostics(self, state): return {'a': np.nan}",
        f"series/a of {WHO} is not finite: at time 0 s",
    ),
    "a limit that becomes NaN": (
        "@hookimpl\ndef stable_timestep(self, state): return (np.nan if state.steps > 1 else 1.0, 'law')",
        f"{WHO} answered stable_timestep with (nan, 'law'); expected a time in seconds above 0 and its owner, or None, in step 3",
    ),
    "masses": (
        "@hookimpl\ndef after_momentum_update(self, particles): particles.mass *= 2.0",
        f"{WHO} changed {OWNED} in its hook after_momentum_update, which belong to the step",
    ),
    "positions": (
        "@hookimpl\ndef end_step(self, state): state.particles.position[0, 0] += 1e-9",
        f"{WHO} changed {OWNED} in its hook end_step",
    ),
    "positions once": (
        "@hookimpl\ndef end_step(self, state):\n    if state.steps == 3: state.particles.position[0, 0] += 1e-9",
        f"{WHO} changed {OWNED} in its hook end_step, which belong to the step; docs/hooks.md says what each hook may change, "
        "in step 4: at time",
    ),
    "positions before a hook": (
        "@hookimpl(wrapper=True)\ndef end_step(self, state):\n    state.particles.position[0, 0] += 1e-9\n    return (yield)",
        f"{WHO} changed {OWNED} in its hook end_step",
    ),
    "positions after a hook": (
        "@hookimpl(wrapper=True)\ndef end_step(self, state):\n    result = yield\n    state.particles.position[0, 0] += 1e-9\n"
        "    return result",
        f"{WHO} changed {OWNED} in its hook end_step",
    ),
    "the clock after a hook": (
        "@hookimpl(wrapper=True)\ndef end_step(self, state):\n    result = yield\n    state.steps += 1\n    return result",
        f"{WHO} changed the clock (state.steps) in its hook end_step",
    ),
    "positions by a kernel": (
        "import numba\n@staticmethod\n@numba.njit\ndef shift(position): position[0, 0] += 1e-9\n"
        "@hookimpl\ndef end_step(self, state): self.shift(state.particles.position)",
        f"{WHO} changed {OWNED} in its hook end_step",
    ),
    "other positions": (
        "@hookimpl\ndef end_step(self, state): state.particles.position = state.particles.position.copy()",
        f"{WHO} changed the material points' positions in its hook end_step",
    ),
    "the clock": (
        "@hookimpl\ndef add_nodal_force(self, state): state.time = 0.0 if state.time else 1.0",
        f"{WHO} changed the clock (state.time) in its hook add_nodal_force",
    ),
    "the clock once": (
        "@hookimpl\ndef add_nodal_force(self, state):\n    if state.steps == 3: state.steps = 7",
        f"{WHO} changed the clock (state.steps) in its hook add_nodal_force",
    ),
    "masses by a view from before": (
        "@hookimpl\ndef setup(self, setup): self.mass = setup.state.particles.mass[:]\n"
        "@hookimpl\ndef end_step(self, state):\n    if state.steps == 3: self.mass *= 2.0",
        f"{WHO} changed the material points' masses since the last output",
    ),
}  # fmt: skip


@pytest.mark.parametrize("strange", ["detection", "law"])
def test_a_part_of_a_joined_contact_is_its_own_distribution_s(strange, install):
    install(
        "pass",
        head="from mpmfw.api import ContactStrategy\n"
        "from mpmfw_contact.impulse import Impulse\nfrom mpmfw_contact.nodes import Nodes\n"
        "class StrangeNodes(Nodes):\n    name = 'mine'\nclass StrangeImpulse(Impulse):\n    name = 'mine'\n"
        "class Law(ContactStrategy):\n",
    )
    module = importlib.import_module("strange_law")
    parts = {"detection": (module.StrangeNodes, Impulse), "law": (Nodes, module.StrangeImpulse)}
    contact = joined(*parts[strange])()
    assert not bundled(type(contact))
    assert described(contact).endswith("of distribution strange")


@pytest.mark.parametrize("case", BEFORE)
def test_a_plugin_that_fails_before_the_run_is_named(case, install):
    body, message = BEFORE[case]
    install(body)
    further = {"set": {"contact.oddity.a": 2.0}} if "validator" in case else {}
    with pytest.raises(SceneError) as caught:
        run(**further)
    assert message in str(caught.value)


@pytest.mark.parametrize("case", DURING)
def test_a_plugin_that_fails_in_the_run_is_named_and_what_was_written_stays(case, install, tmp_path):
    body, message = DURING[case]
    install(body)
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


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("import sys\nsys.exit(0)\n", "cannot be imported from strange_law:Law: SystemExit: 0"),
        ("raise BaseException('no')\n", "cannot be imported from strange_law:Law: BaseException: no"),
        (
            "import os\nos.chdir('/')\nraise KeyError('k')\n",
            "cannot be imported from strange_law:Law: KeyError: 'k'",
        ),
        ("class Law:\n    name = 'oddity'\n", "expected a class derived from mpmfw.api.ContactStrategy"),
        (
            "from mpmfw.api import ShapeFunction\nclass Law(ShapeFunction):\n    name = 'oddity'\n",
            "expected a class derived from mpmfw.api.ContactStrategy",
        ),
    ],
)
def test_a_module_that_fails_is_named(head, message, install, tmp_path):
    install("", head=head)
    with pytest.raises(SceneError) as caught:
        run()
    assert message in str(caught.value)
    assert "of distribution strange" in str(caught.value)
    assert os.getcwd() == str(tmp_path)


def test_a_folder_that_is_changed_loses_no_file(install, tmp_path):
    install("@hookimpl\ndef end_step(self, state): os.chdir('/')")
    with pytest.warns(ResultsWarning, match="suspect"):  # nothing keeps its bodies apart
        assert run(output="run.nc").attrs["status"].startswith("suspect: left-right: penetration")
    assert mpmfw.open(tmp_path / "run.nc")["series"].sizes["time"] == 3


@pytest.mark.parametrize(
    ("does", "message"),
    [
        ("sys.exit(0)", f"failed: {WHO} failed in end_step: SystemExit: 0"),
        ("os.kill(os.getpid(), 11)", "failed: its process ended: SIGSEGV"),
        ("os._exit(0)", "failed: its process ended: exit status 0"),
        ("import time; time.sleep(1000)", "failed: its process did nothing for 15 s, and was ended"),
    ],
)
def test_no_plugin_brings_down_the_others_of_a_comparison(does, message, install, monkeypatch):
    if "sleep" in does:
        monkeypatch.setattr("mpmfw.runs.own_process.PATIENCE", 15.0)
    # What waits to be written is in the file a moment later
    install(
        "@hookimpl\ndef end_step(self, state):\n    import time\n"
        f"    if state.time > 0.05: time.sleep({2 * WRITTEN_EVERY})\n    if state.time > 0.06: {does}"
    )
    scene = two_blocks("separate", time={"end": 0.1, "output_interval": 0.05}, output={"gap": False})
    dataset = mpmfw.compare(scene, ["oddity", "separate"], ["cpdi"])
    status = dataset.status.values.ravel()
    assert status[0].startswith(message)
    assert status[1] == "ok"
    # What it wrote before is there; on a busy machine one that is given 15 s may not have got so far
    assert "sleep" in does or np.isfinite(dataset.kinetic_energy.sel(contact="oddity").isel(time=1)).all()


def test_no_plugin_brings_down_a_study(install):
    install("@hookimpl\ndef end_step(self, state): os._exit(0)")
    scene = two_blocks("separate", time={"end": 0.1, "output_interval": 0.05}, output={"gap": False})
    study = {"scene": scene, "vary": {"contact": ["oddity", "separate"]}, "cost": {"repeats": 1}}
    error = {"quantity": "end-displacement", "kind": "reference", "value": 1.0}
    status = mpmfw.study({**study, "error": error}, jobs=1).status.values.tolist()
    assert status == ["failed: its process ended: exit status 0", "ok"]


class Named(ContactStrategy):
    """A strategy whose label is what its author wrote, or an attacker."""

    name = "named"

    def __init__(self, label):
        super().__init__()
        self._label = label

    @property
    def label(self):
        return self._label


def test_labels_are_text_and_nothing_else_in_pages_and_figures(tmp_path):
    labels = [
        "<script>alert(1)</script>",
        "</svg><img src=x onerror=alert(1)>",
        "$\\bad{$ & \"'",
        "a\x1b[2Jb",
    ]
    scene = two_blocks(
        "none", time={"end": 0.002, "output_interval": 0.001}, title="</title><script>$\\bad{$</script>"
    )
    dataset = mpmfw.compare(scene, [Named(label) for label in labels], ["linear"])
    assert (dataset.status == "ok").all()
    write_report(dataset, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    tags = set(re.findall(r"<\s*/?\s*([a-zA-Z]+)", page))
    assert not tags & {"script", "img"}
    assert "&lt;script&gt;alert(1)" in page
    assert "\x1b" not in page


def test_a_run_apart_is_the_same_run(tmp_path):
    scene = two_blocks("separate", time={"end": 0.01, "output_interval": 0.005}, output={"gap": False})
    here, there = mpmfw.run(scene), mpmfw.run(scene, apart=True, output=tmp_path / "run.nc")
    assert there.attrs["status"] == "ok"
    np.testing.assert_array_equal(here["series/kinetic_energy"], there["series/kinetic_energy"])
    with pytest.raises(SceneError, match=r"bodies\.left\.velocity: has 3 entries"):
        mpmfw.run(scene, apart=True, set={"bodies.left.velocity": [0, 0, 0]})


def test_a_run_that_fails_keeps_its_other_concerns(install, tmp_path):
    install(
        "@hookimpl\ndef end_step(self, state): state.steps > 2 and {}['k']\n"
        "@hookimpl\ndef concerns(self): return ['beware']"
    )
    with pytest.raises(PluginError):
        run(output=tmp_path / "run.nc")
    assert json.loads(read(tmp_path / "run.nc").attrs["warnings"]) == ["beware"]
