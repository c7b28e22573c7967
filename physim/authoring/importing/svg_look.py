"""What a first look at an SVG drawing finds, before any library reads it."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field

from physim.authoring.importing.svg_bare import BareSvg


@dataclass
class SvgLook:
    """What the first look found: the line of each id, things without lines, the page."""

    lines: dict[str, int] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)
    page: Mapping[str, str] = field(default_factory=dict)
    """attributes of the root"""
    line: int = 1
    """of the root"""
    may_be_painted: bool = False
    """whether shapes are that are told not to be, by rules that are not followed"""
    bare: BareSvg = field(default_factory=BareSvg)
    """what is left to read"""
    drawn: list[tuple[int, str]] = field(default_factory=list)
    """line of each shape that is to be seen, and what it is called: ``<rect> "pillar"``"""

    def not_among(self, lines: Set[int | None]) -> list[str]:
        """What is to be said of shapes of which none was found in these lines."""
        return [
            f"line {line}: {called} draws nothing: hidden, or without extent; left out"
            for line, called in self.drawn
            if line not in lines
        ]
