"""What CSS says in an SVG drawing: rules of a style sheet, declarations, what values come to.

tinycss2 reads it: escapes, comments, strings, what is faulty and so skipped. Values that say
whether something is to be seen come to one of a few words; what is not valid is left out, as a
browser leaves it out, so that an earlier declaration holds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import tinycss2
import tinycss2.color4

from physim.authoring.importing.svg_values import ORIGINS, TAKES

PAINTS = ("fill", "stroke")
"""Properties by which a shape is seen"""
SHOWN = ("display", "visibility", "opacity")
"""Properties by which an element is shown or hidden"""
AMOUNTS = ("fill-opacity", "stroke-opacity", "stroke-width")
"""Properties of which nothing is seen of a paint where they are 0"""
UNSEEN = (*SHOWN, *PAINTS, *AMOUNTS)
CUTS = ("clip-path", "mask", "filter")
"""Properties by which an element is drawn in part, or elsewhere; they are not applied, but told."""
OTHER = "other"
"""Key of a property that is not known: its value is its name, which is told"""
HARMLESS = re.compile(
    r"--|-inkscape-|(fill|stroke|font|text|color|marker|stop|flood|lighting|shape|image|writing|"
    r"letter|word|dominant|alignment|baseline|unicode|glyph|clip|solid|background|pointer|user)-|"
    r"(color|marker|font|line-height|kerning|direction|cursor|isolation|mix-blend-mode|background|"
    r"paint-order|vector-effect|enable-background|white-space|transition.*|"
    r"will-change|content|order|z-index)$"
)
"""Properties that change nothing of where lines are, nor whether they are seen"""
MOVES = ("transform", "rotate", "scale", "translate", "offset", "offset-path", "all")
"""Properties that move what is in an element; they are read nowhere but as attributes."""
PLACED = frozenset((*MOVES, *(key for takes in TAKES.values() for key in takes)))
"""Properties that say where lines lie"""
FILL_RULE = "fill-rule"
COUNTED = frozenset((*UNSEEN, *CUTS, *PLACED, *ORIGINS, "overflow", FILL_RULE))
"""Properties that are looked at"""
CALLED_SO: Mapping[str, str] = {
    **{f"-webkit-{key}": key for key in ("transform", "transform-origin", "opacity", *CUTS)},
    "mask-image": "mask", "-webkit-mask-image": "mask", "-webkit-filter": "filter",
}  # fmt: skip
"""Other names of properties"""
INITIAL: Mapping[str, str] = {
    "display": "inline", "visibility": "visible", "opacity": "1", "fill": "black", "stroke": "none",
    "fill-opacity": "1", "stroke-opacity": "1", "stroke-width": "1",
}  # fmt: skip
"""What holds where nothing is said"""
INHERITED = ("visibility", *PAINTS, *AMOUNTS)
UNSURE = "unsure"
"""Of a paint: it may be one that is seen through"""
WORDS = ("inline", "none", UNSURE, "visible", "hidden", "inherit", "black", "0", "1")
"""What these properties come to; any other value is not read"""
DISPLAYS = re.compile(
    r"none|(inline-)?(block|flex|grid|table)|inline|flow(-root)?|list-item|ruby|math|"
    r"table-(row|column|cell|caption|(row|column|header|footer)-group|column-group)|"
    r"-webkit-(inline-)?(box|flex)"
)
HELD = ("inherit", "unset", "revert")
"""Words for what would hold if nothing were said"""
ANOTHER_PAINT = ("currentcolor", "context-fill", "context-stroke")
REFERS = ("var", "env", "attr", "if", "calc", "min", "max", "clamp")
"""Functions whose value depends on others"""
TAG = re.compile(r"[\w-]+")
MEDIUM = re.compile(r"[a-z]+")
"""A kind of medium, without conditions"""
SCREEN = ("all", "screen")
"""Media for which a drawing is read"""
WITHOUT_RULES = ("charset", "import", "font-face", "page", "counter-style", "property",
                 "font-feature-values", "font-palette-values", "color-profile")  # fmt: skip
"""Rules that say nothing of elements, or that stand in another file"""
LONGEST = 100
"""Characters of a condition that are told"""
NAMESPACE = "http://www.w3.org/2000/svg"
DEEPEST = 20
"""Rules within each other"""


class Declaration(NamedTuple):
    """One property, and what is said of it."""

    key: str
    value: str
    is_important: bool


class Rule(NamedTuple):
    """One rule of a style sheet."""

    condition: str
    """on which it holds, with a space after it; or empty"""
    prelude: Sequence[Any]
    """its selectors, as tokens"""
    names: tuple[str, ...]
    """its selectors that are followed: ``tag``, ``.class``, ``tag.class``, ``#id``, ``*``"""
    is_followed: bool
    """whether these are all"""
    found: tuple[Declaration, ...]

    @property
    def selector(self) -> str:
        """As it is written, after the conditions on which it holds."""
        return f"{self.condition}{_written(self.prelude)}".strip()


