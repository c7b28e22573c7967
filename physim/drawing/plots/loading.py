"""Matplotlib, loaded whatever the environment asks of it.

physim draws into files, for which matplotlib takes a backend by their format. The variable that
names one for windows and notebooks, ``MPLBACKEND``, is inherited by all that a notebook starts,
and `import matplotlib` ends in a ValueError where the backend it names is not installed.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Any

from physim.stray_settings import MATPLOTLIB, unseen

VARIABLE = "MPLBACKEND"


def load_matplotlib() -> Any:
    """The module. What a process has set in it stays, and a backend that exists is taken over."""
    if "matplotlib" in sys.modules:
        return sys.modules["matplotlib"]
    wanted = os.environ.pop(VARIABLE, None)
    try:
        with unseen(MATPLOTLIB):
            import matplotlib
    finally:
        if wanted is not None:
            os.environ[VARIABLE] = wanted
    if wanted:
        with suppress(ValueError):  # no such backend: the one that matplotlib finds
            matplotlib.rcParams["backend"] = wanted
    return matplotlib
