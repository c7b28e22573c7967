"""A path on which many places are looked up at once."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.geometry.arc_length import Polyline
from physim.geometry.shapes import FloatArray, IntArray

JOINED = 1.0
"""[m] A path whose ends are nearer than this is closed."""


def is_ring(path: FloatArray) -> bool:
    """Whether a path (n, 2) [m] ends where it begins."""
    return Polyline(path).is_ring(within=JOINED)


class Way(Polyline):
    """A path (n, 2) [m], which bodies may stand beside."""

    def beside(
        self, outlines: NDArray[np.object_], places: FloatArray, reach: float
    ) -> tuple[IntArray, FloatArray, FloatArray]:
        """Where the path comes as near to the ``outlines`` of bodies at places (K, 2) as ``reach``.

        Numbers of bodies, the station [m] nearest to the place on that segment, how far the segment
        is from the outline [m].
        """
        body, k = self._segments.query(outlines, predicate="dwithin", distance=reach)
        away = shapely.distance(outlines[body], self._segments.geometries[k])
        return body, self._foot(places[body], k), away