def rules(text: str, condition: str = "") -> Iterator[Rule]:
    """The rules of a style sheet in their order; those within rules after what these declare.

    ``condition`` is one on which all of them hold, with a space after it. Raises ValueError where
    more than `DEEPEST` stand within each other.
    """
    nodes = tinycss2.parse_stylesheet(text, skip_comments=True, skip_whitespace=True)
    yield from _rules(nodes, condition, 0)


def _rules(nodes: Iterable[Any], condition: str, depth: int) -> Iterator[Rule]:
    if depth > DEEPEST:
        raise ValueError(f"more than {DEEPEST} rules within each other")
    condition = condition[:LONGEST]
    for node in nodes:
        if node.type == "qualified-rule":
            inner = tinycss2.parse_blocks_contents(
                node.content, skip_comments=True, skip_whitespace=True
            )
            parts = [_simple(part) for part in _split(node.prelude)]
            names = () if condition else tuple(dict.fromkeys(one for one in parts if one))
            rule = Rule(
                condition, node.prelude, names, not condition and all(parts), _declared(inner)
            )
            yield rule
            if any(one.type != "declaration" for one in inner):
                yield from _rules(inner, f"{rule.selector} ", depth + 1)
        elif node.type == "at-rule":
            keyword = node.lower_at_keyword
            if keyword in WITHOUT_RULES or keyword.endswith("keyframes"):
                continue
            holds = _condition(keyword, node.prelude)
            if node.content is None:
                condition += holds if holds and _is_of_others(node) else ""
            elif holds is not None:
                inner = tinycss2.parse_blocks_contents(
                    node.content, skip_comments=True, skip_whitespace=True
                )
                if (found := _declared(inner)) and condition:
                    yield Rule(f"{condition}{holds}", (), (), False, found)
                yield from _rules(inner, f"{condition}{holds}", depth + 1)


def _is_of_others(rule: Any) -> bool:
    """Whether a rule makes plain names mean elements of another namespace than that of drawings."""
    known = [token for token in rule.prelude if token.type != "whitespace"]
    is_default = len(known) == 1 and known[0].type in ("string", "url")
    return rule.lower_at_keyword == "namespace" and is_default and known[0].value != NAMESPACE


def _condition(keyword: str, prelude: Sequence[Any]) -> str | None:
    """On what condition the rules of a block hold, with a space after it; None for no screen."""
    told = _written(prelude)
    if keyword == "media":
        on_screen = is_for_screen(told)
        if on_screen is not None:
            return "" if on_screen else None
    return f"@{keyword} {told} ".replace("  ", " ")


def is_for_screen(media: str) -> bool | None:
    """Whether what is for these ``media`` is for a screen; None where that is conditional."""
    kinds = {one.strip().removeprefix("only ").strip() for one in media.lower().split(",")}
    if not media.strip() or kinds & {*SCREEN}:
        return True
    return False if all(MEDIUM.fullmatch(kind) for kind in kinds if kind) else None


def _split(tokens: Iterable[Any]) -> list[list[Any]]:
    """Selectors of a list, without blanks about them."""
    parts: list[list[Any]] = [[]]
    for token in tokens:
        if token == ",":
            parts.append([])
        elif token.type != "comment" and (parts[-1] or token.type != "whitespace"):
            parts[-1].append(token)
    for part in parts:
        while part and part[-1].type == "whitespace":
            part.pop()
    return parts


def _simple(tokens: Sequence[Any]) -> str:
    """``tag``, ``.class``, ``tag.class``, ``#id`` or ``*``; empty for a selector of other kinds."""
    match [token.type for token in tokens]:
        case ["ident"] if TAG.fullmatch(tokens[0].value):
            return str(tokens[0].value)
        case ["hash"] if tokens[0].is_identifier:
            return f"#{tokens[0].value}"
        case ["literal"] if tokens[0] == "*":
            return "*"
        case ["literal", "ident"] if tokens[0] == ".":
            return f".{tokens[1].value}"
        case ["ident", "literal", "ident"] if tokens[1] == "." and TAG.fullmatch(tokens[0].value):
            return f"{tokens[0].value}.{tokens[2].value}"
    return ""


