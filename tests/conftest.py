"""Settings shared by all tests."""

from hypothesis import HealthCheck, settings

# Random examples that are the same in every run, so that a red build can be repeated; no time limit for one example,
# since the machines that run the tests are shared.
settings.register_profile("liepoisson", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("liepoisson")
