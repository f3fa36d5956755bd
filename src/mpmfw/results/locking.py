"""Files that can be read while they are written.

HDF5 locks a file that is open for writing, and a run's file is open for as long as the run lasts. HDF5 reads
the setting once, when it is loaded: this module must be imported before netCDF4. A value that the user has
set is left alone.
"""

from __future__ import annotations

import os

os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")
