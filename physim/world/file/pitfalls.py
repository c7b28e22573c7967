"""Pitfalls of YAML: scalars that readers take differently, and what a broken text lacks.

YAML 1.1 and 1.2 disagree over ``yes``, ``010``, ``1:30``, ``1e3`` and others; each is refused
and how to write what is meant, whether a number or a text is wanted.

A parser gives up where it can read no further, often lines behind the mistake: at the key after
a bracket that was never closed, or at the colon after a line without one. Here the mistake
itself is looked for; where none of the usual ones is found, the parser's own words stand.
"""

from __future__ import annotations

import math
import re
import unicodedata
from typing import NamedTuple

import yaml

MOST_DIGITS = 18

_WHOLE = re.compile(r"[-+]?(?:0|[1-9][0-9]*)")
_DECIMAL = re.compile(r"[-+]?(?:[0-9]+\.[0-9]*|\.[0-9]+)(?:[eE][-+][0-9]+)?")
_EXPONENT = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)[eE][-+]?[0-9]+")
_OCTAL = re.compile(r"[-+]?0[0-9_]+|[-+]?0o[0-7_]+")
_OTHER_BASE = re.compile(r"[-+]?0[xX][0-9a-fA-F_]+|[-+]?0[bB][01_]+")
_GROUPED = re.compile(r"[-+]?[0-9][0-9_]*_[0-9_]*(?:\.[0-9_]*)?(?:[eE][-+]?[0-9]+)?")
_SEXAGESIMAL = re.compile(r"[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+(?:\.[0-9_]*)?")
_DATE = re.compile(r"[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}(?:(?:[Tt]|[ \t]+)[0-9]{1,2}:.*)?")
_NOT_FINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_NULL = {"", "~", "null", "Null", "NULL"}
_TRUE = {"true", "True", "TRUE"}
_FALSE = {"false", "False", "FALSE"}
_YES = {"yes", "on"}
_NO = {"no", "off"}
EMPTY = "empty value"
TOO_LARGE = "a number too large to hold; it must be finite"


class RefusedScalarError(Exception):
    """A scalar that may be read in several ways; the text says how to write it."""


def scalar(text: str) -> bool | int | float | str:
    """Value of a plain (unquoted) scalar.

    Raises `RefusedScalarError` where it is empty, not finite, too long, or read differently by
    other readers.
    """
    if text[:1] in "+-.0123456789":
        return _number(text)
    if text in _NULL:
        raise RefusedScalarError(EMPTY)
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if text.lower() in _YES | _NO:
        word = "true" if text.lower() in _YES else "false"
        raise RefusedScalarError(
            f'{text} may be read as {word}; write {word}, or "{text}" for a text'
        )
    return text


def _number(text: str) -> int | float | str:
    if not text:
        raise RefusedScalarError(EMPTY)
    if _WHOLE.fullmatch(text):
        digits = len(text.lstrip("+-"))
        if digits > MOST_DIGITS:
            raise RefusedScalarError(
                f"an integer of {digits} digits; at most {MOST_DIGITS} are allowed"
            )
        return int(text)
    if _DECIMAL.fullmatch(text):
        value = float(text)
        if not math.isfinite(value):
            raise RefusedScalarError(TOO_LARGE)
        return value
    reason = _pitfall(text)
    if reason:
        raise RefusedScalarError(reason)
    return text


def _pitfall(text: str) -> str:
    """Why a text that looks like a number is refused; empty where it is a text for everybody."""
    brief = text if len(text) <= 40 else text[:40] + "…"
    if _NOT_FINITE.fullmatch(text):
        return f"{brief} is not a finite number; finite ones are allowed"
    if _EXPONENT.fullmatch(text) and not math.isfinite(float(text)):
        return TOO_LARGE
    if _EXPONENT.fullmatch(text):
        return f"{brief} is a text to many YAML readers; write {_with_dot(text)}"
    if _OCTAL.fullmatch(text):
        return f"{brief} may be read as octal; write it without leading zeros"
    if _OTHER_BASE.fullmatch(text):
        digits = text.replace("_", "")
        meant = str(int(digits, 0)) if len(text) < 18 and digits[-1] not in "xXbB" else "it"
        return f"{brief} is not decimal; write {meant}" + (" in decimal" if meant == "it" else "")
    if _GROUPED.fullmatch(text):
        return f"{brief} has underscores; write {brief.replace('_', '')}"
    if _SEXAGESIMAL.fullmatch(text):
        return f'{brief} may be read in base 60; write a plain number, or "{brief}" for a text'
    if _DATE.fullmatch(text):
        return f'{brief} may be read as a date; write "{brief}" for a text'
    return ""


