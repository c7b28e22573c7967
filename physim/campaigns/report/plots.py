"""Small plots as SVG, in the colours of the page: intervals on an axis, and distributions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physim.campaigns.outcomes import FloatArray
from physim.campaigns.report.markup import text

STEPS = (1.0, 2.0, 5.0)
BINS = 36
LARGEST, LEAST = 1e300, 1e-300
"""what a plot tells from infinity, and from 0: metrics of one's own may be any number"""
LEFT, BOTTOM, TOP = 42.0, 38.0, 8.0
"""[px] around a plot"""


@dataclass(frozen=True)
class Axis:
    """Values from ``low`` to ``high`` along ``length`` [px] from ``start``."""

    low: float
    high: float
    start: float
    length: float

    def at(self, value: float) -> float:
        """Place of a value [px]; what lies outside is put at the nearer end."""
        share = (min(max(value, self.low), self.high) - self.low) / (self.high - self.low)
        return round(self.start + share * self.length, 1)

    def ticks(self, count: int) -> list[float]:
        """At least two round values, about so many."""
        step = step_of((self.high - self.low) / count)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [k * step for k in range(first, last + 1)]


def drawable(values: FloatArray) -> FloatArray:
    """Values of which differences do not overflow: larger ones are put at `LARGEST`."""
    return np.clip(values, -LARGEST, LARGEST)


