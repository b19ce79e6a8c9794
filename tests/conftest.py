"""Settings of the whole test run."""

import signal

from hypothesis import HealthCheck, settings

# Started in the background of a script, the tests and all programs that they start would ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The same commit gives the same result, on a busy machine too: nothing is timed, and examples are drawn from
# fixed seeds. `--hypothesis-profile=searching` draws others, on the look-out for mistakes.
settings.register_profile("searching", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("repeatable", settings.get_profile("searching"), derandomize=True)
settings.load_profile("repeatable")
