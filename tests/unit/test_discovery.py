"""Plug-ins are found by entry points, imported one at a time, and misspelt names get the nearest one."""

import subprocess
import sys

import pytest

from mpmfw.discovery import available, load
from mpmfw.errors import SceneError


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Make a distribution: its entry points of one kind, and the source of its only module."""

    def make(distribution, entries, source="", kind="contact"):
        folder = tmp_path / distribution
        info = folder / f"{distribution}-1.0.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
        lines = [f"{name} = {target}" for name, target in entries.items()]
        (info / "entry_points.txt").write_text("\n".join([f"[mpmfw.{kind}]", *lines]) + "\n")
        (folder / f"{distribution}.py").write_text(source)
        monkeypatch.syspath_prepend(str(folder))

    return make


def test_a_strangers_plugin_is_found_and_loaded(install):
    install("spring_law", {"spring": "spring_law:Spring"}, "class Spring:\n    'A law.'\n")
    assert available("contact")["spring"].dist.name == "spring_law"
    assert load("contact", "spring").__doc__ == "A law."
    assert "spring" not in available("shape")


def test_finding_imports_nothing_and_loading_imports_one(install):
    install("first_law", {"first": "first_law:Law"}, "class Law: pass\n")
    install("second_law", {"second": "second_law:Law"}, "class Law: pass\n")
    assert {"first", "second"} <= set(available("contact"))
    assert "first_law" not in sys.modules
    load("contact", "second")
    assert "first_law" not in sys.modules
    assert "second_law" in sys.modules


def test_discovery_itself_imports_no_plugin():
    code = (
        "import mpmfw.discovery as discovery, sys; discovery.available('shape'); "
        "print([name for name in sys.modules if 'mpmfw_' in name])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_an_unknown_name_gets_the_nearest_and_the_list(install):
    install("spring_law", {"spring": "spring_law:Spring"})
    with pytest.raises(
        SceneError, match=r"unknown contact plug-in 'sprnig'; did you mean 'spring'\? \(one of .*penalty"
    ):
        load("contact", "sprnig")


@pytest.mark.parametrize(
    ("source", "cause"),
    [
        ("import no_such_module_here\n", "ModuleNotFoundError: No module named 'no_such_module_here'"),
        ("1 / 0\n", "ZeroDivisionError: division by zero"),
        ("", "AttributeError"),
        ("Law = 3\n", "is not a class"),
    ],
)
def test_a_broken_plugin_names_its_distribution_and_the_cause(install, source, cause, request):
    distribution = f"broken_{request.node.callspec.indices['source']}"
    install(distribution, {"broken": f"{distribution}:Law"}, source)
    with pytest.raises(SceneError, match=f"'broken' of distribution {distribution}.*{cause}"):
        load("contact", "broken")


def test_two_distributions_with_one_name_are_both_named(install):
    install("one_law", {"twice": "one_law:Law"})
    install("other_law", {"twice": "other_law:Law"})
    with pytest.raises(SceneError, match=r"'twice': o[a-z]*_law .* and o[a-z]*_law .*uninstall"):
        available("contact")
