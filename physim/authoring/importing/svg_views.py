"""Symbols with a view of their own (``viewBox``), which each copy fits into a box of its own.

As SVG has it: a copy (``use``) of one is as large as its width and height say, or else those of the
symbol, or else as the page, and the view lies in that box by ``preserveAspectRatio``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from physim.authoring.importing.svg_css import NAMESPACE
from physim.authoring.importing.svg_sheets import declarations, look_ahead
from physim.authoring.importing.svg_values import LENGTH, NUMBER, page_fault, pixels_of, place_fault
from physim.escaping import escaped

BOX = ("x", "y", "width", "height")
ALIGN = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
"""Share of what is left over that lies before the view"""
RATIO = re.compile(r"\s*(?:none|x(Min|Mid|Max)Y(Min|Mid|Max))(?:\s+(meet|slice))?\s*")
WHOLE = "100%"
"""Size of what has none: that of the page"""


class ViewError(Exception):
    """What is wrong with a copy of something with a view."""


def views_of(text: str) -> dict[str, tuple[str, Mapping[str, str]]]:
    """Tag and attributes of each symbol, and each ``svg`` in the page, that has a viewBox, by id.

    And of each symbol that has a place of its own.

    Of a text that cannot be read, or that declares entities, those up to there.
    """
    found: dict[str, tuple[str, Mapping[str, str]]] = {}
    known: set[str] = set()
    if "viewBox" not in text and "symbol" not in text:
        return found

    def start(name: str, attributes: dict[str, str], _: int) -> None:
        own = attributes.get("id")
        tag = name.removeprefix(f"{NAMESPACE}|")
        is_first = own is not None and own not in known
        known.add(own or "")
        has_view = "viewBox" in attributes
        if tag == "symbol":
            has_view = has_view or "x" in attributes or "y" in attributes
        if own is not None and is_first and tag in ("symbol", "svg") and has_view:
            found[own] = tag, attributes

    look_ahead(text, start)
    return found


def fitted(
    attributes: dict[str, str],
    tag: str,
    view: Mapping[str, str],
    page: Mapping[str, str],
) -> dict[str, str]:
    """Attributes of a copy, with its place and size, and the view's, in its ``transform``.

    ``view`` are the attributes of the symbol, ``page`` those of the page that the copy stands in.
    Raises ViewError where they cannot be read.
    """
    own = {**attributes, **declarations(attributes.get("style", ""), BOX)}
    if tag == "svg":
        if any(own[key] != view.get(key) for key in ("width", "height") if key in own):
            raise ViewError("gives an <svg> with a viewBox another size, which is not read")
        return attributes
    if wrong := styled_size(attributes) or place_fault(own, of_page=True):
        raise ViewError(wrong)
    box = view.get("viewBox", "0 0 1 1")
    if wrong := page_fault({"viewBox": box}) or place_fault(view, of_page=True):
        raise ViewError(f"copies a symbol: {wrong}")
    x, y = (
        _length(own.get(key, "0"), key, page) + _length(view.get(key, "0"), key, page)
        for key in ("x", "y")
    )
    if "viewBox" not in view:
        return _moved(attributes, f"translate({x!r},{y!r})")
    left, top, wide, high = (float(one) for one in NUMBER.findall(box))
    own = {**{key: view[key] for key in ("width", "height") if key in view}, **own}
    width, height = (_length(own.get(key, WHOLE), key, page) for key in ("width", "height"))
    a, d = width / wide, height / high
    ratio = view.get("preserveAspectRatio") or "xMidYMid"
    if (found := RATIO.fullmatch(ratio)) is None:
        given = escaped(ratio)[:40]
        raise ViewError(f'copies a symbol: preserveAspectRatio="{given}" cannot be read')
    if found[1]:
        a = d = max(a, d) if found[3] == "slice" else min(a, d)
        x += ALIGN[found[1]] * (width - a * wide)
        y += ALIGN[found[2]] * (height - d * high)
    return _moved(attributes, f"matrix({a!r},0,0,{d!r},{x - a * left!r},{y - d * top!r})")


def styled_size(attributes: Mapping[str, str]) -> str:
    """What is wrong with a size in the style of what has a view, or copies it; else empty."""
    style = declarations(attributes.get("style", ""), ("width", "height"))
    key = next(iter(style), "")
    return key and f"its style has a {key}, which not all browsers read; make it an attribute"


def has_share(attributes: Mapping[str, str]) -> bool:
    """Whether width or height of an ``svg`` within another is a share of what is about it."""
    sizes = (attributes.get(key, WHOLE) for key in ("width", "height"))
    return any(size.strip().endswith("%") for size in sizes)


def _moved(attributes: Mapping[str, str], moved: str) -> dict[str, str]:
    """Attributes of a copy with what moves and fits it in its ``transform``, and no box."""
    kept = {key: value for key, value in attributes.items() if key not in BOX}
    style = kept.pop("style", "")
    own_transform = declarations(style, ("transform",)).get("transform", kept.get("transform", ""))
    parts = style.split(";") if style else []
    rest = [one for one in parts if one.partition(":")[0] not in (*BOX, "transform")]
    kept["transform"] = f"{own_transform if own_transform != 'none' else ''} {moved}".strip()
    return {**kept, "style": ";".join(rest)} if rest else kept


def _length(given: str, key: str, page: Mapping[str, str]) -> float:
    """[px] Length of a box, above 0 where it is a size; shares are of the page."""
    found = LENGTH.match(given)
    size = pixels_of(given)
    if given.strip().endswith("%") and found is not None:
        side = {"x": "width", "y": "height"}.get(key, key)
        box = NUMBER.findall(page.get("viewBox", ""))
        whole = float(box[BOX.index(side)]) if len(box) == 4 else pixels_of(page.get(side, ""))
        size = float(found[1]) / 100.0 * whole
        found = found if whole > 0.0 else None
    is_wrong = key in ("width", "height") and not 0.0 < size < float("inf")
    if found is None or is_wrong:
        raise ViewError(
            f'copies a symbol, and its {key} "{escaped(given)[:40]}" cannot be read; give it in px '
            "or mm"
        )
    return size
