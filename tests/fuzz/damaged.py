"""Files that a stranger has damaged or crafted, each from a number, and reading one in a watched process.

Reading may end well or with one message: no import of what was not imported, no other process, no file
written elsewhere, at most 1 GB, and no hanging."""

import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

import numpy as np

import mpmfw
from checkpoints_for_tests import opened, write
from mpmfw.errors import Interrupted, MpmfwError
from scenes_for_tests import two_blocks

#: Bytes that reading a file may take, and seconds after which it hangs; the machine may have other work.
MEMORY, SECONDS = 1e9, 60

#: Values that stand for others in what a file says.
_VALUES = (
    0, 1, -1, 2**31, 2**63, 10**400, 1e308, float("nan"), float("inf"), True, None, "", "x", "os:system",
    "__import__('os')", "../../pwned", [], [1], {}, {"a": 1}, {"__class__": "subprocess.Popen"},
    ["builtins:eval"] * 3,
)  # fmt: skip
_REMOVES = ("os.remove", "os.rename", "os.rmdir", "shutil.rmtree")
_NAMES = ("x", "a/b", "state/time", "time2", "body2")
_TEXTS = ("../../x", "", "/", "a/b", "a" * 5000, "\x1b[2J", "[", "{}")
_NUMBERS = {"f": (np.nan, np.inf, 1e300, -1e300, 0.0), "i": (-1, -2, 0, 7, 10**6, 2**30)}

SCENE = two_blocks(
    "penalty",
    time={"end": 0.02, "output_interval": 0.002},
    shape__method="linear",
    output={"particles": True, "surface": True, "ledger": True, "stability": True},
)
#: What reads results of a run and of a comparison.
READERS = {
    "open": lambda path, _: mpmfw.open(path),
    "field": lambda path, _: mpmfw.plots.field(path),
    "gap": lambda path, _: mpmfw.gap(path),
    "animate": lambda path, folder: mpmfw.animate(path, folder / "f.gif"),
    "export": lambda path, folder: mpmfw.export(path, folder / "out"),
}
OF_COMPARISONS = ("open", "gap")


def compare(folder):
    """Compare, with the finished runs in the folder."""
    return mpmfw.compare(SCENE, ["penalty", "none"], ["linear"], output=folder / "compare.nc")


def make(folder):
    """Write sound files: a stopped run with its checkpoint, one that ended, a comparison with its store."""

    def stop(time, steps):  # noqa: ARG001
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        mpmfw.run(SCENE, output=folder / "stopped.nc", progress=stop, set={"time.step": 2e-4})
    except Interrupted:
        pass
    finally:
        signal.signal(signal.SIGINT, before)
    assert (folder / "stopped.nc.checkpoint").is_file()
    mpmfw.run(SCENE, output=folder / "run.nc")
    compare(folder)
    with tempfile.TemporaryDirectory() as beside:
        for name, reads in READERS.items():  # what is imported on the way is not a file's doing
            for kind in ("run", "compare")[: 1 + (name in OF_COMPARISONS)]:
                reads(folder / f"{kind}.nc", Path(beside))


