"""Settings of every test: no clock decides, and every run tries the same examples."""

from __future__ import annotations

import signal

from hypothesis import HealthCheck, settings

settings.register_profile(
    "physim",
    deadline=None,  # the first call of a kernel compiles it
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("physim")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # as in the background of a shell: processes that tests start would be deaf to Ctrl-C, too
    signal.signal(signal.SIGINT, signal.default_int_handler)