def _with_dot(text: str) -> str:
    """``1.0e+3 or 1000`` for ``1e3``."""
    mantissa, _, exponent = text.lower().partition("e")
    if len(text) > 40:
        return "it with a dot and a signed exponent, as 1.0e+3"
    whole = mantissa if "." in mantissa else f"{mantissa}.0"
    signed = exponent if exponent[0] in "+-" else f"+{exponent}"
    value = float(text)
    plain = f" or {value:.15g}" if 1e-4 <= abs(value) < 1e15 else ""
    return f"{whole}e{signed}{plain}"


_NO_SPACE = re.compile(r"^[ ]*(?:-[ ]+)*(?P<key>[A-Za-z_][A-Za-z_0-9]*):[^\s:/\\].*$")
_NO_SPACE_AFTER_DASH = re.compile(r"^[ ]*-(?P<key>[A-Za-z_][A-Za-z_0-9]*)(?::(?=\s|$)|$)")
_CLOSING = {"[": "]", "{": "}"}
_KEYS_AFTER = 3
"""Lines before the place where a parser gave up in which a missing space is looked for."""


class SyntaxHint(NamedTuple):
    """A mistake and its place, line and column from 1."""

    line: int
    column: int
    message: str


def syntax_hint(error: yaml.YAMLError, text: str) -> SyntaxHint:
    """Say what is wrong with a text at which PyYAML raised ``error``, in one line."""
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    problem = str(getattr(error, "problem", None) or str(error).splitlines()[0])
    context = getattr(error, "context", None)
    begun = getattr(error, "context_mark", None)
    line, column = (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)
    opened = (begun.line + 1, begun.column + 1) if begun is not None else None
    lines = text.splitlines() or [""]
    found = (
        _early_end(lines, line, column)
        or _bracket(problem, lines, (line, column), opened)
        or _quote(context, problem, opened)
        or _missing_space_after_dash(lines, line)
    )
    if found is None and ("mapping values" in problem or "':'" in problem):
        found = _missing_space(lines, line, opened) or _look_alike(lines, line, opened)
    if found is not None:
        return found
    since = ""
    if context and "next token" not in context:
        since = f" {context}" + (f" that begins on line {opened[0]}" if opened is not None else "")
    return SyntaxHint(line, column, f"{problem}{since}{_advice(problem, lines, line, column)}")


def missing_space(text: str) -> str:
    """The key in a text like ``step:0.01``, which YAML takes for one word; "" in all others."""
    found = _NO_SPACE.match(text)
    return found["key"] if found else ""


def missing_colon(key: str) -> str:
    """What to write for a key like ``gain 0.05``, which stands in braces; "" for all others."""
    word, _, value = key.partition(" ")
    if not word.isidentifier() or not value.strip():
        return ""
    return f'a colon is missing after the key; write "{word[:40]}: {value.strip()[:40]}"'


def missing_space_after_dash(text: str) -> str:
    """What to write for a key like ``-name``, a word of its own to YAML; "" for all others."""
    found = _NO_SPACE_AFTER_DASH.match(text)
    return f'a space is missing after the dash; write "- {found["key"][:40]}: …"' if found else ""


def _bracket(
    problem: str, lines: list[str], at: tuple[int, int], opened: tuple[int, int] | None
) -> SyntaxHint | None:
    """A list or mapping in brackets that is not closed, or that lacks a comma."""
    flow = "',' or ']'" in problem or "',' or '}'" in problem
    is_dash = "block sequence entries are not allowed" in problem
    if is_dash:
        opened, flow = _innermost_open(lines, at), True
    if not flow or opened is None:
        return None
    bracket = _character(lines, *opened)
    if bracket not in _CLOSING:
        return None
    line, column = at
    here = _character(lines, line, column)
    before = (lines[line - 1] if line <= len(lines) else "")[: column - 1]
    if here == ":" and (
        key := re.search(r"[\w.]+\s*$", before)
    ):  # the parser points at the colon, the mistake is before the key
        column, before = key.start() + 1, before[: key.start()]
    is_within = before.strip(" -") != ""
    if here in "]}" and here:
        return SyntaxHint(
            *opened,
            f'"{bracket}" opened here is closed by "{here}" at {line}:{column}; '
            f'close it with "{_CLOSING[bracket]}"',
        )
    if not is_dash and (here in ("[", "{", '"', "'") or is_within):
        return SyntaxHint(
            line, column, f'a comma is missing before this, in the "{bracket}" opened at '
            f"{opened[0]}:{opened[1]}",
        )  # fmt: skip
    end = f"before line {line}" if line <= len(lines) else "by the end of the text"
    return SyntaxHint(
        *opened, f'"{bracket}" opened here is not closed {end}; add "{_CLOSING[bracket]}"'
    )


