"""Values of plain scalars; those that YAML readers take differently are refused.

YAML 1.1 and 1.2 disagree over ``yes``, ``010``, ``1:30``, ``1e3`` and others; the refusal says how
to write what is meant, whether a number or a text is wanted.
"""

from __future__ import annotations

import math
import re

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
EMPTY = "empty value; give one, or leave the key out where it has a default"
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
        return f"{brief} is text, not a number, for many YAML readers; write {_with_dot(text)}"
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
