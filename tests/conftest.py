"""Settings of the whole test run."""

from hypothesis import settings

# Nothing is timed in tests: a busy machine must not make them fail.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
