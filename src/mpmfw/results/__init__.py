"""Results of runs: one NetCDF-4 file each, read as an xarray DataTree."""

import os

# HDF5 would lock a run's file, which others read while it grows. It reads the setting once, below.
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")

from mpmfw.results.provenance import provenance
from mpmfw.results.reading import check_results, open
from mpmfw.results.timeline import Frame, RunHeader
from mpmfw.results.writing import RunWriter

__all__ = ["Frame", "RunHeader", "RunWriter", "check_results", "open", "provenance"]
