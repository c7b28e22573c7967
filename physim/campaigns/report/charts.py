"""Small plots as SVG, in the colours of the page: intervals, distributions, pairs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from physim.campaigns.outcomes import FloatArray
from physim.drawing.labels import number, round_step
from physim.html import Html, tag
from physim.units import true_minus

BINS = 36
"""Bars of a distribution, about"""
LARGEST, LEAST = 1e300, 1e-300
"""what a plot tells from infinity, and from 0: metrics of one's own may be any number"""
LONGEST_LABEL = 8
"""Characters of a label beyond which it has an exponent"""


@dataclass(frozen=True)
class Axis:
    """Round values from ``low`` to ``high``, a tick every ``step``, along ``length`` [px]."""

    low: float
    high: float
    step: float
    start: float
    length: float

    @classmethod
    def around(cls, low: float, high: float, ticks: float, start: float, end: float) -> Axis:
        """Axis from ``start`` to ``end`` [px] that holds both values, with about so many ticks."""
        low, high = (min(max(value, -LARGEST), LARGEST) for value in (low, high))
        step = round_step(max(high - low, LEAST), ticks)
        first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
        return cls(first * step, max(last, first + 1) * step, step, start, end - start)

    def at(self, value: float) -> float:
        """Place of a value [px]; what lies outside is put at the nearer end."""
        share = (min(max(value, self.low), self.high) - self.low) / (self.high - self.low)
        return round(self.start + share * self.length, 1)

    @property
    def ticks(self) -> list[float]:
        """Round values, both ends among them."""
        first, last = round(self.low / self.step), round(self.high / self.step)
        return [k * self.step for k in range(first, last + 1)]

    def label(self, tick: float) -> str:
        """A tick with as many decimals as the step needs; with an exponent where that is long."""
        text = number(tick, self.step)
        if len(text) > LONGEST_LABEL and tick:
            text = true_minus(f"{tick:.4g}".replace("e+", "e"))
        return text


def _line(kind: str, x1: float, x2: float, y1: float, y2: float) -> Html:
    return tag("line", class_=kind, x1=x1, x2=x2, y1=y1, y2=y2)


def _text(words: str, x: float, y: float, anchor: str) -> Html:
    return tag("text", words, x=round(x, 1), y=round(y, 1), text_anchor=anchor)


def _framed(x: Axis, y: Axis, unit: str, *drawn: object, size: str, what: str) -> Html:
    """What is drawn on two axes, with a line at each tick of ``y`` and labels at all."""
    left, right, floor = x.start, x.start + x.length, y.start
    return tag(
        "svg",
        (_line("grid", left, right, y.at(t), y.at(t)) for t in y.ticks),
        (_text(f"{y.label(t)}{unit}", left - 4, y.at(t) + 4, "end") for t in y.ticks),
        drawn,
        _line("axis", left, right, floor, floor),
        (_text(x.label(t), x.at(t), floor + 16, "middle") for t in x.ticks),
        class_="whole", viewBox=size, role="img", aria_label=what,
    )  # fmt: skip


def interval_plot(
    value: float, low: float, high: float, axis: Axis, ends: Sequence[str], what: str
) -> Html:
    """A value and its interval; ``ends`` say what the ends of the axis are. 0 is marked within."""
    left, right, inside = axis.at(axis.low), axis.at(axis.high), axis.low < 0.0 < axis.high
    marks = [0.0] if inside else axis.ticks
    width = right + left
    return tag(
        "svg",
        (_line("zero" if inside else "grid", axis.at(t), axis.at(t), 1, 17) for t in marks),
        _line("line", axis.at(low), axis.at(high), 9, 9),
        None if math.isnan(value) else tag("circle", class_="dot", cx=axis.at(value), cy=9, r=4),
        _text(ends[0], left, 31, "start"),
        _text("0", axis.at(0.0), 31, "middle") if inside else None,
        _text(ends[1], right, 31, "end"),
        viewBox=f"0 0 {width:g} 35", width=f"{width:g}", role="img", aria_label=what,
    )  # fmt: skip


def rate_axis(lows: Sequence[float], width: float) -> Axis:
    """Axis of rates up to 1, from the round value below all that is to be shown."""
    return Axis.around(min([0.9, *lows]), 1.0, 4, 6.0, width - 6.0)


