"""Files of VTK: a mesh with its time and what it comes from, and the collection that lists them by time."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import meshio

_GRID = "<UnstructuredGrid>"


def write_mesh(path: Path, mesh: meshio.Mesh, time: float, about: Mapping[str, str]) -> None:
    """Write one output as a VTK XML file of the type UnstructuredGrid, in double precision.

    meshio writes the mesh. Field data, which its writer leaves out, is set into its file: ``TimeValue``, by
    which VTK's readers know the time of a single file, and texts.

    Parameters
    ----------
    path
        File to write.
    time
        [s].
    about
        Texts by name: the scene, the commit, units …
    """
    meshio.write(path, mesh, file_format="vtu")
    text = path.read_text(encoding="utf-8")
    begin = text.index(_GRID) + len(_GRID)
    path.write_text(text[:begin] + _field_data(time, about) + text[begin:], encoding="utf-8")


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
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
        + "".join(lines)
        + "  </Collection>\n</VTKFile>\n",
        encoding="utf-8",
    )


def _relative(file: Path, folder: Path) -> str:
    return Path(os.path.relpath(file, folder)).as_posix()


def _field_data(time: float, about: Mapping[str, str]) -> str:
    """The time, and texts as the codes of their bytes, which is how VTK writes strings."""
    texts = "".join(
        f'<Array type="String" Name={quoteattr(name)} NumberOfTuples="1" format="ascii">'
        f"{' '.join(str(code) for code in (*text.encode(), 0))}</Array>\n"
        for name, text in about.items()
    )
    return (
        '\n<FieldData>\n<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">'
        f"{float(time)!r}</DataArray>\n{texts}</FieldData>\n"
    )
