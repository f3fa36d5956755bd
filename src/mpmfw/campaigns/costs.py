"""What runs took, over the grid and the repeats, and under which conditions it was measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.grid import Index
from mpmfw.campaigns.machine import LOADED
from mpmfw.campaigns.outcome import COSTS, Cost
from mpmfw.state.clock import STEP_STAGES

_SPREAD = {"units": "s", "long_name": "half the range of the repeats; NaN of a single one"}
_REPEATS = {"units": "1", "long_name": "runs of the cost"}
_LOAD = {"units": "1", "long_name": "cores that other processes kept busy meanwhile"}


def costs_of(coords: Mapping[str, Sequence[Any]], costs: Mapping[Index, Sequence[Cost]]) -> xr.Dataset:
    """All costs over the grid and ``repeat``, NaN where there is none.

    Returns
    -------
    xarray.Dataset
        The names of :data:`mpmfw.campaigns.outcome.COSTS` and ``load`` (…, repeat); ``stages`` and
        ``settling`` (…, repeat, stage) [s].
    """
    shape = tuple(len(labels) for labels in coords.values())
    most = max((1, *(len(many) for many in costs.values())))
    names = [name for name, _, _ in COSTS]
    values = np.full((*shape, most, len(names) + 1), np.nan)
    stages, settling = (np.full((*shape, most, len(STEP_STAGES)), np.nan) for _ in range(2))
    for index, many in costs.items():
        for k, cost in enumerate(many):
            values[index][k] = [*(cost.values.get(name, np.nan) for name in names), cost.others]
            stages[index][k] = [cost.stages.get(stage, np.nan) for stage in STEP_STAGES]
            settling[index][k] = [cost.settling.get(stage, np.nan) for stage in STEP_STAGES]
    lead = (*coords, "repeat")
    found = {name: (lead, values[..., k]) for k, name in enumerate((*names, "load"))}
    by_stage = {"stages": ((*lead, "stage"), stages), "settling": ((*lead, "stage"), settling)}
    named = {dim: list(labels) for dim, labels in coords.items()}
    return xr.Dataset({**found, **by_stage}, {**named, "stage": list(STEP_STAGES)})


def least(each: xr.Dataset) -> xr.Dataset:
    """Of every run the repeat of the least CPU time: what else the machine does only adds to it.

    Peak memory is the largest, since it is known of the first run of a process alone.
    """
    one = each.isel(repeat=each["cpu_time"].fillna(np.inf).argmin("repeat"))
    return one.assign(peak_memory=each["peak_memory"].max("repeat"))


def over_repeats(each: xr.Dataset) -> dict[str, xr.DataArray]:
    """Spread of the CPU time (half the range, NaN of a single one), number of repeats, and load in the
    mean.
    """
    times = each["cpu_time"]
    count = times.count("repeat")
    spread = 0.5 * (times.max("repeat") - times.min("repeat"))
    return {
        "cpu_time_spread": spread.where(count > 1).assign_attrs(_SPREAD),
        "repeats": count.astype(float).assign_attrs(_REPEATS),
        "load": each["load"].mean("repeat").assign_attrs(_LOAD),
    }


def timing_of(costs: Sequence[Cost]) -> str:
    """``exclusive`` if nothing else ran beside any of them; marked where the machine was loaded by others all
    the same.
    """
    if not costs:
        return ""
    if any(cost.timing != "exclusive" for cost in costs):
        return "shared cores"
    loaded = sum(cost.others > LOADED for cost in costs)
    return f"exclusive, {loaded} of {len(costs)} on a loaded machine" if loaded else "exclusive"
