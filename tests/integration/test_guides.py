"""The classes in the guide to methods of one's own pass the checks of their kinds, as they stand on the page."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

import mpmfw

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "guide"
#: Classes of a page, with a value for each option that has no default; a reference's example is no scene on the page.
PAGES = {
    "write-a-load": {"Wind": {"speed": "30 m/s"}},
    "write-an-output": {"Fastest": {}, "Shaken": {}},
    "write-a-measure": {"TopSpeed": {}},
    "write-a-geometry": {"Ellipse": {"semi_axes": (0.5, 0.25)}},
    "write-a-material": {"StVenantKirchhoff": {"bulk_modulus": 5e6, "shear_modulus": 3e6}},
    "write-a-detection": {"StifferLeads": {}, "Rate": {}},
}


@pytest.fixture
def module(request, tmp_path, monkeypatch):
    """The code of a page as a module, so that its classes can be sent to other processes."""
    page = request.param
    code = re.findall(
        r"^```python\n(.*?)^```", (GUIDE / f"{page}.md").read_text(encoding="utf-8"), re.S | re.M
    )
    name = page.replace("-", "_")
    (tmp_path / f"{name}.py").write_text("\n\n".join(code), encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    yield __import__(name)
    del sys.modules[name]


@pytest.mark.parametrize(("module", "classes"), PAGES.items(), ids=PAGES, indirect=["module"])
def test_classes_of_a_page_pass_their_checks(module, classes):
    for name, options in classes.items():
        mpmfw.check_plugin(getattr(module, name)(**options), pictures=None)


def test_every_class_of_the_guide_is_here():
    for page in GUIDE.glob("write-a*.md"):
        if page.stem not in ("write-a-contact-law", "write-a-shape-function"):
            found = re.findall(
                r"^class (\w+)\((?!BaseModel|Reference)", page.read_text(encoding="utf-8"), re.M
            )
            assert set(found) == set(PAGES.get(page.stem, {})), page
