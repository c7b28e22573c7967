"""Where along a boundary something is: the stretch between two of its points as written."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.errors import place_text
from physim.tolerances import CONTACT


def stretch_text(boundaries: Sequence[Any] | None, name: str, point: ArrayLike) -> str:
    """``at (1.5, 4), boundaries[0][16] to [17]``: a point (2,) [m] of a wall, and where that is.

    ``name`` is that of the body (``boundary 1``) or of the key (``boundaries[0]``); of walls that
    are not written as ``boundaries`` the point alone is said.
    """
    x, y = (float(value) for value in np.asarray(point, dtype=np.float64))
    number = _number(name)
    said = f"at {place_text(x, y, 4)}"
    if number is None or not boundaries or not 0 <= number < len(boundaries):
        return said
    line = boundaries[number]
    if line is None or len(line) < 2:
        return said
    points = np.asarray(line, dtype=np.float64)
    pieces = shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1))
    away = shapely.distance(pieces, shapely.Point(x, y))
    k = int(np.argmax(away <= away.min() + CONTACT))  # the first of equally near ones
    return f"{said}, boundaries[{number}][{k}] to [{k + 1}]"


def _number(name: str) -> int | None:
    kind, _, rest = name.partition(" ")
    if kind == "boundary" and rest.isdecimal():
        return int(rest) - 1
    inner = name.removeprefix("boundaries[").removesuffix("]")
    return int(inner) if inner != name and inner.isdecimal() else None
