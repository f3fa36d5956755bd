"""The latest outputs of a run as rows of one array, which is written in one piece.

A run that records a dozen series every other step would spend as much time on handing each of them to the file as on the
steps in between. Small outputs therefore go to a journal in the file, one row each, and from there to their own variables many
at a time. Whoever reads the file of a run that was killed, or goes on, finds the last of them there (:func:`pending`).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import netCDF4
import numpy as np

from mpmfw.fields import AnyArray, FloatArray

#: Rows of the journal: outputs that wait at most.
ROWS = 64

#: Numbers of the largest output that is worth a row.
LARGEST = 4096

#: Name of the variable in the root of the file.
NAME = "journal"

#: Arrays of one output by group and name.
Output: TypeAlias = Mapping[tuple[str, str], AnyArray]


class Journal:
    """The journal of a file that is being written.

    Parameters
    ----------
    dataset
        The file; the variable is made with the first row.
    """

    def __init__(self, dataset: netCDF4.Dataset) -> None:
        self.dataset = dataset
        self._variable: netCDF4.Variable[Any] | None = None
        self._shapes: dict[tuple[str, str], tuple[int, ...]] = {}

    def write(self, index: int, time: float, output: Output) -> bool:
        """Write a row; False if the output is too large for one, or has other arrays than the first that had one.

        Parameters
        ----------
        index
            Of the output.
        time
            [s].
        """
        shapes = {key: values.shape for key, values in output.items()}
        if self._variable is None:
            if not output or sum(values.size for values in output.values()) > LARGEST:
                return False
            self._make(shapes)
        if shapes != self._shapes:
            return False
        # What makes the row count comes last: a row that was cut short is none
        row = np.concatenate([*(values.ravel() for values in output.values()), [time, index]], dtype=float)
        self._variable._put(row[None], [index % ROWS, 0], [1, len(row)], [1, 1])  # type: ignore[union-attr]
        return True

    def _make(self, shapes: dict[tuple[str, str], tuple[int, ...]]) -> None:
        self._shapes = shapes
        self.dataset.createDimension(f"{NAME}_row", ROWS)
        self.dataset.createDimension(f"{NAME}_column", sum(map(int, map(np.prod, shapes.values()))) + 2)
        dims = (f"{NAME}_row", f"{NAME}_column")
        self._variable = self.dataset.createVariable(NAME, "f8", dims, fill_value=np.nan, contiguous=True)
        self._variable.set_auto_maskandscale(False)
        self._variable.long_name = (
            "outputs that are not in their own variables yet; the last columns are time and index"
        )
        self._variable.arrays = json.dumps([[*key, list(shape)] for key, shape in shapes.items()])


def pending(dataset: netCDF4.Dataset, complete: int) -> Iterator[tuple[float, Output]]:
    """Time and arrays of the outputs that are in the journal alone, in their order.

    Parameters
    ----------
    dataset
        The file.
    complete
        Number of outputs whose arrays and times are in their own variables.
    """
    if NAME not in dataset.variables:
        return
    variable = dataset[NAME]
    variable.set_auto_maskandscale(False)
    rows: FloatArray = variable[...]
    layout = json.loads(variable.arrays)
    while rows[complete % ROWS, -1] == complete:
        row = rows[complete % ROWS]
        parts = np.split(row[:-2], np.cumsum([int(np.prod(shape)) for *_, shape in layout])[:-1])
        yield (
            float(row[-2]),
            {
                (place, name): part.reshape(shape)
                for part, (place, name, shape) in zip(parts, layout, strict=True)
            },
        )
        complete += 1
