"""Settings of the whole test run."""

from hypothesis import HealthCheck, settings

# The same commit gives the same result, on a busy machine too: nothing is timed, and examples are drawn from
# fixed seeds. `--hypothesis-profile=searching` draws others, on the look-out for mistakes.
settings.register_profile("searching", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("repeatable", settings.get_profile("searching"), derandomize=True)
settings.load_profile("repeatable")