def _bytes(draw, path):
    """Flip bits, overwrite, cut or take out stretches."""
    changed = bytearray(path.read_bytes())
    for _ in range(draw.choice((1, 1, 2, 8, 64))):
        at, length = draw.randrange(len(changed) or 1), draw.choice((1, 4, 8, 100))
        stretch = slice(at, at + length)
        size = len(changed[stretch])
        flipped = bytes(byte ^ 1 << draw.randrange(8) for byte in changed[stretch][:1])
        ways = (flipped + changed[stretch][1:], bytes(size), b"\xff" * size, draw.randbytes(size), b"")
        changed[stretch] = draw.choice(ways)
    path.write_bytes(changed[: draw.choice((None, None, None, len(changed) // 2))])


def _elsewhere(draw, tree):
    """Replace, drop or rename one value somewhere in nested lists and tables."""
    keys = list(tree) if isinstance(tree, dict) else list(range(len(tree)))
    if not keys:
        return
    key = draw.choice(keys)
    if isinstance(tree[key], dict | list) and tree[key] and draw.random() < 0.8:
        _elsewhere(draw, tree[key])
    elif draw.random() < 0.1 and isinstance(tree, dict):
        tree[draw.choice(_NAMES)] = tree.pop(key)
    elif draw.random() < 0.1:
        del tree[key]
    else:
        tree[key] = draw.choice(_VALUES)


def _checkpoint(draw, path):
    """Change facts, places or numbers of a checkpoint, such that its checksums are right."""
    facts, arrays = opened(path)
    for _ in range(draw.choice((1, 1, 2, 5))):
        way, place = draw.randrange(4), draw.choice([key for key in arrays if key != "results.nc"])
        if way == 0:
            arrays[draw.choice(_NAMES)] = arrays.pop(place)
        elif way == 1:
            _elsewhere(draw, facts)
        else:
            values = arrays[place].copy()
            kind = draw.choice("fi")
            some = values.reshape(-1).view("u1")
            some = some[: len(some) // 8 * 8].view(f"<{kind}8")
            if len(some):
                some[draw.randrange(len(some))] = draw.choice((*_NUMBERS[kind], -(2**63), 2**62))
            arrays[place] = values if draw.random() < 0.8 else values.reshape(-1)
    write(path, facts, **arrays)


def _results(draw, path):
    """Change a name, an attribute or a number of a results' file by the library that wrote it."""
    import netCDF4

    try:
        opened_file = netCDF4.Dataset(path, "a")
    except OSError:  # a file that was made in memory
        return _bytes(draw, path)
    with opened_file as dataset:
        group = draw.choice([dataset, *dataset.groups.values()])
        names, attributes = sorted(group.variables), sorted(group.ncattrs())
        way = draw.randrange(3)
        if way == 0 and attributes:
            group.setncattr(draw.choice(attributes), draw.choice((*_TEXTS, 7, -1.0)))
        elif way == 1 and names:
            group.renameVariable(draw.choice(names), draw.choice(_NAMES[-2:]))
        elif names:
            variable = group.variables[draw.choice(names)]
            variable.set_auto_maskandscale(False)
            if all(variable.shape):
                at = tuple(draw.randrange(n) for n in variable.shape)
                variable[at] = draw.choice(_TEXTS if variable.dtype is str else _NUMBERS["i"])
    return None


def _store(draw, path):
    """Change what an outcome in a store says."""
    fields = json.loads(path.read_bytes())
    for _ in range(draw.choice((1, 1, 2, 5))):
        _elsewhere(draw, fields)
    path.write_text(draw.choice((json.dumps(fields), json.dumps(fields), "[" * 10**5)))


def case(number, sound, folder):
    """Damage a copy of the sound files in a folder; what was damaged, and what reads it."""
    draw = random.Random(f"mpmfw damaged {number}")
    shutil.copytree(sound, folder, dirs_exist_ok=True)
    stores = sorted((folder / "compare.nc.runs").glob("*.json" if number % 2 else "*.*"))
    what, path, craft = (
        ("checkpoint", folder / "stopped.nc.checkpoint", _checkpoint),
        ("results", folder / "stopped.nc", _results),
        ("run", folder / "run.nc", _results),
        ("compare", folder / "compare.nc", _results),
        ("store", draw.choice(stores), _store),
    )[number % 5]
    is_crafted = draw.random() > 0.3 and not (what == "store" and path.suffix != ".json")
    (craft if is_crafted else _bytes)(draw, path)
    if what in ("checkpoint", "results"):
        return what, lambda: mpmfw.resume(folder / "stopped.nc")
    if what == "store":
        return what, lambda: compare(folder)
    name = draw.choice(OF_COMPARISONS if what == "compare" else list(READERS))
    return f"{what} {name}", lambda: READERS[name](path, folder)


def read_apart(number, sound, folder):
    """Damage and read one file in a child of this process; what it was, ``ok`` or what is wrong, and why."""
    what, reads = case(number, sound, folder)
    inlet, outlet = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(inlet)
        try:
            signal.alarm(SECONDS)
            with os.fdopen(outlet, "w", errors="replace") as pipe:
                json.dump(_watched(reads, folder), pipe)
        finally:
            os._exit(0)
    os.close(outlet)
    with os.fdopen(inlet) as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    if not text:
        return what, "crashes", f"the process ended without a word, or took {SECONDS} s"
    return what, *json.loads(text)


def _watched(reads, folder):
    """Outcome and message of reading, or what it must not do."""
    seen = []
    known = {name.partition(".")[0] for name in sys.modules} | set(sys.stdlib_module_names)
    caches = filter(None, (os.environ.get("NUMBA_CACHE_DIR"),))
    mine = (str(folder), *caches, f"{os.sep}kernels{os.sep}", "/proc/self/clear_refs")

    def audit(event, given):
        if event == "import" and given[0].partition(".")[0] not in known:
            seen.append(f"import {given[0]}")
        elif event == "subprocess.Popen" and given[0] not in ("uname", "git"):  # machine and version
            seen.append(f"{event} {given[:2]}")
        elif event in ("os.system", "os.exec", "os.posix_spawn", "os.fork", "socket.connect"):
            seen.append(event)
        elif event == "open" and isinstance(given[0], str) and isinstance(given[2], int):
            writes = given[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
            if writes and not any(one in os.path.abspath(given[0]) for one in mine):
                seen.append(f"open {given[0]}")
        elif event in _REMOVES and str(folder) not in os.path.abspath(given[0]):
            seen.append(f"{event} {given[0]}")

    os.chdir(folder)
    tempfile.tempdir = str(folder)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    sys.addaudithook(audit)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            reads()
        outcome, said = "ok", ""
    except MpmfwError as error:
        outcome, said = "message", str(error)
    except BaseException:
        outcome, said = "traceback", traceback.format_exc()
    used = 1024.0 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    if seen:
        return "harm", f"{seen} {said}"
    return ("memory", f"{used:.2g} bytes") if used > MEMORY else (outcome, said)
