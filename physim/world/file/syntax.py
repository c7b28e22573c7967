"""What a text lacks that is no YAML.

A parser gives up where it can read no further, often lines behind the mistake: at the key after a
bracket that was never closed, or at the colon after a line without a blank. The usual mistakes are
looked for; where it is none of them, the parser's own words stand.
"""

from __future__ import annotations

import re

import yaml

_NO_SPACE = re.compile(r"^ *(?:- +)*(?P<key>[A-Za-z_]\w*):[^\s:/\\]")
_QUOTED = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'[^']*'")
_CLOSING = {"[": "]", "{": "}"}
_LINES_BEFORE = 3
"""Lines before the place where a parser gave up in which a missing space is looked for"""

Told = tuple[int, int, str]
"""Line and column, from 1, and message"""


def syntax_fault(error: yaml.YAMLError, text: str) -> Told:
    """Say what is wrong with a text at which PyYAML raised ``error``, in one line."""
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    begun = getattr(error, "context_mark", None)
    at = (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)
    opened = (begun.line + 1, begun.column + 1) if begun is not None else None
    problem = str(getattr(error, "problem", None) or str(error).splitlines()[0])
    context = str(getattr(error, "context", None) or "")
    lines = text.splitlines()
    if "nesting level" in problem or "nesting depth" in problem:
        return *at, "nested deeper than 50 levels"
    if "quoted scalar" in context and "unexpected" in problem and opened is not None:
        (line, column), message = opened, "the quote opened here is not closed; add one at its end"
    elif found := _bracket(problem, lines, at, opened) or _missing_space(problem, lines, at):
        line, column, message = found
    else:
        since = f" {context}" if context and "next token" not in context else ""
        since += f" that begins on line {opened[0]}" if since and opened is not None else ""
        (line, column), message = at, f"{problem}{since}{_advice(problem, lines, at)}"
    return line, column, f"not valid YAML: {message}"


def _bracket(
    problem: str, lines: list[str], at: tuple[int, int], opened: tuple[int, int] | None
) -> Told | None:
    """A list or mapping in brackets that is not closed, or that lacks a comma."""
    bracket = _character(lines, opened)
    if not re.search("',' or '[]}]'", problem) or opened is None or bracket not in _CLOSING:
        return None
    here = _character(lines, at)
    if here in ("]", "}"):
        wrong = f'"{bracket}" opened here is closed by "{here}" at {at[0]}:{at[1]}'
        return *opened, f'{wrong}; close it with "{_CLOSING[bracket]}"'
    before = "".join(lines[at[0] - 1 : at[0]])[: at[1] - 1]
    if here == ":" and (key := re.search(r"\w+\s*$", before)):  # the mistake is before the key
        at, before = (at[0], key.start() + 1), before[: key.start()]
    if here in ("[", "{", '"', "'") or before.strip(" -"):
        place = f"{opened[0]}:{opened[1]}"
        return *at, f'a comma is missing before this, in the "{bracket}" opened at {place}'
    end = f"before line {at[0]}" if at[0] <= len(lines) else "by the end of the text"
    return *opened, f'"{bracket}" opened here is not closed {end}; add "{_CLOSING[bracket]}"'


def _missing_space(problem: str, lines: list[str], at: tuple[int, int]) -> Told | None:
    """A key whose colon is not followed by a space, at or just before where the parser gave up."""
    if "mapping values" not in problem and "':'" not in problem:
        return None
    for number in range(max(at[0] - _LINES_BEFORE, 1), min(at[0], len(lines)) + 1):
        line = _QUOTED.sub(lambda quoted: " " * len(quoted[0]), lines[number - 1])
        if found := _NO_SPACE.match(line):
            message = f'a space is missing after the colon; write "{found["key"][:40]}: …"'
            return number, found.end("key") + 1, message
    return None


def _advice(problem: str, lines: list[str], at: tuple[int, int]) -> str:
    """What to do about a mistake that the parser itself describes well enough."""
    if _character(lines, at) == "\t":
        return "; tabs separate nothing here, use spaces"
    if "mapping values are not allowed" in problem:
        return '; put a text that holds ": " in quotes, and indent keys of one mapping alike'
    if re.search("expected (?:key|'-')|expected <block end>", problem):
        return "; indent keys of one mapping, and the dashes of one list, alike"
    if "':'" in problem:
        return "; a key is followed by a colon and a space"
    return "; put the text in quotes" if "cannot start any token" in problem else ""


def _character(lines: list[str], at: tuple[int, int] | None) -> str:
    """The character at a place; empty behind the end of its line or of the text."""
    return "" if at is None else "".join(lines[at[0] - 1 : at[0]])[at[1] - 1 : at[1]]
