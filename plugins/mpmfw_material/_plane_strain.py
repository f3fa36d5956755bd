"""Plane strain: what materials of two dimensions share."""

from __future__ import annotations

import numpy as np

from mpmfw.api import FloatArray


def pad_plane_strain(deformation_gradient: FloatArray) -> FloatArray:
    """F as (n, 3, 3): plane strain adds F_zz = 1."""
    n, dim = deformation_gradient.shape[:2]
    padded = np.tile(np.eye(3), (n, 1, 1))
    padded[:, :dim, :dim] = deformation_gradient
    return padded
