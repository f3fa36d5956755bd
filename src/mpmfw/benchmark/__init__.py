"""What a time step costs: nanoseconds per material point by stage, and the ratio to a plain compiled loop.

Neither the command line nor the rest of the package is needed to measure: :func:`measure_kernels` times the
real stepper on a synthetic block, :func:`measure_scene` a scene's own simulation, :func:`table` shows either.
"""

from mpmfw.benchmark.kernels import measure_kernels
from mpmfw.benchmark.scenes import measure_scene
from mpmfw.benchmark.tables import table

__all__ = ["measure_kernels", "measure_scene", "table"]
