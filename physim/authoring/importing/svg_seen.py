"""Whether a shape of an SVG drawing is to be seen, by what it inherits from what it stands in.

As a browser has it: ``visibility``, ``fill`` and ``stroke`` are those of the element itself, or
else of the nearest group, or copy (``use``), that has one; an area is black, and a line not drawn,
where nothing is said of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from physim.authoring.importing.svg_css import INHERITED, INITIAL
from physim.authoring.importing.svg_sheets import declarations

PREFIX = "physim-"
"""Before the names of attributes that the library hands on to what stands in an element"""


def handed_on(attributes: Mapping[str, str]) -> dict[str, str]:
    """What an element says of them, as attributes under names of their own."""
    own = {**attributes, **declarations(attributes.get("style", ""), INHERITED)}
    return {PREFIX + key: own[key] for key in INHERITED if own.get(key, "inherit") != "inherit"}


def is_seen(values: Mapping[str, Any], is_meant: bool) -> bool:
    """Whether a shape is to be seen, of what has been handed on to it.

    ``is_meant``: it counts without area and line, too, as one that is named by its role, or of
    which a style sheet may say otherwise.
    """
    look = {key: values.get(PREFIX + key, INITIAL[key]) for key in INHERITED}
    is_painted = look["fill"] != "none" or look["stroke"] != "none"
    return look["visibility"] != "hidden" and (is_painted or is_meant)
