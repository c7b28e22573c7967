"""Geometry: exact distances and collision times of polygon shapes, motion on arcs, areas.

The public functions are named here and loaded on first use, so that importing the package stays
quick. The compiled kernels are in the modules of this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physim.geometry.batch import collision_times, shortest_distances
    from physim.geometry.encounters import (
        CertifiedTime,
        collision_time_certified,
        contact_intervals,
    )
    from physim.geometry.queries import (
        Separation,
        closest_points,
        collision_time,
        polyline,
        shortest_distance,
        signed_distance,
    )
    from physim.geometry.shapes import Shapes, pack_shapes

__all__ = [
    "CertifiedTime",
    "Separation",
    "Shapes",
    "closest_points",
    "collision_time",
    "collision_time_certified",
    "collision_times",
    "contact_intervals",
    "pack_shapes",
    "polyline",
    "shortest_distance",
    "shortest_distances",
    "signed_distance",
]

HOMES = {
    "CertifiedTime": "encounters",
    "Shapes": "shapes",
    "collision_time_certified": "encounters",
    "collision_times": "batch",
    "contact_intervals": "encounters",
    "pack_shapes": "shapes",
    "shortest_distances": "batch",
}
"""Module of each public name that does not stand in `queries`."""


def __getattr__(name: str) -> Any:
    """Load a public function on first use."""
    if name in __all__:
        from importlib import import_module

        return getattr(import_module(f"{__name__}.{HOMES.get(name, 'queries')}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List what is loaded, and the public functions."""
    return sorted({*globals(), *__all__})