def step_of(least: float) -> float:
    """Return the smallest of 1, 2, 5, 10, 20 … and their tenths that is at least ``least``."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(s * power for s in (*STEPS, 10.0) if s * power >= least * (1.0 - 1e-9))


def written(value: float, step: float) -> str:
    """Tick with as many decimals as the step between ticks needs; never "-0"."""
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    value = 0.0 if abs(value) < step / 1e6 else value
    return f"{value:.{digits}f}".replace("-", "−")


def rate_axis(lows: Sequence[float], width: float) -> Axis:
    """Axis of rates up to 1, from the round value below all that is to be shown."""
    least = min([0.9, *lows])
    step = step_of((1.0 - least) / 4.0)
    return Axis(max(0.0, math.floor(least / step + 1e-9) * step), 1.0, 6.0, width - 12.0)


def rate_plot(share: float, low: float, high: float, axis: Axis, what: str) -> str:
    """A rate and its interval on an axis that all rows of a table have in common."""
    width, middle = axis.start * 2 + axis.length, 9.0
    x = [axis.at(value) for value in (low, high, share)]
    ticks = axis.ticks(4)
    ends = ticks[0], ticks[-1]
    lines = "".join(
        f'<line class="grid" x1="{axis.at(t)}" x2="{axis.at(t)}" y1="1" y2="17"/>' for t in ticks
    )
    labels = "".join(
        f'<text x="{axis.at(t)}" y="31" text-anchor="{anchor}">{100 * t:.4g} %</text>'
        for t, anchor in zip(ends, ("start", "end"), strict=True)
    )
    dot = "" if math.isnan(share) else f'<circle class="dot" cx="{x[2]}" cy="{middle}" r="4"/>'
    return (
        f'<svg viewBox="0 0 {width:g} 35" width="{width:g}" role="img" aria-label="{text(what)}">'
        f'{lines}<line class="line" x1="{x[0]}" x2="{x[1]}" y1="{middle}" y2="{middle}"/>'
        f"{dot}{labels}</svg>"
    )


def spread_axis(values: FloatArray, width: float) -> Axis:
    """Axis that holds all values but the outermost in 1000, 0 included, with round ends."""
    known = drawable(values[~np.isnan(values)])
    low, high = (float(q) for q in np.quantile(known, [0.0, 0.999])) if len(known) else (0.0, 1.0)
    low, high = min(low, 0.0), max(high, 0.0)
    step = step_of(max(high - low, 1e-6) / 5.0)
    low, high = math.floor(low / step) * step, max(math.ceil(high / step), 1) * step
    return Axis(low, high, LEFT, width - LEFT - 10.0)


def distribution(
    values: FloatArray, axis: Axis, unit_text: str, what: str, height: float = 136.0
) -> str:
    """Histogram of values (K,) without nan: those below 0 in the colour of contacts.

    What lies beyond the axis is in its outermost bar. Upright: the share of runs.
    """
    edges = bin_edges(axis)
    counts, _ = np.histogram(np.clip(values, axis.low, np.nextafter(axis.high, -np.inf)), edges)
    shares = counts / max(1, len(values))
    up = step_of(max(float(shares.max(initial=0.0)), 1e-4) / 2.0)
    top = math.ceil(max(float(shares.max(initial=0.0)), 1e-4) / up - 1e-9) * up
    floor = height - BOTTOM

    def y(share: float) -> float:
        return round(floor - (floor - TOP) * share / top, 1)

    parts = []
    for tick in (k * up for k in range(round(top / up) + 1)):
        parts.append(
            f'<line class="grid" x1="{axis.start}" x2="{axis.start + axis.length}" '
            f'y1="{y(tick)}" y2="{y(tick)}"/><text x="{axis.start - 4}" y="{y(tick) + 4}" '
            f'text-anchor="end">{100 * tick:.3g}%</text>'
        )
    for share, left, right in zip(shares, edges, edges[1:], strict=False):
        if share:
            kind = "contact" if right <= 1e-12 else "free"
            x, wide = axis.at(left), axis.at(right) - axis.at(left)
            tall = max(1.0, floor - y(share))
            parts.append(
                f'<rect class="{kind}" x="{x + 0.5:.1f}" y="{floor - tall:.1f}" '
                f'width="{max(0.8, wide - 1):.1f}" height="{tall:.1f}"/>'
            )
    parts.append(_lower_axis(axis, floor, unit_text))
    if axis.low < 0.0:
        zero = axis.at(0.0)
        parts.append(f'<line class="zero" x1="{zero}" x2="{zero}" y1="{TOP}" y2="{floor}"/>')
    width = axis.start + axis.length + 10.0
    return (
        f'<svg class="whole" viewBox="0 0 {width:g} {height:g}" role="img" '
        f'aria-label="{text(what)}">{"".join(parts)}</svg>'
    )


def bin_edges(axis: Axis) -> FloatArray:
    """Edges of bars of equal width, one of which is 0 where the axis has it."""
    span = axis.high - axis.low
    below = round(BINS * max(0.0, -axis.low) / span)
    if 0.0 < -axis.low < span:
        below = min(max(below, 1), BINS - 1)
        return np.concatenate(
            [
                np.linspace(axis.low, 0.0, below + 1)[:-1],
                np.linspace(0.0, axis.high, BINS - below + 1),
            ]
        )
    return np.linspace(axis.low, axis.high, BINS + 1)


def _lower_axis(axis: Axis, floor: float, unit_text: str) -> str:
    ticks = axis.ticks(5)
    step = ticks[1] - ticks[0] if len(ticks) > 1 else 1.0
    labels = "".join(
        f'<text x="{axis.at(t)}" y="{floor + 16}" text-anchor="middle">{_short(t, step)}</text>'
        for t in ticks
    )
    return (
        f'<line class="axis" x1="{axis.start}" x2="{axis.start + axis.length}" y1="{floor}" '
        f'y2="{floor}"/>{labels}<text x="{axis.start + axis.length}" y="{floor + 33}" '
        f'text-anchor="end">{text(unit_text)}</text>'
    )


def shift_plot(value: float, low: float, high: float, unit: str, width: float, what: str) -> str:
    """A difference with its interval on an axis with 0 in the middle; an end beyond it is open."""
    finite = [min(abs(x), LARGEST) for x in (value, low, high) if math.isfinite(x)]
    most = max([0.0, *finite])
    most = (most if most >= 1e-6 else 1.0) * (1.0 if math.isfinite(low + high) else 1.5)
    step = step_of(most / 2.0)
    most = math.ceil(most / step - 1e-9) * step
    axis = Axis(-most, most, 8.0, width - 16.0)
    x = [axis.at(each) for each in (low, high, value)]
    zero = axis.at(0.0)
    labels = "".join(
        f'<text x="{axis.at(t)}" y="31" text-anchor="{anchor}">'
        f"{'+' if t > 0 else ''}{_short(t, step)} {text(unit)}</text>"
        for t, anchor in ((-most, "start"), (most, "end"))
    )
    return (
        f'<svg viewBox="0 0 {width:g} 35" width="{width:g}" role="img" aria-label="{text(what)}">'
        f'<line class="zero" x1="{zero}" x2="{zero}" y1="0" y2="19"/>'
        f'<line class="line" x1="{x[0]}" x2="{x[1]}" y1="9" y2="9"/>'
        f'<circle class="dot" cx="{x[2]}" cy="9" r="4"/>{labels}'
        f'<text x="{zero}" y="31" text-anchor="middle">0</text></svg>'
    )


LEAST_SPREAD = 0.01
"""[-] Share of the largest value that an axis has at least: its labels stay short"""
LONGEST_LABEL = 8
"""Characters of a label beyond which it is written with an exponent"""
DIGIT = 6.5
"""[px] width of one"""


def paired_plot(a: FloatArray, b: FloatArray, label: str, what: str, side: float = 270.0) -> str:
    """Pairs (K,) as points on equal axes, with the line on which both are the same."""
    a, b = drawable(a), drawable(b)
    low, high = float(min(a.min(), b.min())), float(max(a.max(), b.max()))
    spread = max(high - low, LEAST_SPREAD * max(abs(low), abs(high)))
    spread = spread if spread > LEAST else 1.0
    step = step_of(spread / 4.0)
    first = math.floor(low / step)
    last = max(math.ceil(high / step), first + 1)
    low, high = first * step, last * step
    labels = {k * step: _short(k * step, step) for k in range(first, last + 1)}
    left = max(44.0, 8.0 + DIGIT * max(map(len, labels.values())))
    axis = Axis(low, high, left, side - 10.0 - left)
    floor = axis.start + axis.length - 34.0

    def up(value: float) -> float:
        return round(floor - (axis.at(value) - axis.start), 1)

    parts = []
    for tick, label_text in labels.items():
        parts.append(
            f'<line class="grid" x1="{axis.at(low)}" x2="{axis.at(high)}" y1="{up(tick)}" '
            f'y2="{up(tick)}"/><line class="grid" x1="{axis.at(tick)}" x2="{axis.at(tick)}" '
            f'y1="{up(low)}" y2="{up(high)}"/><text x="{axis.start - 5}" y="{up(tick) + 4}" '
            f'text-anchor="end">{label_text}</text><text x="{axis.at(tick)}" '
            f'y="{floor + 15}" text-anchor="middle">{label_text}</text>'
        )
    parts.append(
        f'<line class="axis" x1="{axis.at(low)}" x2="{axis.at(high)}" y1="{up(low)}" '
        f'y2="{up(high)}"/>'
    )
    parts += [
        f'<circle class="point" cx="{axis.at(x)}" cy="{up(y)}" r="3"/>'
        for x, y in zip(a.tolist(), b.tolist(), strict=True)
    ]
    right = axis.start + axis.length
    parts.append(
        f'<text x="{right}" y="{floor + 31}" text-anchor="end">A: {text(label)}</text>'
        f'<text x="4" y="{up(high) - 8}">B: {text(label)}</text>'
    )
    return (
        f'<svg class="whole" viewBox="0 -12 {side:g} {floor + 48:g}" role="img" '
        f'aria-label="{text(what)}">{"".join(parts)}</svg>'
    )


def _short(value: float, step: float) -> str:
    """Tick as `written`, or with an exponent where that would be long."""
    plain = written(value, step)
    if len(plain) <= LONGEST_LABEL or value == 0.0:
        return plain
    return f"{value:.4g}".replace("-", "−").replace("e+", "e")
