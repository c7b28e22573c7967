"""Less work for numba's front end, which takes most of the time that a kernel takes to compile.

Types are inferred and code is generated in Python, at about a hundred thousand calls a kernel. Two
things that cost much there are of no use: the collector of garbage, which goes through all that
numba keeps again and again, and the comparison of options, all of them at every look-up.
Results are the same without them, bit for bit.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any

from numba.core.compiler import Flags


class SteadyFlags(Flags):
    """Options of one compilation; once compared, they do not change."""

    @cached_property
    def all_values(self) -> dict[str, Any]:
        """All options by name."""
        return dict(super().values())  # type: ignore[no-untyped-call]

    def values(self) -> dict[str, Any]:
        """All options by name, gathered once."""
        return self.all_values

    @cached_property
    def own_hash(self) -> int:
        """The hash that numba gives to equal options."""
        return int(super().__hash__())  # type: ignore[no-untyped-call]

    def __hash__(self) -> int:
        """Return `own_hash`."""
        return self.own_hash

    def __eq__(self, other: object) -> bool:
        """Whether all options are equal."""
        return self is other or bool(super().__eq__(other))  # type: ignore[no-untyped-call]


@contextmanager
def without_collector() -> Iterator[None]:
    """Collect no garbage: there is none that is worth the search until all is compiled."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
