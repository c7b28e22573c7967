"""Whether a shape of an SVG drawing is to be seen, by what it inherits from what it stands in.

As a browser has it: visibility, paints and their opacities are those of the element itself, or
else of the nearest group, or copy (``use``), that has one; an area is black, and a line not drawn,
where nothing is said of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from physim.authoring.importing.svg_css import FILL_RULE, INHERITED, INITIAL, UNSURE
from physim.authoring.importing.svg_sheets import declarations

PREFIX = "physim-"
"""Before the names of attributes that the library hands on to what stands in an element"""

HANDED_ON = (*INHERITED, FILL_RULE)


def handed_on(attributes: Mapping[str, str]) -> dict[str, str]:
    """What an element says of them, as attributes under names of their own."""
    own = {**attributes, **declarations(attributes.get("style", ""), HANDED_ON)}
    return {PREFIX + key: own[key] for key in HANDED_ON if own.get(key, "inherit") != "inherit"}


def is_seen(values: Mapping[str, Any], is_meant: bool) -> bool:
    """Whether a shape is to be seen, of what has been handed on to it.

    ``is_meant``: it counts without area and line, too, as one that is named by its role, or of
    which a style sheet may say otherwise.
    """
    look = _look(values)
    is_painted = has_area(values) or has_line(values)
    return look["visibility"] != "hidden" and (is_painted or is_meant)


def has_area(values: Mapping[str, Any]) -> bool:
    """Whether the area of a shape is painted."""
    return "0" not in _area(values)


def is_even_odd(values: Mapping[str, Any]) -> bool:
    """Whether what lies within an even number of a shape's lines is not painted."""
    return str(values.get(PREFIX + FILL_RULE, "")).strip().lower() == "evenodd"


def has_line(values: Mapping[str, Any]) -> bool:
    """Whether the outline of a shape is painted."""
    return "0" not in _line(values)


def is_unsure(values: Mapping[str, Any]) -> bool:
    """Whether a shape that is painted may be so by what is seen through alone."""
    paints = [one for one in (_area(values), _line(values)) if "0" not in one]
    return bool(paints) and all(UNSURE in one for one in paints)


def _area(values: Mapping[str, Any]) -> set[str]:
    look = _look(values)
    return {look["fill"].replace("none", "0"), look["fill-opacity"]}


def _line(values: Mapping[str, Any]) -> set[str]:
    look = _look(values)
    return {look["stroke"].replace("none", "0"), look["stroke-opacity"], look["stroke-width"]}


def _look(values: Mapping[str, Any]) -> dict[str, str]:
    return {key: values.get(PREFIX + key, INITIAL[key]) for key in INHERITED}
