"""Every variable of a results' file has its line in the glossary, with symbol, unit and sign."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mpmfw.effects.contact_moment import CONTACT_MOMENT
from mpmfw.effects.ledger import LEDGER_FIELDS
from mpmfw.effects.time_step_series import TIME_STEP_FIELDS
from mpmfw.state.fields import (
    AFFINE_ENERGY,
    CONTACT_SERIES,
    MIN_GAP,
    PARTICLE_FIELDS,
    SERIES_FIELDS,
    SURFACE_FIELDS,
)

GLOSSARY = Path(__file__).resolve().parents[2] / "docs" / "glossary.md"
FIELDS = (
    *PARTICLE_FIELDS,
    *SURFACE_FIELDS,
    *SERIES_FIELDS,
    AFFINE_ENERGY,
    *CONTACT_SERIES,
    MIN_GAP,
    CONTACT_MOMENT,
    *LEDGER_FIELDS,
    *TIME_STEP_FIELDS,
)


@pytest.mark.parametrize("name", sorted({field.name for field in FIELDS if field.output}))
def test_every_variable_of_a_file_is_in_the_glossary(name):
    first_columns = [
        line.split("|")[1] for line in GLOSSARY.read_text(encoding="utf-8").splitlines() if "|" in line
    ]
    assert name in re.findall(r"`(\w+)`", " ".join(first_columns))