def _innermost_open(lines: list[str], at: tuple[int, int]) -> tuple[int, int] | None:
    """Place of the last bracket before ``at`` that is not closed; None without any."""
    stack: list[tuple[int, int]] = []
    for number, line in enumerate(lines[: at[0]], start=1):
        for column, sign in enumerate(_bare(line), start=1):
            if (number, column) >= at:
                break
            if sign in _CLOSING:
                stack.append((number, column))
            elif sign in "]}" and stack:
                stack.pop()
    return stack[-1] if stack else None


def _bare(line: str) -> str:
    """A line with quoted texts and its comment blanked out, of the same length."""
    blank = re.sub(r"\"(?:[^\"\\]|\\.)*\"|'[^']*'", lambda text: " " * len(text[0]), line)
    return re.sub(r"(?:^|(?<=\s))#.*$", lambda text: " " * len(text[0]), blank)


def _quote(context: object, problem: str, opened: tuple[int, int] | None) -> SyntaxHint | None:
    if "quoted scalar" in str(context) and "unexpected" in problem and opened is not None:
        return SyntaxHint(*opened, "the quote opened here is not closed; add one at the end of it")
    return None


def _early_end(lines: list[str], line: int, column: int) -> SyntaxHint | None:
    """A quoted text that ends at a quote within it: ``'it's'``."""
    text = lines[line - 1] if line <= len(lines) else ""
    if not re.match(r"[\w.;!?&/()+-]", _character(lines, line, column)):
        return None
    for quoted in re.finditer(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^']|'')*'", text):
        if quoted.end() == column - 1:
            inside, other = ("''", "double") if quoted[0][0] == "'" else ('\\"', "single")
            return SyntaxHint(
                line, quoted.start() + 1, f"the text in quotes that begins here ends at "
                f"{line}:{column - 1} already; within it write {inside} for the quote, or put "
                f"the text in {other} quotes",
            )  # fmt: skip
    return None


def _look_alike(lines: list[str], line: int, opened: tuple[int, int] | None) -> SyntaxHint | None:
    """A character that looks like a sign of YAML and is none: a no-break space, a wide colon."""
    first = opened[0] if opened is not None else line
    for number in range(max(first, 1), min(line, len(lines)) + 1):
        for column, sign in enumerate(_bare(lines[number - 1]), start=1):
            plain = unicodedata.normalize("NFKC", sign)
            if sign != plain and len(plain) == 1 and plain in " :,[]{}#-":
                return SyntaxHint(
                    number, column, f"U+{ord(sign):04X} ({unicodedata.name(sign, '?').lower()}) "
                    f'stands here for "{plain}"; type a plain "{plain}"',
                )  # fmt: skip
    return None


def _missing_space(
    lines: list[str], line: int, opened: tuple[int, int] | None
) -> SyntaxHint | None:
    """A key whose colon is not followed by a space, in the lines before the parser gave up."""
    first = min(opened[0] if opened is not None else line, line - _KEYS_AFTER)
    for number in range(max(first, line - 2 * _KEYS_AFTER, 1), min(line, len(lines)) + 1):
        found = _NO_SPACE.match(_bare(lines[number - 1]))
        if found:
            key, column = found["key"], found.end("key") + 1
            return SyntaxHint(
                number, column, f'a space is missing after the colon; write "{key[:40]}: …"'
            )
    return None


def _missing_space_after_dash(lines: list[str], line: int) -> SyntaxHint | None:
    """An entry of a list whose dash is not followed by a space, where the parser gave up."""
    for number in range(min(line, len(lines)), max(line - 2, 0), -1):
        text = _bare(lines[number - 1])
        if message := missing_space_after_dash(text):
            return SyntaxHint(number, text.index("-") + 2, message)
    return None


def _advice(problem: str, lines: list[str], line: int, column: int) -> str:
    """What to do about a mistake that the parser itself describes well enough."""
    if _character(lines, line, column) == "\t":
        return "; tabs separate nothing here, use spaces"
    if "mapping values are not allowed" in problem:
        return '; put a text that holds ": " in quotes, and indent keys of one mapping alike'
    if re.search("expected (?:key|'-')", problem) or "expected <block end>" in problem:
        return "; indent keys of one mapping, and the dashes of one list, alike"
    if "cannot start any token" in problem:
        return "; put the text in quotes"
    if "':'" in problem:
        return "; a key is followed by a colon and a space"
    return ""


def _character(lines: list[str], line: int, column: int) -> str:
    """The character at a place; empty behind the end of its line or of the text."""
    return lines[line - 1][column - 1 : column] if 1 <= line <= len(lines) else ""
