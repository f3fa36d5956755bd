"""Base class of adapters to other codes, and the codes that a request names."""

from __future__ import annotations

import io
import json
import math
import os
import shutil
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from mpmfw.codes.outputs import MotionOutputs, RunCost, printable, results_of
from mpmfw.codes.process import LARGEST, ProcessLimits, run_process
from mpmfw.errors import MpmfwError, SceneError, SceneProblem
from mpmfw.geometry import Layout, Particles, discretise
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.discovery import load
from mpmfw.results.references import at_rest
from mpmfw.scene import load_scene
from mpmfw.scene.bodies import RigidBody
from mpmfw.scene.specification import checked_specification
from mpmfw.state.fields import AnyArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.scene import Scene

#: Files that every adapter has in its folder.
SCENE, COST, LOG = "scene.toml", "cost.json", "log.txt"

#: Axis and end of a side.
SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1), "back": (2, 0), "front": (2, 1)}

#: Tables of a scene that are refused, unless ``reads`` has them.
_OPTIONAL = ("gravity", "loads", "boundaries", "settle", "sleep", "outputs")

#: Largest files that are read, by their ending [B]; of others LARGEST.
_LARGEST = {".json": 2**24, ".toml": 2**24}


class Code(PlugIn):
    """Base of adapters, announced under ``mpmfw.code``.

    A code runs in an empty folder: :meth:`prepare` writes its input, :meth:`run` starts its process and
    :meth:`read` returns its results as those of a run. A folder can be kept, and read where the code is not
    installed. Subclasses implement :meth:`refusals`, :meth:`write`, :meth:`command` and :meth:`outputs`.
    The program is that of the environment's variable ``MPMFW_CODE_NAME``, if it is set; a scene never
    names it.
    """

    title: ClassVar[str]  #: what tables call the code
    install: ClassVar[str]  #: command that installs it
    executable: ClassVar[str] = ""  #: name of its program on the path
    #: options of its best settings, which run beside the plainest where no options are named
    best: ClassVar[Mapping[str, Any]] = {}
    #: what it reads of gravity, loads, boundaries, settle, sleep and outputs, "motion" of rigid bodies,
    #: "spin" at the start, and "start" for one that is not at rest after settling
    reads: ClassVar[frozenset[str]] = frozenset()
    models: ClassVar[tuple[str, ...]] = ("neo_hookean", "linear_elastic")  #: materials that it writes
    versions: ClassVar[tuple[str, ...]] = ()  #: with which the adapter was measured
    limits: ClassVar[ProcessLimits] = ProcessLimits()
    runs_elsewhere: ClassVar[bool] = False  #: it is not started here, so that its costs are not known
    #: program and version that were found, which the keys of stored runs contain
    installed: str = ""

    @property
    def label(self) -> str:
        """Title and the options that were set."""
        return self.title + super().label.removeprefix(self.name)

    def refusals(self, scene: Scene) -> Iterator[tuple[str, str]]:
        """Yield key and reason of everything in a scene that the code cannot do."""
        raise NotImplementedError

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the code's input to a folder."""
        raise NotImplementedError

    def program(self) -> str | None:
        """Return the path of the code's program, ``executable``, or None if it is not installed."""
        return shutil.which(self.executable)

    def version(self, program: str) -> str:
        """Return an identifier of this build of the program."""
        facts = os.stat(program)
        return f"{program}, {facts.st_size} bytes of {facts.st_mtime_ns}"

    def command(self, program: str, folder: Path) -> Sequence[str]:
        """Return the arguments that start the code on the input of a folder."""
        raise NotImplementedError

    def outputs(self, scene: Scene, folder: Path) -> MotionOutputs:
        """Read the output; a MpmfwError says why the code failed, any other error that files are damaged."""
        raise NotImplementedError

    def judged(self, version: str) -> str:
        """Return the status of a run of a version."""
        if version in self.versions:
            return "ok"
        return f"suspect: measured with {', '.join(self.versions)}, not {version}"

    def problems(self, scene: Scene) -> tuple[SceneProblem, ...]:
        """Return everything in a scene that the code cannot do."""
        found = [*self._unread(scene), *self.refusals(scene)]
        return tuple(SceneProblem(f"{self.title}: {reason}", key) for key, reason in found)

    def _unread(self, scene: Scene) -> Iterator[tuple[str, str]]:
        for table in _OPTIONAL:
            if getattr(scene, table) and table not in self.reads:
                yield table, "cannot be expressed"
        if scene.grid.axisymmetric:
            yield "grid.axisymmetric", "bodies of revolution cannot be expressed"
        if scene.gravity is not None and not scene.gravity.is_constant:
            yield "gravity.table", "gravity that changes cannot be expressed"
        if scene.settle is not None and scene.settle.max_time is not None:
            yield "settle.max_time", "a limit of the time of settling cannot be expressed"
        if not scene.has_coulomb_friction:
            yield "contact.friction_law", "its friction is Coulomb's"
        yield from _contact_refusals(scene)
        for name, material in scene.materials.items():
            if material.damping is not None:
                yield f"materials.{name}.damping", "viscous damping cannot be expressed"
            if material.model not in self.models:
                reason = f"'{material.model}' is not one of {' and '.join(self.models)}"
                yield f"materials.{name}.model", reason
        for name, body in scene.bodies.items():
            for key in ("initial_stress", "thickness", "self_contact"):
                if getattr(body, key) not in (None, False):
                    yield f"bodies.{name}.{key}", "cannot be expressed"
            moves = isinstance(body, RigidBody) and body.rigid is not True
            if moves and not ("motion" in self.reads and body.prescribed):
                yield f"bodies.{name}.rigid", "a rigid body that moves cannot be expressed"
            if np.any(body.angular_velocity or 0.0) and "spin" not in self.reads:
                yield f"bodies.{name}.angular_velocity", "a spin at the start is not written"
            if scene.settle and not at_rest(body) and self.reads & {"settle", "start"} == {"settle"}:
                yield f"bodies.{name}.velocity", "a velocity after settling is not written"

    def find(self) -> str:
        """Return the absolute path of the program; a SceneError has the command that installs the code."""
        variable = f"MPMFW_CODE_{self.name.upper()}"
        given = os.environ.get(variable)
        path = shutil.which(given) if given else self.program()
        if path is None:
            wrong = f"{variable}={given} is not a program" if given else "is not installed"
            raise SceneError(f"code {self.name}: {wrong}; {self.install}")
        return os.path.abspath(path)  # of a link, as environments of Python are known by it

    def identify(self) -> None:
        """Find the program and its version, once; a SceneError says how to install the code."""
        if not self.installed:
            self.installed = self.version(self.find())

    def prepare(self, scene: Scene, folder: Path) -> None:
        """Write the code's input and the scene; a SceneError has a problem for each thing it cannot do."""
        if problems := self.problems(scene):
            raise SceneError(problems=problems)
        (folder / SCENE).write_text(scene.text, encoding="utf-8")
        self.write(scene, folder)

    def run(self, folder: Path, limits: ProcessLimits | None = None) -> None:
        """Run the code in its folder; raise MpmfwError if it fails or passes a limit."""
        folder = folder.resolve()
        command = self.command(self.find(), folder)
        cost = run_process(command, folder, folder / LOG, limits or self.limits)
        (folder / COST).write_text(json.dumps(asdict(cost)), encoding="utf-8")

    def read(self, folder: Path, output: str | os.PathLike[str] | None = None) -> xr.DataTree:
        """Return the results in a folder, and write them to a file; one line says that they are damaged."""
        settings = json.dumps(self.options.model_dump(), default=str)
        try:
            for path in folder.iterdir():
                if path.stat().st_size > _LARGEST.get(path.suffix, LARGEST):
                    raise ValueError(f"{path.name} is too large")
            scene = load_scene(folder / SCENE)
            outputs, cost = self.outputs(scene, folder), None
            if not self.runs_elsewhere:
                cost = RunCost(**json.loads((folder / COST).read_text(encoding="utf-8")))
            outputs.check(scene, cost)
            return results_of(scene, outputs, cost, {"contact": self.label, "settings": settings}, output)
        except SceneError:
            raise
        except MpmfwError as error:
            raise MpmfwError(printable(str(error))) from error
        except Exception as error:  # a stranger's files may hold anything
            reason = printable(f"{type(error).__name__}: {error}")[:200]
            raise MpmfwError(f"{self.title}: its output is missing or damaged ({reason})") from error

    @classmethod
    def named(cls, text: str) -> list[Self]:
        """Return the adapters of ``NAME`` (the plainest and the best settings) or ``NAME(option=value)``."""
        asked = checked_specification("code", text)
        plugin: Any = load("code", asked.name)
        every = [asked.options] if asked.options or not plugin.best else [{}, plugin.best]
        return [plugin(**options) for options in every]


