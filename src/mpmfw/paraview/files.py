"""Files of VTK: a mesh with its time and what it comes from, and the collection that lists them by time."""

from __future__ import annotations

import base64
import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from mpmfw.results.replacing import replace_bytes
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: VTK's numbers of the kinds of cells, by the number of nodes.
_KINDS = {1: 1, 2: 3, 3: 5, 4: 9}
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


@dataclass(frozen=True)
class Mesh:
    """Vertices, lines, triangles or quadrilaterals with fields.

    Attributes
    ----------
    points : (n, 3)
        [m].
    cells : (k, m)
        Points of every cell: m = 1 vertices, 2 lines, 3 triangles, 4 quadrilaterals.
    point_data, cell_data
        Arrays (n, …) and (k, …) by name.
    """

    points: FloatArray
    cells: IntArray
    point_data: Mapping[str, AnyArray] = field(default_factory=dict)
    cell_data: Mapping[str, AnyArray] = field(default_factory=dict)


#: How the files begin.
_HEAD = (
    '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
    'header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>'
)
_FIELDS = '\n<FieldData>\n<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">'


def write_mesh(path: Path, mesh: Mesh, time: float, about: Mapping[str, str]) -> None:
    """Write one output as a VTK XML file of the type UnstructuredGrid, in double precision.

    Parameters
    ----------
    path
        File to write.
    time
        [s]; ``TimeValue`` in the file, by which VTK's readers know the time of a single one.
    about
        Texts by name: the scene, the commit, units …
    """
    count, corners = mesh.cells.shape
    cells = {
        "connectivity": mesh.cells.ravel().astype("i8"),
        "offsets": corners * np.arange(1, count + 1, dtype="i8"),
        "types": np.full(count, _KINDS[corners], dtype="u1"),
    }
    parts = [
        _HEAD,
        _field_data(time, about),
        f'<Piece NumberOfPoints="{len(mesh.points)}" NumberOfCells="{count}">\n',
        f"<Points>\n{_array('Points', np.asarray(mesh.points, dtype='f8'))}</Points>\n",
        *_section("Cells", cells),
        *_section("PointData", mesh.point_data),
        *_section("CellData", mesh.cell_data),
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
    ]
    replace_bytes("".join(parts).encode(), path)


def _section(name: str, arrays: Mapping[str, AnyArray]) -> list[str]:
    return [f"<{name}>\n", *(_array(each, values) for each, values in arrays.items()), f"</{name}>\n"]


def _array(name: str, values: AnyArray) -> str:
    """One array, compressed in one block."""
    values = np.ascontiguousarray(values)
    if values.dtype.kind in "bu" and values.dtype.itemsize == 1:
        values = values.astype("u1")
    elif values.dtype.str[1:] not in _TYPES:
        values = values.astype("f8" if values.dtype.kind == "f" else "i8")
    data: Any = values.astype(values.dtype.newbyteorder("<"), copy=False).tobytes()
    packed = zlib.compress(data)
    head = np.array([1, len(data), len(data), len(packed)] if data else [0, 0, 0], dtype="<u8").tobytes()
    text = base64.b64encode(head).decode() + (base64.b64encode(packed).decode() if data else "")
    components = "" if values.ndim == 1 else f' NumberOfComponents="{int(np.prod(values.shape[1:]))}"'
    kind = _TYPES[values.dtype.str[1:]]
    return f'<DataArray type="{kind}" Name={quoteattr(name)}{components} format="binary">{text}</DataArray>\n'


def write_collection(path: Path, times: Sequence[float], files: Sequence[Path]) -> None:
    """Write ParaView's list of files with the times [s] that they hold (``.pvd``).

    Parameters
    ----------
    path
        File to write; the others are named from its folder.
    """
    folder = path.parent
    lines = [
        f'    <DataSet timestep="{float(time)!r}" part="0" file={quoteattr(_relative(file, folder))}/>\n'
        for time, file in zip(times, files, strict=True)
    ]
    head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
    replace_bytes(f"{head}{''.join(lines)}  </Collection>\n</VTKFile>\n".encode(), path)


def _relative(file: Path, folder: Path) -> str:
    return Path(os.path.relpath(file, folder)).as_posix()


def _field_data(time: float, about: Mapping[str, str]) -> str:
    """The time, and texts as the codes of their bytes, which is how VTK writes strings."""
    texts = "".join(
        f'<Array type="String" Name={quoteattr(name)} NumberOfTuples="1" format="ascii">'
        f"{' '.join(str(code) for code in (*text.encode(), 0))}</Array>\n"
        for name, text in about.items()
    )
    return f"{_FIELDS}{float(time)!r}</DataArray>\n{texts}</FieldData>\n"
