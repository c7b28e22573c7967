"""Whether a shape of an SVG drawing is to be seen, by what it inherits from what it stands in.

As a browser has it: ``visibility``, ``fill`` and ``stroke`` are those of the element itself, or
else of the nearest group, or copy (``use``), that has one; an area is black, and a line not drawn,
where nothing is said of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from physim.authoring.importing.svg_sheets import declarations

UNTOLD: Mapping[str, str] = {"visibility": "visible", "fill": "black", "stroke": "none"}
"""What holds where nothing is said"""
INVISIBLE = ("hidden", "collapse")
"""Values of ``visibility``"""
UNPAINTED = ("none", "transparent")
"""Values of ``fill`` and ``stroke``"""
PREFIX = "physim-"
"""Before the names of attributes that the library hands on to what stands in an element"""


def handed_on(attributes: Mapping[str, str]) -> dict[str, str]:
    """What an element says of them, as attributes under names of their own."""
    own = {**attributes, **declarations(attributes.get("style", ""), tuple(UNTOLD))}
    own = {key: own[key].strip().lower() for key in UNTOLD if key in own}
    return {PREFIX + key: value for key, value in own.items() if value != "inherit"}


def is_seen(values: Mapping[str, Any], is_meant: bool) -> bool:
    """Whether a shape is to be seen, of what has been handed on to it.

    ``is_meant``: it counts without area and line, too, as one that is named by its role, or of
    which a style sheet may say otherwise.
    """
    look = {key: values.get(PREFIX + key, value) for key, value in UNTOLD.items()}
    is_painted = look["fill"] not in UNPAINTED or look["stroke"] not in UNPAINTED
    return look["visibility"] not in INVISIBLE and (is_painted or is_meant)
