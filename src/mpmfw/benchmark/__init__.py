"""What a time step costs: nanoseconds per material point by stage.

The command line is not needed to measure: :func:`measure_scene` times a scene's own simulation,
:func:`measure_threads` what several threads gain, :func:`table` shows it."""

from mpmfw.benchmark.scenes import measure_scene, measure_threads
from mpmfw.benchmark.tables import table

__all__ = ["measure_scene", "measure_threads", "table"]
