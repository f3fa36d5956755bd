"""The plain compiled loop in C++ that kernels are measured against."""

import ctypes
import functools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from mpmfw.state.fields import STEP_STAGES
from yardstick import block

FLAGS = ("-O3", "-march=native", "-std=c++17", "-shared", "-fPIC")
#: Stages of a step without contact.
STAGES = tuple(stage for stage in STEP_STAGES if stage != "contact")

_INTEGERS = ("n_particles", "n_nodes", "nodes_per_axis")
_NUMBERS = ("h", "dt", "flip", "bulk", "shear")
_ARRAYS = (
    *("position", "velocity", "mass", "initial_volume", "volume"),
    *("deformation", "velocity_gradient", "stress", "affine", "half_edges", "half_length"),
    *("nodes", "weight", "gradient"),
    *("node_position", "node_mass", "momentum", "start_velocity", "force", "node_velocity"),
)


class _Problem(ctypes.Structure):
    """``Problem`` of plain.cpp."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in _INTEGERS),
        *((name, ctypes.c_double) for name in _NUMBERS),
        *((name, ctypes.c_void_p) for name in _ARRAYS),
    )


@functools.cache
def compilers():
    """Paths of the C++ compilers: the one that ``CXX`` names, g++ and clang++, or whatever is called c++;
    empty without any.
    """
    named = os.environ.get("CXX")
    found = [shutil.which(name) for name in (*([named] if named else []), "g++", "clang++")]
    return tuple(dict.fromkeys(path for path in found if path)) or tuple(filter(None, [shutil.which("c++")]))


def compiler_version(path):
    """What a compiler says of itself, and the flags that it is given."""
    said = subprocess.run([path, "--version"], check=True, capture_output=True, text=True).stdout
    return f"{said.partition(chr(10))[0]} {' '.join(FLAGS[:2])}"


@functools.cache
def compiled_library(path):
    """The C++ loop, compiled once per process into a temporary folder; None where that is not possible."""
    source = Path(__file__).with_name("plain.cpp")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        target = Path(folder) / "plain.so"
        try:
            subprocess.run([path, *FLAGS, str(source), "-o", str(target)], check=True, capture_output=True)
            return ctypes.CDLL(str(target))
        except (OSError, subprocess.CalledProcessError):
            return None


#: Entries of a point along each axis in the plain loop, which gives every corner of a CPDI domain entries of
#: its own.
ENTRIES = {"linear": 2, "gimp": 3, "bspline": 3, "cpdi": 4}


def problem_of(block_, shape):
    """Copies of the block's arrays, and an empty table, as the plain loop wants them."""
    p, g = block_.state.particles, block_.state.grid
    n, dim = p.position.shape
    entries = ENTRIES[shape] ** dim
    if g.window_lower.any() or len(set(g.window_shape[0])) != 1:
        raise ValueError("the plain loop knows one cubic window at the grid's lower corner")
    return SimpleNamespace(
        n_particles=n,
        n_nodes=len(g.mass),
        nodes_per_axis=int(g.window_shape[0, 0]),
        h=g.cell_size,
        dt=block.DT,
        flip=block_.transfer.flip,
        bulk=block.BULK,
        shear=block.SHEAR,
        position=p.position.copy(),
        velocity=p.velocity.copy(),
        mass=p.mass.copy(),
        initial_volume=p.initial_volume.copy(),
        volume=p.volume.copy(),
        deformation=p.deformation_gradient.copy(),
        velocity_gradient=p.velocity_gradient.copy(),
        stress=p.stress.copy(),
        affine=np.zeros((n, dim, dim)) if p.affine is None else p.affine.copy(),
        half_edges=block_.half_edges.copy(),
        half_length=0.5 * p.initial_volume ** (1.0 / dim),
        nodes=np.zeros(n * entries, dtype=np.int32),
        weight=np.zeros(n * entries),
        gradient=np.zeros((n * entries, dim)),
        node_position=g.position.copy(),
        node_mass=np.zeros_like(g.mass),
        momentum=np.zeros_like(g.momentum),
        start_velocity=np.zeros_like(g.momentum),
        force=np.zeros_like(g.momentum),
        node_velocity=np.zeros_like(g.momentum),
    )


class PlainLoop:
    """The plain loop of a shape function on a copy of a block, by the C++ compiler of this path.

    Raises
    ------
    NotImplementedError
        The compiler cannot make a library that can be loaded.
    """

    def __init__(self, shape, block_, *, compiler):
        dim = block_.state.particles.dim
        self.problem = problem_of(block_, shape)
        library = compiled_library(compiler)
        if library is None:
            raise NotImplementedError(f"{compiler} makes no library of the plain loop")
        self.language = Path(compiler).name
        call = _foreign_calls(library, f"{shape}_{dim}", self.problem)
        #: A call for each of :data:`STAGES`, with an interpolation table; and that of a step without one.
        self.stages: dict[str, Callable[[], object]] = {stage: call(stage) for stage in STAGES}
        self.whole: Callable[[], object] = call("step")

    def step(self):
        """Take a step stage by stage."""
        for stage in STAGES:
            self.stages[stage]()


def _foreign_calls(library, prefix, problem):
    """The library's functions by the end of their name, bound to a problem whose arrays they read and write
    in place.
    """
    numbers = [getattr(problem, name) for name in (*_INTEGERS, *_NUMBERS)]
    pointers = [getattr(problem, name).ctypes.data for name in _ARRAYS]
    struct = _Problem(*numbers, *pointers)
    argument = ctypes.byref(struct)
    return lambda name: functools.partial(getattr(library, f"{prefix}_{name}"), argument)
