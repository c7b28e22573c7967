"""How many examples a property is tried on: few in the fast tier, more in the deep one."""

from __future__ import annotations

import os

from hypothesis import settings


def examples(fast: int, deep: int) -> settings:
    """Settings of a property test, ``@examples(25, deep=200)``."""
    return settings(max_examples=deep if os.environ.get("PHYSIM_DEEP") else fast, deadline=None)
