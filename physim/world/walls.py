"""Where along a boundary something is: the stretch between two of its points as written."""

from __future__ import annotations

import re
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
    are not written as ``boundaries`` the point alone is said. Of equally near stretches the first.
    """
    x, y = (float(value) for value in np.asarray(point, dtype=np.float64))
    said = f"at {place_text(x, y, 4)}"
    found = re.fullmatch(r"boundary ([0-9]+)|boundaries\[([0-9]+)\]", name)
    if found is None or not boundaries:
        return said
    number = int(found[1]) - 1 if found[1] else int(found[2])
    if number >= len(boundaries):
        return said
    line = np.asarray(boundaries[number], dtype=np.float64)
    stretches = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    away = shapely.distance(stretches, shapely.Point(x, y))
    k = int(np.argmax(away <= away.min() + CONTACT))
    return f"{said}, boundaries[{number}][{k}] to [{k + 1}]"