def declared(style: str) -> tuple[Declaration, ...]:
    """Declarations of a ``style="..."`` in their order: those that are valid, and count."""
    return _declared(
        tinycss2.parse_blocks_contents(style, skip_comments=True, skip_whitespace=True)
    )


def _declared(nodes: Iterable[Any]) -> tuple[Declaration, ...]:
    found = []
    for node in nodes:
        if node.type != "declaration":
            continue
        name = CALLED_SO.get(node.lower_name, node.lower_name)
        keys: Sequence[str] = [name] if name in COUNTED else ()
        if node.lower_name == "all" and _word(node.value) in ("initial", *HELD):
            keys = (*UNSEEN, "all")
        elif not keys and not HARMLESS.match(name):
            found.append(Declaration(OTHER, name, False))
        for key in keys:
            if value := _meant(key, node.value):
                found.append(Declaration(key, value, node.important))
    return tuple(found)


def meant(key: str, value: str) -> str:
    """What the value of a property, as an attribute has it, comes to; empty where it is invalid."""
    return _meant(key, tinycss2.parse_component_value_list(value, skip_comments=True))


def _meant(key: str, tokens: Iterable[Any]) -> str:
    known = [token for token in tokens if token.type not in ("whitespace", "comment")]
    if not known or any(token.type == "error" for token in known):
        return ""
    if key in PLACED:  # whatever it is, it is not read
        return "some"
    if key in CUTS:
        return "none" if _word(known) == "none" else "some"
    if key not in UNSEEN:
        return _written(tokens)
    if _refers(known) and key not in SHOWN:  # what another value gives is taken for seen
        return UNSURE
    if _refers(known):
        return _written(tokens)
    word = _word(known)
    return _of_word(key, word) if word else _MEANINGS[key](known, "")


@lru_cache(1000)
def _of_word(key: str, word: str) -> str:
    if word == "initial":
        return INITIAL[key]
    if word in HELD:
        return "inherit" if key in INHERITED else INITIAL[key]
    if word == "revert-layer":
        return word if key in SHOWN else UNSURE
    return _MEANINGS[key](tinycss2.parse_component_value_list(word), word)


def _word(tokens: Iterable[Any]) -> str:
    """The word that a value consists of; or empty."""
    known = [token for token in tokens if token.type not in ("whitespace", "comment")]
    return known[0].lower_value if len(known) == 1 and known[0].type == "ident" else ""


def _display(tokens: Sequence[Any], word: str) -> str:
    if DISPLAYS.fullmatch(word):
        return "none" if word == "none" else "inline"
    return " ".join(_written([one]) for one in tokens)  # whether it is valid is not known


def _visibility(_: Sequence[Any], word: str) -> str:
    return {"visible": "visible", "hidden": "hidden", "collapse": "hidden"}.get(word, "")


def _opacity(tokens: Sequence[Any], _: str) -> str:
    if len(tokens) != 1 or tokens[0].type not in ("number", "percentage"):
        return ""
    return "1" if tokens[0].value > 0.0 else "0"


def _width(tokens: Sequence[Any], _: str) -> str:
    first = tokens[0]
    if len(tokens) != 1 or first.type not in ("number", "percentage", "dimension"):
        return ""
    return "" if first.value < 0.0 else "1" if first.value > 0.0 else "0"


def _paint(tokens: Sequence[Any], word: str) -> str:
    """``none``, also for a colour that is seen through, ``black`` for other paints, or unsure."""
    if word == "none":
        return "none"
    first, *others = tokens
    if word in ANOTHER_PAINT:
        return UNSURE
    if first.type == "url":
        return "black"
    colour = None if others else tinycss2.color4.parse_color(first)
    if colour is None:  # a function that is not known may be a colour
        return UNSURE if first.type == "function" else ""
    return UNSURE if colour == "currentcolor" else "black" if colour.alpha else "none"


_MEANINGS = {
    "display": _display, "visibility": _visibility, "opacity": _opacity, "fill": _paint,
    "stroke": _paint, "fill-opacity": _opacity, "stroke-opacity": _opacity, "stroke-width": _width,
}  # fmt: skip


def _refers(tokens: Sequence[Any]) -> bool:
    """Whether a value depends on others, however deep in it."""
    left = [*tokens]
    while left:
        token = left.pop()
        if token.type == "function":
            if token.lower_name in REFERS:
                return True
            left += token.arguments
        elif token.type in ("() block", "[] block", "{} block"):
            left += token.content
    return False


def _written(tokens: Iterable[Any]) -> str:
    """Tokens as text in one line, without comments; empty where they nest beyond all reason."""
    try:
        return " ".join(tinycss2.serialize([t for t in tokens if t.type != "comment"]).split())
    except RecursionError:
        return ""
