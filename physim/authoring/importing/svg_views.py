"""Symbols with a view of their own (``viewBox``), which each copy fits into a box of its own.

As SVG has it: a copy (``use``) of one is as large as its width and height say, or else those of the
symbol, or else as the page, and the view lies in that box by ``preserveAspectRatio``.
"""

from __future__ import annotations

from collections.abc import Mapping

from physim.authoring.importing.svg_css import NAMESPACE
from physim.authoring.importing.svg_sheets import declarations, look_ahead
from physim.authoring.importing.svg_values import NUMBER, page_fault, pixels_of, place_fault
from physim.escaping import escaped

BOX = ("x", "y", "width", "height")
ALIGN = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
"""Share of what is left over that lies before the view"""
UNSIZED = ("", "100%")
"""Sizes that are those of the page"""


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
        if any(own.get(key, "") not in UNSIZED for key in ("width", "height")):
            raise ViewError("gives an <svg> with a viewBox another size, which is not read")
        return attributes
    for key in declarations(attributes.get("style", ""), ("width", "height")):
        raise ViewError(f"its style has a {key}, which not all browsers read; make it an attribute")
    places = {key: view[key] for key in ("x", "y") if key in view}
    if wrong := page_fault({"viewBox": view.get("viewBox", "0 0 1 1")}) or place_fault(
        places, of_page=False
    ):
        raise ViewError(f"copies a symbol: {wrong}")
    x, y = (pixels_of(own.get(key, "0")) + pixels_of(places.get(key, "0")) for key in ("x", "y"))
    if "viewBox" not in view:
        return _moved(attributes, f"translate({x!r},{y!r})")
    left, top, wide, high = (float(one) for one in NUMBER.findall(view["viewBox"]))
    own = {**{key: view[key] for key in ("width", "height") if key in view}, **own}
    width, height = (_size(own, key, page) for key in ("width", "height"))
    a, d = width / wide, height / high
    align, _, how = (view.get("preserveAspectRatio") or "xMidYMid").strip().partition(" ")
    shares = [ALIGN.get(align[k : k + 3], -1.0) for k in (1, 5)]
    if align != "none" and (min(shares) < 0.0 or how.strip() not in ("", "meet", "slice")):
        given = escaped(view["preserveAspectRatio"])[:40]
        raise ViewError(f'copies a symbol: preserveAspectRatio="{given}" cannot be read')
    if align != "none":
        a = d = max(a, d) if how.strip() == "slice" else min(a, d)
        x += shares[0] * (width - a * wide)
        y += shares[1] * (height - d * high)
    return _moved(attributes, f"matrix({a!r},0,0,{d!r},{x - a * left!r},{y - d * top!r})")


def _moved(attributes: Mapping[str, str], moved: str) -> dict[str, str]:
    """Attributes of a copy with what moves and fits it in its ``transform``, and no box."""
    kept = {key: value for key, value in attributes.items() if key not in BOX}
    style = kept.pop("style", "")
    own_transform = declarations(style, ("transform",)).get("transform", kept.get("transform", ""))
    parts = style.split(";") if style else []
    rest = [one for one in parts if one.partition(":")[0] not in (*BOX, "transform")]
    kept["transform"] = f"{own_transform if own_transform != 'none' else ''} {moved}".strip()
    return {**kept, "style": ";".join(rest)} if rest else kept


def _size(own: Mapping[str, str], key: str, page: Mapping[str, str]) -> float:
    given = own.get(key, "").strip()
    if given in UNSIZED:
        box = NUMBER.findall(page.get("viewBox", ""))
        size = float(box[BOX.index(key)]) if len(box) == 4 else pixels_of(page.get(key, ""))
    else:
        size = pixels_of(given)
    if not size > 0.0:
        raise ViewError(
            f'copies a symbol with a viewBox, and its {key} "{escaped(given)[:40]}" cannot be '
            "read; give it in px or mm"
        )
    return size
