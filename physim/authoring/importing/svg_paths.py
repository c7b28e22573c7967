"""Path data of an SVG drawing: what cannot be read as it stands, and what is read amiss."""

from __future__ import annotations

import re

from physim.authoring.importing.svg_values import NUMBER
from physim.errors import plural
from physim.escaping import escaped

TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
"""How many numbers each command takes, again and again but for Z."""
LETTERS = "".join(TAKES) + "".join(TAKES).lower()
COMMAND = re.compile(rf"([{LETTERS}])([^{LETTERS}]*)")
STRAY = re.compile(rf"[^{LETTERS},\s0]", re.A)
"""Of path data with noughts for its numbers"""
COMMA = re.compile(rf"[{LETTERS}]\s*,|,\s*(?=,|[{LETTERS}]|$)", re.A)
"""A comma that does not stand between two numbers"""
LARGEST, LEAST = 1e30, 1e-30
"""Numbers with which curves can be reckoned"""
GAP = re.compile(r"[\s,]*", re.A)
FLAG = re.compile("[01]")
FLAGS = (3, 4)
"""Which numbers of an arc are flags; no gap need stand after one."""
SMOOTH = (
    re.compile(rf"([QqTt][^{LETTERS}]*)(?=[Ss])"),
    re.compile(rf"([CcSs][^{LETTERS}]*)(?=[Tt])"),
)
"""A curve of one kind before a smooth one of the other."""


def path_fault(text: str) -> str:
    """What is wrong with path data, so that no two programs read it alike; else empty."""
    noughts = NUMBER.sub(lambda found: "0" * len(found[0]), text)
    if bad := STRAY.search(noughts):
        return f'"{escaped(text[bad.start() : bad.start() + 20])}" cannot be read'
    if bad := COMMA.search(noughts):
        shown = escaped(" ".join(text[bad.start() :].split())[:20])
        return f'"{shown}": a comma stands between two numbers alone'
    for number in NUMBER.findall(text):
        if not LEAST < abs(float(number) or 1.0) < LARGEST:
            return f'"{escaped(number)[:20]}" is too large, or too near to 0, to be drawn'
    if (start := text.strip()) and start[0] not in "Mm":
        return f'"{escaped(start[:20])}" must begin with M, a move'
    for found in COMMAND.finditer(text):
        letter, takes = found[1], TAKES[found[1].upper()]
        shown = f'"{escaped(" ".join(found[0].split())[:40])}"'
        if takes == TAKES["A"]:
            count, flag = _arcs(found[2])
            if flag:
                return (
                    f'{shown}: "{escaped(flag[:10])}" where an arc has a flag; the fourth and the '
                    "fifth of its seven numbers are 0 or 1"
                )
        else:
            count = len(NUMBER.findall(found[2]))
        if count % takes if takes and count else count != takes:
            more = f"{takes} or a multiple" if takes else "none"
            return f"{shown} has {plural(count, 'number')}; {letter} takes {more}"
    return ""


def _arcs(text: str) -> tuple[int, str]:
    """How many numbers the text of arcs has, and what stands where a flag should; else empty."""
    at = count = 0
    while (at := _after_gap(text, at)) < len(text):
        is_flag = count % TAKES["A"] in FLAGS
        found = (FLAG if is_flag else NUMBER).match(text, at)
        if found is None:
            return count, text[at:]
        at, count = found.end(), count + 1
    return count, ""


def _after_gap(text: str, at: int) -> int:
    found = GAP.match(text, at)
    return at if found is None else found.end()


def as_meant(text: str) -> str:
    """Path data that the library reads as the standard has it.

    It takes a smooth curve after one of the other kind to go on smoothly, which it does only after
    one of its own; a line of no length between them keeps them apart.
    """
    for pattern in SMOOTH:
        text = pattern.sub(r"\1l0,0", text)
    return text
