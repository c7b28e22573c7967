"""Lines of SVG shapes: strict numbers, path data, and chords of curves."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import acos, ceil, isfinite, pi, sqrt

import numpy as np
import svgelements

from physim.escaping import escaped
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
            raise ValueError(f'"{escaped(text[at : at + 20])}" cannot be read: {wanted} is needed')
        if not isfinite(value := float(one[0])):
            raise ValueError(f'"{escaped(one[0])[:40]}" is too large a number')
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
        raise ValueError(f'"{escaped(text)[:40]}": a number is needed, alone or with {units}')
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
            raise ValueError(f'{key}="{escaped(values[key])[:40]}": must not be negative')
        return value

    if tag == "line":
        return f"M{of('x1')!r} {of('y1')!r} {of('x2')!r} {of('y2')!r}"
    rx = of("rx", values.get("ry", "0")) if tag != "circle" else of("r")
    ry = of("ry", values.get("rx", "0")) if tag != "circle" else rx
    if tag != "rect":
        x, y = of("cx"), of("cy")
        arc = f"A{rx!r} {ry!r} 0 0 1"
        return f"M{x - rx!r} {y!r}{arc} {x + rx!r} {y!r}{arc} {x - rx!r} {y!r}z" if rx * ry else ""
    x, y, width, height = of("x"), of("y"), of("width"), of("height")
    if not width * height:
        return ""
    rx, ry = min(rx, width / 2.0), min(ry, height / 2.0)
    if not rx * ry:
        return f"M{x!r} {y!r}h{width!r}v{height!r}h{-width!r}z"
    right, below = x + width, y + height
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return (
        f"M{x + rx!r} {y!r}H{right - rx!r}{arc} {right!r} {y + ry!r}V{below - ry!r}"
        f"{arc} {right - rx!r} {below!r}H{x + rx!r}{arc} {x!r} {below - ry!r}V{y + ry!r}"
        f"{arc} {x + rx!r} {y!r}z"
    )


def subpaths(data: str, tolerance: float) -> list[tuple[FloatArray, bool]]:
    """Polylines (n, 2) of path data, and whether each is closed, its first point repeated.

    No chord is farther than ``tolerance`` from its curve; all in user units. Raises ValueError
    for data that do not follow the standard, and before there are too many points.
    """
    before, *pieces = COMMANDS.split(data.strip())
    found: list[tuple[FloatArray, bool]] = []
    line: list[FloatArray] = []
    at = start = handle = np.zeros(2)
    last, count = "", 0

    def finish(closed: bool) -> None:
        if len(line) > 1:
            points = np.vstack(line)
            apart = np.hypot(*(points[0] - points[-1]))
            closed = closed or (len(points) > 3 and apart < CLOSED * np.ptp(points, axis=0).max())
            if closed and apart > 0.0:
                points = np.vstack([points, points[:1]])
            found.append((points, bool(closed)))
        line.clear()

    if before or (pieces and pieces[0] not in "Mm"):
        raise ValueError(f'path data begin with M, not "{escaped(data.strip()[:20])}"')
    for letter, text in zip(pieces[::2], pieces[1::2], strict=True):
        kind, takes = letter.upper(), TAKES[letter.upper()]
        try:
            given = numbers(text, "nnnffnn" if kind == "A" else "n")
        except ValueError as error:
            raise ValueError(f"path data: {error}") from None
        if len(given) % takes if takes else given or text.strip():
            raise ValueError(f'path data: "{letter}" has {len(given)} numbers; it takes {takes}')
        if takes and not given:
            raise ValueError(f'path data: "{letter}" has no numbers; it takes {takes}')
        if not takes:
            finish(True)
            at, last = start, kind
            continue
        for row in np.reshape(given, (-1, takes)):
            if not line and kind != "M":
                line.append(at)
            if kind in "HV":
                axis = int(kind == "V")
                end = at.copy()
                end[axis] = row[0] + (at[axis] if letter.islower() else 0.0)
                points = end[None]
            else:
                bends = row[5:] if kind == "A" else row
                points = bends.reshape(-1, 2) + (at if letter.islower() else 0.0)
            end = points[-1]
            if kind == "M":
                finish(False)
                start, kind = end, "L"  # what follows are lines
                line.append(end)
            elif kind in "LHV":
                line.append(end)
            else:
                if kind in "ST":
                    smooth = 2.0 * at - handle if last in ("CS" if kind == "S" else "QT") else at
                    points = np.vstack([smooth, points])
                handle = points[-2] if kind != "A" else end
                chords = _arc(at, row, end, tolerance) if kind == "A" else _bend(
                    np.vstack([at, points]), tolerance)  # fmt: skip
                line.extend(chords)
                count += len(chords)
            count += 1
            if count > MOST_POINTS:
                raise ValueError(f"more than {MOST_POINTS} points; use a larger --tolerance, check "
                                 "--scale, or simplify the drawing")  # fmt: skip
            at, last = end, kind
    finish(False)
    return found


def _bend(controls: FloatArray, tolerance: float) -> list[FloatArray]:
    """Points after the first of a Bézier curve of control points (k + 1, 2)."""
    k = len(controls) - 1
    bend = float(np.hypot(*np.diff(controls, 2, axis=0).T).max())
    count = _count(sqrt(k * (k - 1) * bend / (8.0 * tolerance)))
    t = np.arange(1, count + 1)[:, None] / count
    points = [np.broadcast_to(one, (count, 2)) for one in controls]
    for _ in range(k):
        points = [(1.0 - t) * a + t * b for a, b in zip(points, points[1:], strict=False)]
    return [*points[0][:-1], controls[-1]]


def _arc(begin: FloatArray, row: FloatArray, end: FloatArray, tolerance: float) -> list[FloatArray]:
    """Points after the first of an arc, by the seven numbers of its command."""
    rx, ry = abs(row[0]), abs(row[1])
    if min(rx, ry) == 0.0 or (begin == end).all():
        return [end]
    if not min(rx, ry) > 1e-9 * float(np.abs(end - begin).max()):
        raise ValueError(f'path data: a radius of "{min(rx, ry):g}" is too near to 0')
    arc = svgelements.Arc(tuple(begin), rx, ry, row[2], int(row[3]), int(row[4]), tuple(end))
    radius = max(float(arc.rx), float(arc.ry))
    turn = acos(max(1.0 - tolerance / radius, -1.0)) if radius > tolerance else pi / 2.0
    count = _count(abs(float(arc.sweep)) / (2.0 * turn) if turn > 0.0 else float(MOST_CHORDS))
    inner = arc.npoint(np.arange(1, count) / count) if count > 1 else []
    return [*np.asarray(inner, dtype=float).reshape(-1, 2), end]


def _count(chords: float) -> int:
    if not isfinite(chords):
        raise ValueError("a coordinate is not a finite number")
    return min(max(ceil(chords), 1), MOST_CHORDS)