def codes_of(given: Iterable[Any]) -> list[Any]:
    """Return the adapters of names and objects; raise SceneError if one is not installed."""
    codes: list[Any] = []
    for one in given:
        codes += Code.named(one) if isinstance(one, str) else [one]
    for code in codes:
        if not isinstance(code, Code):
            raise SceneError(f"code: {code!r} is neither a name nor an object of mpmfw.api.code.Code")
        code.identify()
    return list({code.label: code for code in codes}.values())


def _contact_refusals(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield contacts without friction: adapters write one contact with friction between all bodies."""
    contact: Any = scene.contact
    if scene.pairs and not load("contact", contact.method).uses_friction:
        yield "contact.method", f"writes contact with friction, and not '{contact.method}'"
    for pair in () if contact is None else contact.pairs:
        if pair.method is not None:
            key = f"contact.pairs.{'-'.join(pair.bodies)}.method"
            yield key, "a contact between two bodies alone cannot be expressed"


# -- what adapters need


def read_arrays(path: Path) -> dict[str, AnyArray]:
    """Return the arrays of an ``.npz`` file by name; raise ValueError unless they are real numbers."""
    content = io.BytesIO(path.read_bytes())
    with zipfile.ZipFile(content) as packed:
        if sum(each.file_size for each in packed.infolist()) > LARGEST:
            raise ValueError(f"{path.name} is too large")
    with np.load(content, allow_pickle=False) as file:
        arrays = dict(file)
    if wrong := [name for name, array in arrays.items() if array.dtype.kind not in "fiu"]:
        raise ValueError(f"{path.name} has other arrays than of real numbers: {wrong[0]}")
    return arrays


def points_of_body(scene: Scene, name: str, size: float | None = None) -> Layout:
    """Return a body's material points as mpmfw would have them, or fitted with edges up to ``size`` [m]."""
    body: Any = scene.bodies[name]
    particles = body.particles if size is None else Particles(layout="fitted", size=size)
    return discretise(body.geometry, particles, None)


@dataclass(frozen=True)
class Elasticity:
    """Isotropic elasticity of a body at small strain."""

    density: float  #: [kg/m³]
    bulk: float  #: modulus [Pa]
    shear: float  #: modulus [Pa]
    young: float  #: Young's modulus [Pa]
    poisson: float  #: Poisson's ratio
    uniaxial: float  #: modulus of uniaxial strain, K + 4G/3 [Pa]
    speed: float  #: of pressure waves [m/s]


def elasticity(scene: Scene, name: str) -> Elasticity:
    """Return the elasticity of a body's material."""
    table = scene.materials[scene.bodies[name].material]
    material: Any = load("material", table.model).from_options(table.options)
    k, g, density = material.bulk_modulus, material.shear_modulus, table.density
    young, poisson = 9.0 * k * g / (3.0 * k + g), (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g)
    uniaxial = k + 4.0 / 3.0 * g
    return Elasticity(density, k, g, young, poisson, uniaxial, math.sqrt(uniaxial / density))


def starting_velocity(scene: Scene, name: str, layout: Layout) -> FloatArray:
    """Return the velocity of a body's points at the start, of its spin as well (n, dim) [m/s]."""
    body: Any = scene.bodies[name]
    place = np.zeros((len(layout.volume), 3))
    place[:, : scene.dim] = layout.position - layout.volume @ layout.position / layout.volume.sum()
    return np.asarray(np.cross(spin_of(scene, name), place)[:, : scene.dim] + (body.velocity or 0.0))


def spin_of(scene: Scene, name: str) -> FloatArray:
    """Return the angular velocity of a body at the start (3,) [rad/s]."""
    spin, given = np.zeros(3), scene.bodies[name].angular_velocity or 0.0
    spin[-np.size(given) :] = given
    return spin


def surface_velocity(body: Any) -> FloatArray | None:
    """Return the constant velocity of a rigid body, or of its surface as a belt (dim,) [m/s]; else None."""
    if body.rigid is True:
        return np.zeros(body.geometry.dim)
    moved = body.rigid.motion.model_dump(exclude_none=True) if body.rigid.motion else {}
    known: Any = moved.get("velocity", moved.get("surface_velocity"))
    return np.array(known) if len(moved) == 1 and np.ndim(known) == 1 else None


def is_turned(shape: Any) -> bool:
    """Return True if a rectangle or box is turned against the axes."""
    return bool(np.any(getattr(shape, "angle", 0.0)) or np.any(getattr(shape, "angles", 0.0)))
