"""Compiled kernels: short loops over ``range(dim)``, one source for two and three dimensions.

They import numpy and numba alone. The dimension is the length of the tuple ``spacing``, so that numba
specialises by type and the disk cache hits.
"""

from mpmfw.kernels._jit import device, kernel

__all__ = ["device", "kernel"]
