"""Where things stand in the picture: the view, the strip below it, the panel to its right."""

from __future__ import annotations

from typing import NamedTuple

from physim.video import theme
from physim.video.text import Image


class Box(NamedTuple):
    """A rectangle of pixels."""

    left: int
    top: int
    width: int
    height: int

    def of(self, image: Image) -> Image:
        """Return the part of ``image`` in this box, as a view: drawing there is clipped to it."""
        return image[self.top : self.top + self.height, self.left : self.left + self.width]


class Layout(NamedTuple):
    """Boxes of one picture; they do not overlap."""

    view: Box
    panel: Box
    strip: Box | None


def arrange(with_strip: bool) -> Layout:
    """Divide the picture; without figures over time the view takes the strip's place."""
    wide = theme.WIDTH - theme.PANEL_WIDTH
    high = theme.HEIGHT - (theme.STRIP_HEIGHT if with_strip else 0)
    strip = Box(0, high, wide, theme.STRIP_HEIGHT) if with_strip else None
    return Layout(Box(0, 0, wide, high), Box(wide, 0, theme.PANEL_WIDTH, theme.HEIGHT), strip)
