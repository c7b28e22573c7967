"""Copies in an SVG drawing (``use``), counted before they are made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

MOST_COPIES = 100
"""Copies of copies."""
MISPLACED = "is copied (use) out of a switch, a shape or a copy; move it into <defs>"


@dataclass
class Element:
    """An element with its children, and what it copies."""

    functions: int = 0
    """of its transform"""
    name: str | None = None
    """its id"""
    count: int = 1
    """elements, itself among them"""
    turned: int = 0
    """functions that move these, its own only when it has ended"""
    copies: list[tuple[str, int]] = field(default_factory=list)
    """ids, and how many functions below this element move what is copied"""
    is_misplaced: bool = False
    """whether it stands where what is drawn elsewhere may not be drawn"""
    is_drawn: bool = False
    """of a ``switch``: whether one of its alternatives is"""
    by_language: bool = False
    """of a ``switch``: whether which of them is drawn depends on a language"""

    def moved_by(self, functions: int) -> None:
        """Take all in it to be moved by so many functions more."""
        self.turned += functions * self.count
        self.copies = [(name, moved + functions) for name, moved in self.copies]


def written_out(
    drawing: Element, elements: Mapping[str, Element], refused: Callable[[str, str], Exception]
) -> tuple[int, int]:
    """Elements of a drawing, and functions that move them, copies counted.

    ``elements`` are those that have an id. Raises what ``refused`` makes of the id of one that
    cannot be copied, and why.
    """
    known: dict[str, tuple[int, int]] = {}

    def whole(element: Element, within: tuple[str, ...]) -> tuple[int, int]:
        count, turned = element.count, element.turned
        for name, functions in element.copies:
            copied, moved = copy_of(name, within)
            count, turned = count + copied, turned + moved + functions * copied
        return count, turned

    def copy_of(name: str, within: tuple[str, ...]) -> tuple[int, int]:
        if name in within:
            raise refused(name, "copies itself (use)")
        if len(within) > MOST_COPIES:
            return 10**9, 0
        if name not in known:
            element = elements.get(name, Element())
            if element.is_misplaced:  # it is hidden there, but its copies are not
                raise refused(name, MISPLACED)
            known[name] = whole(element, (*within, name))
        return known[name]

    return whole(drawing, ())
