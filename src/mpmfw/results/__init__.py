"""Results of runs: one NetCDF-4 file each, written frame by frame, read as an xarray DataTree."""

from mpmfw.results import locking as _locking  # noqa: F401  before anything that loads HDF5
from mpmfw.results.frame import Frame, RunHeader
from mpmfw.results.provenance import provenance
from mpmfw.results.reading import check_results, open
from mpmfw.results.writing import RunWriter

__all__ = ["Frame", "RunHeader", "RunWriter", "check_results", "open", "provenance"]
