"""What is believed of methods that have not run: how likely each is to meet a target, and what a run of it costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import ndtr

from mpmfw.errors import MpmfwError
from mpmfw.scene import Scene
from mpmfw.studies.fitting import FLOOR
from mpmfw.studies.verdicts import Method

#: What is believed beforehand of ln e at the coarsest cell: its mean, and the standard deviations of what a scene, a contact in
#: it, a shape function in it and a method by itself add. In the tables of docs/studies: 1 to 3 %, 1.3 to 2.3, 0.8 to 2.3, 0.2
#: to 0.5 and 0.2 to 0.7, for the methods that are tried if none are named and for all.
_MEAN, _SCENE, _CONTACT, _SHAPE, _OWN = np.log(0.02), 2.0, 1.5, 0.5, 0.7


def chances(methods: Sequence[Method], errors: Mapping[Method, float], target: float) -> dict[Method, float]:
    """The probability of every method to be below a target at the coarsest cell, after the errors of some there.

    ln e = scene + contact + shape + its own, all normal: a contact that was far off with one shape function is likely to be far
    off with another. Errors count as 100 % at most, which a run that failed has.
    """
    labels = np.array(methods)
    alike = labels[:, None, :] == labels[None, :, :]
    covariance = (
        _SCENE**2 + _CONTACT**2 * alike[..., 0] + _SHAPE**2 * alike[..., 1] + _OWN**2 * alike.all(axis=2)
    )
    mean = np.full(len(methods), _MEAN)
    known = [k for k, method in enumerate(methods) if method in errors]
    if known:
        seen = np.log(np.clip([abs(errors[methods[k]]) for k in known], FLOOR, 1.0))
        gain = np.linalg.solve(covariance[np.ix_(known, known)], covariance[known])
        mean = mean + gain.T @ (seen - _MEAN)
        covariance = covariance - covariance[:, known] @ gain
    spread = np.sqrt(np.maximum(np.diag(covariance), 1e-12))
    found = ndtr((np.log(max(target, FLOOR)) - mean) / spread)
    return dict(zip(methods, map(float, found), strict=True))


def price(scene: Scene | None) -> float:
    """Predicted CPU time of a run [s], settling included; 0 of one that is refused."""
    from mpmfw.runs.prediction import predict
    from mpmfw.runs.simulation import Simulation

    if scene is None:
        return 0.0
    try:
        found = predict(Simulation(scene), ())
    except MpmfwError:  # it fails as fast where it is run, and its status says why
        return 0.0
    return found.cpu_time + found.settle_time
