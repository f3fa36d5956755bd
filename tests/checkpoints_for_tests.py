"""Checkpoints that are made or changed by hand."""

import json

import numpy as np

FACTS = "mpmfw checkpoint 5"


def write(path, facts=None, **arrays):
    """Write a file of these facts, a text or what JSON makes of them, and of arrays by place."""
    text = facts if isinstance(facts, str) else json.dumps([len(arrays), facts])
    with open(path, "wb") as file:
        np.savez(file, **{FACTS: np.frombuffer(text.encode(), np.uint8), **arrays})


def opened(path):
    """Return the facts and the arrays of a checkpoint."""
    with np.load(path) as file:
        arrays = {place: file[place] for place in file.files}
    return json.loads(arrays.pop(FACTS).tobytes())[1], arrays
