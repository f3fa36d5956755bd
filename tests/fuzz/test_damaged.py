"""Damaged and crafted checkpoints, results and stores do no harm, and end well or in one message."""

import os
import shutil

import pytest
from damaged import make, read_apart

#: How many: ``MPMFW_DAMAGED=1000`` is the long form.
COUNT = int(os.environ.get("MPMFW_DAMAGED", "10"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this platform")
@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning", "ignore::DeprecationWarning")
def test_no_damaged_file_does_harm(tmp_path):
    sound = tmp_path / "sound"
    sound.mkdir()
    make(sound)
    wrong = []
    for number in range(COUNT):
        what, outcome, said = read_apart(number, sound, tmp_path / str(number))
        shutil.rmtree(tmp_path / str(number))
        if outcome not in ("ok", "message"):
            wrong.append(f"{number} ({what}): {outcome}: {said}")
    assert not wrong, "\n".join(wrong)
