"""Makes ``tests`` importable, and says what all tests share."""

import gc

from hypothesis import HealthCheck, settings

# How long an example takes says what else the machine has to do
settings.register_profile("tests", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tests")


def pytest_collection_finish():
    """Let the collector of garbage leave alone what stays to the end: it took seven percent of all time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)
