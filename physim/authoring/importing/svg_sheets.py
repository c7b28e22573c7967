"""Style sheets of an SVG drawing: what their rules say of an element, by the cascade of CSS.

Of several rules for a property that with the more specific selector counts, of equal ones the last;
``style="..."`` comes before them, what is ``!important`` before that, and attributes of the same
name come last. Selectors that name more than a tag, a class or an id are not followed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from xml.parsers import expat

SELECTOR = re.compile(r"\*|#[\w-]+|[\w-]*\.[\w-]+|[\w-]+")
"""What is followed: a tag, a class, both, or an id."""
MOST_CLASSES = 20
"""Classes of an element that are looked up"""
IGNORED = "physim-ignored"
"""Attribute that tells of properties that a sheet has and that are not applied"""
SCREEN = ("", "all", "screen")
"""Media for which a drawing is read"""


class Sheets:
    """Rules that say something of some properties, by their selectors.

    ``keys`` are properties that count; ``ignored`` those that are not applied, but told.
    """

    def __init__(self, keys: tuple[str, ...], ignored: tuple[str, ...] = ()) -> None:
        self._keys, self._ignored = (*keys, *ignored), ignored
        self._rules: dict[str, dict[str, tuple[tuple[bool, int, int], str]]] = {}
        self._count = 0

    def add(self, text: str) -> None:
        """Take the rules of one more sheet, after all those before."""
        for selector, body in rules(text):
            found = [
                (key, value, is_important)
                for key, value, is_important in declared(body)
                if key in self._keys
            ]
            for one in {part.strip(): None for part in selector.split(",")} if found else ():
                if SELECTOR.fullmatch(one):
                    self._put(one, found)

    def _put(self, selector: str, found: list[tuple[str, str, bool]]) -> None:
        known = self._rules.setdefault(selector, {})
        self._count += 1
        specificity = 100 * selector.count("#") + 10 * selector.count(".")
        specificity += selector[0] not in "#.*"
        for key, value, is_important in found:
            rank = (is_important, specificity, self._count)
            if key not in known or rank >= known[key][0]:
                known[key] = rank, value

    def styled(self, tag: str, attributes: dict[str, str]) -> dict[str, str]:
        """Attributes of an element, with what the rules say of it in its ``style``; those that are
        not applied in `IGNORED`."""
        attributes = {key: value for key, value in attributes.items() if key != IGNORED}
        if not self._rules:
            return attributes
        names = [f".{one}" for one in classes_of(attributes)]
        best: dict[str, tuple[tuple[bool, int, int], str]] = {}
        for name in ("*", tag, *names, *(tag + one for one in names), f"#{attributes.get('id')}"):
            for key, found in self._rules.get(name, {}).items():
                best[key] = max(best.get(key, found), found)
        if told := " and ".join(key for key in self._ignored if best.pop(key, None)):
            attributes[IGNORED] = told
        if not best:
            return attributes
        own = attributes.get("style", "")
        first = [f"{key}:{value}" for key, (rank, value) in best.items() if not rank[0]]
        last = [f"{key}:{value}" for key, (rank, value) in best.items() if rank[0]]
        last += [f"{key}:{value}" for key, value, is_important in declared(own) if is_important]
        return {**attributes, "style": ";".join((*first, own, *last))}


def classes_of(attributes: dict[str, str]) -> tuple[str, ...]:
    """The classes of an element that are looked up, each once."""
    return tuple(islice(dict.fromkeys(attributes.get("class", "").split()), MOST_CLASSES))


def sheets_of(text: str, keys: tuple[str, ...], ignored: tuple[str, ...] = ()) -> Sheets:
    """Style sheets of an SVG text, wherever they stand in it. Of one that cannot be read, or that
    declares entities, those up to there: whoever reads it in whole says what is wrong."""
    found = Sheets(keys, ignored)
    if "style" not in text:
        return found
    parser = expat.ParserCreate("utf-8", namespace_separator="|")
    within: list[list[str]] = []

    def start(name: str, attributes: dict[str, str]) -> None:
        media = (one.strip().lower() for one in attributes.get("media", "").split(","))
        if name.rpartition("|")[2] == "style" and any(one in SCREEN for one in media):
            within.append([])

    def end(name: str) -> None:
        if name.rpartition("|")[2] == "style" and within:
            found.add("".join(within.pop()))

    def characters(part: str) -> None:
        if within:
            within[-1].append(part)

    def stop(*_: object) -> None:
        raise _EntityError

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.EntityDeclHandler = characters, stop
    with suppress(expat.ExpatError, _EntityError):
        parser.Parse(text.encode("utf-8"), True)
    return found


class _EntityError(Exception):
    """An entity is declared."""


def rules(text: str) -> list[tuple[str, str]]:
    """Selectors and declarations of a style sheet; linear in its length."""
    begun, *commented = text.replace("<!--", "").replace("-->", "").split("/*")
    text = begun + "".join(part.partition("*/")[2] for part in commented)
    parts = (part.rpartition("{") for part in text.split("}"))
    # before a selector may stand @charset and @import, which end with a semicolon
    return [(found.rpartition(";")[2].strip(), body) for found, opened, body in parts if opened]


def declared(style: str) -> Iterator[tuple[str, str, bool]]:
    """Declarations in their order: property, value, and whether it is ``!important``."""
    for one in style.split(";"):
        key, _, value = one.partition(":")
        value, _, mark = value.partition("!")
        if value.strip():
            yield key.strip().lower(), value.strip(), mark.strip().lower() == "important"


def declarations(style: str, keys: tuple[str, ...]) -> dict[str, str]:
    """Those of some properties, the last of each that is ``!important``, or else the last."""
    found: dict[str, tuple[bool, str]] = {}
    for key, value, is_important in declared(style):
        if is_important >= found.get(key, (False, ""))[0]:
            found[key] = is_important, value
    return {key: found[key][1] for key in keys if key in found}
