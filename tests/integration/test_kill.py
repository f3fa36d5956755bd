"""After a kill at any moment every frame that was written is readable, and none is older than a while that
was not.
"""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from mpmfw.results.reading import read as open_results
from mpmfw.results.writing import WRITTEN_EVERY

SERIES_FOR_EVER = """
import sys
import numpy as np
from mpmfw.state.fields import PARTICLE_FIELDS, SERIES_FIELDS
from mpmfw.results import Frame, RunHeader, RunWriter, writing

writing.WRITTEN_EVERY = float(sys.argv[2])
position, energy = PARTICLE_FIELDS[0], SERIES_FIELDS[5]
header = RunHeader(2, ("a",), (), {"a": 2000}, (position, energy))
with RunWriter(sys.argv[1], header) as writer:
    for k in range(1_000_000):
        particles = {"position": np.full((2000, 2), float(k))} if k % 100 == 0 else {}
        writer.write(Frame(0.1 * k, particles, series={energy.name: np.full(1, k)}))
        print(k + 1, flush=True)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this platform")
def test_synced_frames_survive(tmp_path):
    path = tmp_path / "run.nc"
    with subprocess.Popen(
        [sys.executable, "-c", SERIES_FOR_EVER, str(path), "0"], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        synced = next(int(line) for line in process.stdout if int(line) == 107)
        time.sleep(2e-3)
        process.send_signal(signal.SIGKILL)
        synced = max([synced, *(int(line) for line in process.stdout.read().split())])
    tree = open_results(path)
    frames = tree["series"].sizes["time"]
    assert frames in (synced, synced + 1)
    assert tree.attrs["status"] == "running"
    expected = np.arange(frames, dtype=float)
    np.testing.assert_array_equal(tree["series/kinetic_energy"][:, 0], expected)
    np.testing.assert_allclose(tree["series/time"], 0.1 * expected)
    np.testing.assert_array_equal(tree["particles/a/position"].values.min(axis=(1, 2)), expected[::100])
    np.testing.assert_array_equal(tree["particles/a/position"].values.max(axis=(1, 2)), expected[::100])


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this platform")
def test_a_kill_loses_the_frames_of_a_moment(tmp_path):
    path = tmp_path / "run.nc"
    command = [sys.executable, "-c", SERIES_FOR_EVER, str(path), str(WRITTEN_EVERY)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        started, written = 0.0, []
        for line in process.stdout:
            started = started or time.monotonic()  # Python and its imports have started
            written.append((time.monotonic() - started, int(line)))
            if written[-1][0] > 6 * WRITTEN_EVERY:
                break
        process.send_signal(signal.SIGKILL)
    frames = open_results(path)["series"].sizes["time"]
    safe = max(count for seconds, count in written if seconds < 4 * WRITTEN_EVERY)
    assert frames >= safe
