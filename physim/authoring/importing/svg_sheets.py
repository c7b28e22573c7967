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
COMMENT = re.compile(r"/\*.*?(?:\*/|\Z)", re.DOTALL)
MARKS = re.compile(r"[{};]")
MEDIUM = re.compile(r"[a-z]+")
"""A kind of medium, without conditions"""
MOST_CLASSES = 20
"""Classes of an element that are looked up"""
IGNORED = "physim-ignored"
"""Attribute that tells of properties that a sheet has and that are not applied"""
LONGEST = 60
"""Characters of a value that are kept: those that count are shorter"""
MOST_SELECTORS = 400_000
"""Selectors of all style sheets"""
PAINTS = ("fill", "stroke")
"""Properties by which a shape is seen"""
SHOWN = ("display", "visibility", "opacity")
"""Properties by which an element is shown or hidden"""
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
        self.is_too_much = False
        """whether there are more selectors than are looked at"""
        self.shows = ""
        """the first selector that is not followed and says what is shown"""
        self.may_paint = False
        """whether a rule that is not followed says of elements how they are painted"""

    def add(self, text: str) -> None:
        """Take the rules of one more sheet, after all those before."""
        for selector, body in rules(text):
            last = {
                (key, is_important): value[:LONGEST]
                for key, value, is_important in declared(body)
                if key in self._keys
            }
            found = [(key, value, is_important) for (key, is_important), value in last.items()]
            parts = [selector] if selector.startswith("@") else selector.split(",")
            for one in {part.strip(): None for part in parts} if found else ():
                if self._count >= MOST_SELECTORS:
                    self.is_too_much = True
                    return
                if SELECTOR.fullmatch(one):
                    self._put(one, found)
                else:
                    self.may_paint |= any(key in PAINTS for key, _, _ in found)
                    if any(key in SHOWN for key, _, _ in found):
                        self.shows = self.shows or one

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
    """Selectors and declarations of a style sheet; linear in its length.

    Rules that hold on a condition have it before their selectors, as in
    ``@media (min-width: 9px) .a``, so that they are not followed; those for other media than
    `SCREEN` are left out.
    """
    text = COMMENT.sub("", text.replace("<!--", "").replace("-->", ""))
    found: list[tuple[str, str]] = []
    about: list[str] = []  # what stands before each brace that is open
    begin = 0
    for mark in [*MARKS.finditer(text), None]:
        at = text[mark.start()] if mark else "}"
        part = text[begin : mark.start() if mark else None]
        if at == "{":
            about.append(part.strip())
        elif at == "}" and about:
            selector = about.pop()
            if not selector.startswith("@") and (before := _condition(about)) is not None:
                found.append((before + selector, part))
        elif at == ";" and about and not about[-1].startswith("@"):
            continue
        begin = mark.end() if mark else begin
    return found


def _condition(about: list[str]) -> str | None:
    """On what condition the rules of some blocks hold, with a space after it; None if on none."""
    told = ""
    for one in about:
        if one.startswith("@media"):
            kinds = (part.strip() for part in one[6:].lower().split(","))
            media = {kind.removeprefix("only ").strip() for kind in kinds}
            if media & {*SCREEN}:
                continue
            if all(MEDIUM.fullmatch(part) for part in media):
                return None
        if "keyframes" in one.partition(" ")[0]:
            return None
        told += f"{one} "
    return told


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
