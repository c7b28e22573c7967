"""Lines of SVG shapes: strict numbers and lengths, outlines as path data, chords of curves."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import acos, ceil, isfinite, pi, sqrt

import numpy as np
import svgelements

from physim.geometry.shapes import FloatArray

MOST_POINTS = 50_000
"""Points of one shape"""
MOST_CHORDS = 10_000
"""Chords of one curve"""
CLOSED = 1e-3
"""[-] of its extent by which the ends of a line are apart at most that is closed by hand"""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", re.A)
FLAG = re.compile(r"[01]")
GAP = re.compile(r"\s*(?:,\s*(?=[^\s,]))?", re.A)
COMMANDS = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])")
TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
PIXELS = {"": 1.0, "px": 1.0, "mm": 96.0 / 25.4, "cm": 96.0 / 2.54, "in": 96.0, "pt": 4.0 / 3.0,
          "pc": 16.0}  # fmt: skip
"""User units of a unit of length"""


def numbers(text: str, kinds: str = "n") -> list[float]:
    """Numbers of a text, in which gaps and single commas part them; ValueError for others.

    ``kinds``, over and over: ``n`` for a number, ``f`` for a flag of path data.
    """
    text, at, found = text.strip(), 0, list[float]()
    while at < len(text):
        form = FLAG if kinds[len(found) % len(kinds)] == "f" else NUMBER
        one = form.match(text, at)
        if one is None:
            wanted = "the flag 0 or 1" if form is FLAG else "a number"
            raise ValueError(f'"{text[at : at + 20]}" cannot be read: {wanted} is needed')
        if not isfinite(value := float(one[0])):
            raise ValueError(f'"{one[0][:40]}" is too large a number')
        found.append(value)
        gap = GAP.match(text, one.end())
        at = gap.end() if gap else one.end()
    return found


def length(text: str) -> float:
    """A length in user units; ValueError for one in percent or units of a font."""
    found = NUMBER.match(text := text.strip())
    unit = text[found.end() :].strip().lower() if found else None
    if found is None or unit not in PIXELS or not isfinite(float(found[0])):
        units = ", ".join(one for one in PIXELS if one)
        raise ValueError(f'"{text[:40]}": a number is needed, alone or with {units}')
    return float(found[0]) * PIXELS[unit]


def outline(tag: str, values: Mapping[str, str]) -> str:
    """Path data of a shape by its tag and attributes; ValueError for what cannot be read."""
    if tag == "path":
        return values.get("d", "")
    if tag in ("polyline", "polygon"):
        points = numbers(values.get("points", ""))
        if len(points) % 2:
            raise ValueError(f"points: {len(points)} numbers; they come in pairs x,y")
        joined = " ".join(map(repr, points))
        return f"M{joined}{'z' if tag == 'polygon' else ''}" if points else ""

    def of(key: str, other: str = "0") -> float:
        try:
            value = length(values.get(key, other))
        except ValueError as error:
            raise ValueError(f"{key}={error}") from None
        if value < 0.0 and key in ("width", "height", "r", "rx", "ry"):
            raise ValueError(f'{key}="{values[key][:40]}": must not be negative')
        return value

    if tag == "line":
        return f"M{of('x1')!r} {of('y1')!r} {of('x2')!r} {of('y2')!r}"
    if tag == "rect":
        x, y, width, height = of("x"), of("y"), of("width"), of("height")
        round_x, round_y = of("rx", values.get("ry", "0")), of("ry", values.get("rx", "0"))
        rect = svgelements.Rect(x, y, width, height, round_x, round_y)
        return str(rect.d()) if width * height else ""
    x, y = of("cx"), of("cy")
    rx = of("r") if tag == "circle" else of("rx", values.get("ry", "0"))
    ry = rx if tag == "circle" else of("ry", values.get("rx", "0"))
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return f"M{x - rx!r} {y!r}{arc} {x + rx!r} {y!r}{arc} {x - rx!r} {y!r}z" if rx * ry else ""


def subpaths(data: str, tolerance: float) -> list[tuple[FloatArray, bool]]:
    """Polylines (n, 2) of path data, and whether each is closed, its first point repeated.

    No chord is farther than ``tolerance`` from its curve; all in user units. Raises ValueError
    for data that do not follow the standard, and for too many points.
    """
    try:
        path = svgelements.Path(_strict(data))
    except ArithmeticError:
        raise ValueError("path data: a radius is too near to 0") from None
    found: list[tuple[FloatArray, bool]] = []
    line: list[FloatArray] = []
    count = 0

    def finish(closed: bool) -> None:
        if len(line) > 1:
            points = np.vstack(line)
            apart = np.hypot(*(points[0] - points[-1]))
            closed = closed or (len(points) > 3 and apart < CLOSED * np.ptp(points, axis=0).max())
            if closed and apart > 0.0:
                points = np.vstack([points, points[:1]])
            found.append((points, bool(closed)))
        line.clear()

    for one in path:
        end = np.array([one.end.x, one.end.y])
        if isinstance(one, svgelements.Move):
            finish(False)
            line.append(end[None])
        elif isinstance(one, svgelements.Close):
            finish(True)
        else:
            if not line:
                line.append(np.array([[one.start.x, one.start.y]]))
            inner = np.arange(1, chords := _chords(one, tolerance)) / chords
            line.extend((one.npoint(inner), end[None]) if chords > 1 else (end[None],))
            count += chords
        if count > MOST_POINTS:
            raise ValueError(f"more than {MOST_POINTS} points; use a larger --tolerance, check "
                             "--scale, or simplify the drawing")  # fmt: skip
    finish(False)
    return found


def _strict(data: str) -> str:
    """Path data that follow the standard, every number apart; ValueError for others.

    Between curves of two kinds stands a line of no length: the second goes on from the point.
    """
    before, *pieces = COMMANDS.split(data.strip())
    if before or (pieces and pieces[0] not in "Mm"):
        raise ValueError(f'path data begin with M, not "{data.strip()[:20]}"')
    words, count, last = list[str](), 0, ""
    for letter, text in zip(pieces[::2], pieces[1::2], strict=True):
        takes, is_arc = TAKES[letter.upper()], letter in "Aa"
        try:
            given = numbers(text, "nnnffnn" if is_arc else "n")
        except ValueError as error:
            raise ValueError(f"path data: {error}") from None
        if (len(given) % takes or not given) if takes else given:
            raise ValueError(f'path data: "{letter}" has {len(given)} numbers; it takes {takes}')
        count += len(given)
        if count > 2 * MOST_POINTS * max(takes, 1):
            raise ValueError(f"more than {MOST_POINTS} points; simplify the drawing")
        flags = (3, 4) if is_arc else ()
        if letter in "SsTt" and words and last not in (*("CS" if letter in "Ss" else "QT"), "M"):
            words.append("l 0 0")
        last = letter.upper()
        words += [letter, *(repr(int(v) if k % 7 in flags else v) for k, v in enumerate(given))]
    return " ".join(words)


def _chords(one: svgelements.PathSegment, tolerance: float) -> int:
    """How many chords keep within ``tolerance`` of a line, a Bézier curve or an arc."""
    if isinstance(one, svgelements.Arc):
        radius = max(float(one.rx), float(one.ry))
        if one.start == one.end or min(one.rx, one.ry) == 0.0:
            return 1
        turn = acos(max(1.0 - tolerance / radius, -1.0)) if radius > tolerance else pi / 2.0
        chords = abs(float(one.sweep)) / (2.0 * turn) if turn > 0.0 else float(MOST_CHORDS)
    elif isinstance(one, svgelements.Line):
        return 1
    else:
        controls = np.array([(p.x, p.y) for p in one if p is not None])
        bend = float(np.hypot(*np.diff(controls, 2, axis=0).T).max())
        chords = sqrt((len(controls) - 1) * (len(controls) - 2) * bend / (8.0 * tolerance))
    if not isfinite(chords):
        raise ValueError("a coordinate is not a finite number")
    return min(max(ceil(chords), 1), MOST_CHORDS)
