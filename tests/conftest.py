"""Makes ``tests`` importable, and says what all property-based tests share."""

from hypothesis import HealthCheck, settings

# How long an example takes says what else the machine has to do
settings.register_profile("tests", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tests")
