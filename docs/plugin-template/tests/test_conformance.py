"""What every contact law must keep, asked by mpmfw's conformance kit."""

from __future__ import annotations

import tomllib
from pathlib import Path

from mpmfw_surface_impulse import SurfaceImpulse

from mpmfw.testing import contact_conformance

KNOWN = tomllib.loads((Path(__file__).parent / "expected_failures.toml").read_text())


@contact_conformance(SurfaceImpulse, expected_failures=KNOWN)
def test_conformance(check):
    check()
