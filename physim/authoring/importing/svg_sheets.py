"""Style of the elements of an SVG drawing, by the cascade of CSS.

Of several rules for a property that with the more specific selector counts, of equal ones the last;
``style="..."`` comes before them, what is ``!important`` before that, and attributes of the same
name come last. Selectors that name more than a tag, a class or an id are not followed; a style
sheet that hides or cuts by such ones is refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import lru_cache
from xml.parsers import expat

from physim.authoring.importing.svg_css import (
    AMOUNTS,
    CUTS,
    OTHER,
    PAINTS,
    PLACED,
    SHOWN,
    UNSEEN,
    WORDS,
    Declaration,
    Rule,
    declared,
    is_for_screen,
    meant,
    rules,
)
from physim.authoring.importing.svg_values import ORIGINS
from physim.escaping import escaped

MOST_CLASSES = 20
"""Classes of an element"""
MOST_SELECTORS = 100_000
"""Selectors of all style sheets"""
MOST_STYLE = 2_000_000
"""Characters of all style sheets and styles that are read, each different style once"""
PART = 50
"""Characters that take as long as to begin with a style"""
STYLES_KEPT = 10_000
"""Styles of elements that are not read again"""
BEYOND = "by more than a tag, a class or an id; delete what is hidden, or save as plain SVG"
IMPORT = re.compile(r"@import\b", re.IGNORECASE)
STYLES = ("style", "http://www.w3.org/2000/svg|style", "http://www.w3.org/1999/xhtml|style")
"""Elements that hold a style sheet"""

Rank = tuple[bool, int, int]
"""Whether it is important, how specific its selector, and its number in their order"""


class StyleError(Exception):
    """What is wrong with a style sheet, or with the style of an element."""


class Sheets:
    """What all rules of a drawing say, by their selectors, and with it what its elements are."""

    def __init__(self) -> None:
        self._rules: dict[str, dict[str, tuple[Rank, str]]] = {}
        self._count = self._length = 0
        self._hides = ""
        self.shows = ""
        """the first selector that is not followed and says what is shown"""
        self.imports = False
        """whether a sheet may refer to another file, which is not read"""
        self.other = ""
        """the first selector that is not followed and says what is not known"""
        self.may_paint = False
        """whether a rule that is not followed says of elements how they are painted"""
        self._declared = lru_cache(STYLES_KEPT)(self._declarations)
        self._meant = lru_cache(STYLES_KEPT)(self._meaning)

    def _declarations(self, style: str) -> tuple[Declaration, ...]:
        self._measure(style)
        return declared(style)

    def _meaning(self, key: str, value: str) -> str:
        self._measure(value)
        return meant(key, value)

    def _measure(self, text: str) -> None:
        self._length += len(text) + PART
        if self._length > MOST_STYLE:
            raise StyleError(f"more than {MOST_STYLE / 1e6:g} million characters of style")

    def add(self, text: str, condition: str = "") -> None:
        """Take the rules of one more sheet, after all those before. Raises StyleError.

        ``condition`` is that on which all of it holds, if any.
        """
        self._measure(text)
        self.imports |= IMPORT.search(text) is not None
        try:
            for rule in rules(text, condition):
                self._take(rule)
        except ValueError as error:
            raise StyleError(str(error)) from None
        if self._hides and self.shows:
            raise StyleError(f"{_quoted(self.shows)} may show what {self._hides} hides, {BEYOND}")

    def _take(self, rule: Rule) -> None:
        if not rule.found:
            return
        last = last_of(rule.found)
        if wrong := unread(last):
            raise _fault(rule, f"has {wrong}")
        hides, other = bool(hidden_by(last)), last.get(OTHER, "")
        if rule.is_followed:
            self._hides = self._hides or (_quoted(rule.selector) if hides else "")
        elif hides or any(key in last for key in (*CUTS, *PLACED, *ORIGINS)):
            raise _fault(rule, f"hides, cuts or moves what it selects, {BEYOND}")
        else:
            self.other = self.other or (other and f"{_quoted(rule.selector)} has a {other}")
            self.may_paint |= any(key in (*PAINTS, *AMOUNTS) for key in last)
            if any(key in SHOWN for key in last):
                self.shows = self.shows or rule.selector
        for name in rule.names:
            self._put(name, rule.found)

    def _put(self, selector: str, found: Iterable[Declaration]) -> None:
        known = self._rules.setdefault(selector, {})
        self._count += 1
        if self._count > MOST_SELECTORS:
            raise StyleError(f"more than {MOST_SELECTORS} selectors")
        is_id = selector[0] == "#"
        specificity = 100 if is_id else 10 * ("." in selector) + (selector[0] not in ".*")
        for key, value, is_important in found:
            rank = (is_important, specificity, self._count)
            if key not in known or rank >= known[key][0]:
                known[key] = rank, value

    def styled(self, tag: str, attributes: dict[str, str]) -> dict[str, str]:
        """Attributes of an element with all that counts of its style in ``style``.

        As ``key:value;key:value``, each property once. Raises StyleError.
        """
        attributes = {**attributes}
        for key in [one for one in UNSEEN if one in attributes]:
            value = self._meant(key, attributes.pop(key))
            attributes |= {key: value} if value else {}
        best = self._of_rules(tag, attributes)
        for key, value, is_important in self._declared(attributes.pop("style", "")):
            own = ((is_important, 1_000, 0), value)
            if key not in best or own[0] >= best[key][0]:
                best[key] = own
        style = {key: value for key, (_, value) in best.items()}
        if wrong := unread({**attributes, **style}):
            raise StyleError(f"its style has {wrong}")
        return {**attributes, "style": written(style)} if style else attributes

    def _of_rules(self, tag: str, attributes: dict[str, str]) -> dict[str, tuple[Rank, str]]:
        best: dict[str, tuple[Rank, str]] = {}
        if not self._rules:
            return best
        names = [f".{one}" for one in classes_of(attributes)]
        own = [f"#{attributes['id']}"] if "id" in attributes else []
        for name in ("*", tag, *names, *(tag + one for one in names), *own):
            for key, found in self._rules.get(name, {}).items():
                best[key] = max(best.get(key, found), found)
        return best


def _fault(rule: Rule, wrong: str) -> StyleError:
    return StyleError(f"{_quoted(rule.selector)} {wrong}")


def _quoted(selector: str) -> str:
    return f'"{escaped(selector)[:60]}"'


def unread(properties: dict[str, str]) -> str:
    """Which of them says whether something is shown in ways that are not read; or empty."""
    for key in SHOWN:
        if (value := properties.get(key, "none")) not in WORDS:
            return f"{key}: {escaped(value)[:40]}, which is not read; give it a plain value"
    return ""


def hidden_by(properties: dict[str, str]) -> str:
    """The property by which an element is hidden; or empty."""
    hiding = {"display": "none", "visibility": "hidden", "opacity": "0"}
    return next((key for key, value in hiding.items() if properties.get(key) == value), "")


def cut_of(properties: dict[str, str]) -> str:
    """By what an element of these properties is cut, or looks otherwise: ``clip-path and mask``."""
    given = [key for key in CUTS if properties.get(key, "none").strip().lower() != "none"]
    return " and ".join([*given, *([properties[OTHER]] if OTHER in properties else [])])


def last_of(found: Iterable[Declaration]) -> dict[str, str]:
    """What each property is in the end: the last that is ``!important``, or else the last."""
    best: dict[str, Declaration] = {}
    for one in found:
        if one.key not in best or one.is_important >= best[one.key].is_important:
            best[one.key] = one
    return {key: one.value for key, one in best.items()}


def written(style: dict[str, str]) -> str:
    """A style as `declarations` reads it."""
    return ";".join(f"{key}:{value}" for key, value in style.items() if ";" not in value)


def declarations(style: str, keys: tuple[str, ...]) -> dict[str, str]:
    """Those of some properties, of a style that is `written`; the last of each."""
    found = dict(one.split(":", 1) for one in style.split(";") if one)
    return {key: found[key] for key in keys if key in found}


def classes_of(attributes: dict[str, str]) -> tuple[str, ...]:
    """The classes of an element, each once. Raises StyleError for too many."""
    names = re.split(r"[ \t\r\n\f]+", attributes.get("class", ""))
    if len(names) > MOST_CLASSES:
        raise StyleError(f"has {len(names)} classes; at most {MOST_CLASSES} are allowed")
    return tuple(dict.fromkeys(name for name in names if name))


def sheets_of(text: str, wrong: Callable[[str, int], Exception]) -> Sheets:
    """Style sheets of an SVG text, wherever they stand in it.

    Of a text that cannot be read, or that declares entities, those up to there: whoever reads it
    in whole says what is wrong. Raises what ``wrong`` makes of a message and a line.
    """
    sheets = Sheets()
    if "style" not in text:
        return sheets
    within: list[tuple[str, list[str]]] = []

    def start(name: str, attributes: dict[str, str], line: int) -> None:
        if within:
            raise wrong("<style>: holds an element; browsers read the text beside it alone", line)
        media = attributes.get("media", "")
        on_screen = is_for_screen(media)
        is_css = attributes.get("type", "").lower() in ("", "text/css")
        if name in STYLES and is_css and attributes.get("title"):
            raise wrong("<style>: one of several, by its title; delete it or its title", line)
        if name in STYLES and is_css and on_screen is not False:
            within.append(("" if on_screen else f"@media {media} ", []))

    def end(name: str, line: int) -> None:
        if name in STYLES and within:
            condition, parts = within.pop()
            try:
                sheets.add("".join(parts), condition)
            except StyleError as error:
                raise wrong(f"<style>: {error}", line) from None

    def characters(part: str) -> None:
        if within:
            within[-1][1].append(part)

    look_ahead(text, start, end, characters)
    return sheets


def look_ahead(
    text: str,
    start: Callable[[str, dict[str, str], int], None],
    end: Callable[[str, int], None] = lambda *_: None,
    characters: Callable[[str], None] = lambda _: None,
) -> None:
    """Go through an SVG text; elements are told with their lines.

    One that cannot be read, or that declares entities, up to there: whoever reads it in whole says
    what is wrong.
    """
    parser = expat.ParserCreate("utf-8", namespace_separator="|")

    def stop(*_: object) -> None:
        raise _EntityError

    parser.StartElementHandler = lambda name, given: start(name, given, parser.CurrentLineNumber)
    parser.EndElementHandler = lambda name: end(name, parser.CurrentLineNumber)
    parser.CharacterDataHandler, parser.EntityDeclHandler = characters, stop
    with suppress(expat.ExpatError, _EntityError):
        parser.Parse(text.encode("utf-8"), True)


class _EntityError(Exception):
    """An entity is declared."""
