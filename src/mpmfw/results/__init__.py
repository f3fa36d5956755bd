"""Results of runs: one NetCDF-4 file each, written frame by frame, read as an xarray DataTree."""

import os

# HDF5 locks files that are open for writing, and a run's file is open, and read by others, as long as the run
# lasts. HDF5 reads the setting once, when netCDF4 loads it below; a value that the user has set stays.
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")

from mpmfw.results.frame import Frame, RunHeader
from mpmfw.results.provenance import provenance
from mpmfw.results.reading import check_results, open
from mpmfw.results.writing import RunWriter

__all__ = ["Frame", "RunHeader", "RunWriter", "check_results", "open", "provenance"]
