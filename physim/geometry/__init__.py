"""Geometry: exact distances and collision times of polygon shapes, motion on arcs, paths.

The public functions are named here and loaded on first use, so that importing the package stays
quick. The compiled kernels are in the modules of this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physim.geometry.queries import (
        CertifiedTime,
        Separation,
        closest_points,
        collision_time,
        collision_time_certified,
        collision_times,
        pack_shapes,
        polyline,
        shortest_distance,
        shortest_distances,
        signed_distance,
    )
    from physim.geometry.shapes import Shapes

__all__ = [
    "CertifiedTime",
    "Separation",
    "Shapes",
    "closest_points",
    "collision_time",
    "collision_time_certified",
    "collision_times",
    "pack_shapes",
    "polyline",
    "shortest_distance",
    "shortest_distances",
    "signed_distance",
]


def __getattr__(name: str) -> Any:
    """Load a public function on first use."""
    if name in __all__:
        from physim.geometry import queries

        return getattr(queries, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List what is loaded, and the public functions."""
    return sorted({*globals(), *__all__})