def shift_axis(values: Sequence[float], width: float) -> Axis:
    """Axis with 0 in its middle; with room for an end that is open."""
    finite = [abs(value) for value in values if math.isfinite(value)]
    most = max([0.0, *finite])
    most = (most if most >= 1e-6 else 1.0) * (1.0 if len(finite) == len(values) else 1.5)
    return Axis.around(-most, most, 4, 8.0, width - 8.0)


def spread_axis(values: FloatArray, width: float) -> Axis:
    """Axis that holds all values but the outermost in 1000, 0 included."""
    known = np.clip(values[~np.isnan(values)], -LARGEST, LARGEST)
    low, high = np.quantile(known, [0.0, 0.999]).tolist() if len(known) else (0.0, 1.0)
    return Axis.around(min(low, 0.0), max(high, 1e-6), 5, 42.0, width - 10.0)


def shares(values: FloatArray, axis: Axis) -> tuple[FloatArray, FloatArray]:
    """Share of values (K,) in each bar (B,), and the edges of bars (B + 1,), 0 among them.

    What lies beyond the axis is in its outermost bar.
    """
    steps = len(axis.ticks) - 1
    each = max(1, round(BINS / steps))
    edges = np.round(np.linspace(axis.low, axis.high, steps * each + 1) / axis.step, 9) * axis.step
    known = np.clip(values[~np.isnan(values)], axis.low, np.nextafter(axis.high, -np.inf))
    return np.histogram(known, edges)[0] / max(1, len(known)), edges


def distribution(values: FloatArray, axis: Axis, top: float, unit_text: str, what: str) -> Html:
    """Histogram of values (K,): those below 0 in the colour of contacts.

    Upright: the share of runs, up to ``top`` at least.
    """
    floor, right = 98.0, axis.start + axis.length
    up = Axis.around(0.0, max(100.0 * top, 0.01), 2, floor, 8.0)

    def bars() -> Iterator[Html]:
        found, edges = shares(values, axis)
        for share, low, high in zip(found.tolist(), edges[:-1], edges[1:], strict=True):
            if share:
                tall, x = max(1.0, floor - up.at(100.0 * share)), axis.at(low)
                yield tag(
                    "rect", class_="contact" if high <= 0.0 else "free", x=round(x + 0.5, 1),
                    y=round(floor - tall, 1), width=round(max(0.8, axis.at(high) - x - 1), 1),
                    height=round(tall, 1),
                )  # fmt: skip

    zero = _line("zero", axis.at(0.0), axis.at(0.0), 8.0, floor) if axis.low < 0.0 else None
    return _framed(
        axis, up, "%", bars(), zero, _text(unit_text, right, floor + 33, "end"),
        size=f"0 0 {right + 10:g} 136", what=what,
    )  # fmt: skip


def paired_plot(a: FloatArray, b: FloatArray, label: str, what: str, side: float = 270.0) -> Html:
    """Pairs (K,) as points on equal axes, with the line on which both are the same."""
    both = np.clip(np.concatenate([a, b]), -LARGEST, LARGEST)
    low, high = float(both.min()), float(both.max())
    spread = max(high - low, 0.01 * max(abs(low), abs(high)))  # labels stay short
    high = max(high, low + (spread if spread > LEAST else 1.0))
    axis = Axis.around(low, high, 4, 62.0, side - 10.0)
    low, high = axis.low, axis.high
    floor = axis.length + 10.0
    up = replace(axis, start=floor, length=-axis.length)
    return _framed(
        axis, up, "",
        (_line("grid", axis.at(t), axis.at(t), up.at(low), up.at(high)) for t in axis.ticks),
        _line("axis", axis.at(low), axis.at(high), up.at(low), up.at(high)),
        (tag("circle", class_="point", cx=axis.at(x), cy=up.at(y), r=3)
         for x, y in zip(a.tolist(), b.tolist(), strict=True)),
        _text(f"A: {label}", side - 10.0, floor + 31, "end"), _text(f"B: {label}", 4, 0, "start"),
        size=f"0 -12 {side:g} {floor + 48:g}", what=what,
    )  # fmt: skip
