"""Settings that libraries look for in the working folder, which may have come from a stranger.

numba runs compiled code from the folder that ``.numba_config.yaml`` names, and matplotlib would
draw as ``matplotlibrc`` has it. Neither is read here; variables of the environment, and files in
the user's own folders, are.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

NUMBA, MATPLOTLIB = ".numba_config.yaml", "matplotlibrc"
"""Names of the files"""


@contextmanager
def unseen(name: str) -> Iterator[None]:
    """Be in the root folder while a block runs, where the working folder has such a file."""
    if not os.path.lexists(name):
        yield
        return
    here = os.getcwd()
    os.chdir(os.sep)
    try:
        yield
    finally:
        os.chdir(here)


def load_numba() -> Any:
    """The module; it looks for no file again, as it would each time that it compiles."""
    with unseen(NUMBA):
        import numba
    numba.core.config._config_fname = os.devnull
    return numba
