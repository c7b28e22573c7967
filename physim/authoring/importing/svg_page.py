"""Where the units of an SVG drawing are in the world: its page has one scale, and a corner."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physim.authoring.importing.drawing import refused
from physim.authoring.importing.options import Options
from physim.authoring.importing.svg_look import SvgLook
from physim.authoring.importing.svg_values import NUMBER, SIZES, pixels_of
from physim.geometry.shapes import FloatArray

UNITS = ("mm", "cm", "in", "pt", "pc")
RATIO = re.compile(r"\s*(none|x(?:Min|Mid|Max)Y(?:Min|Mid|Max))(?:\s+(meet|slice))?\s*", re.A)
"""How a page fits into its size; any other text is as none"""
METRES_PER_PIXEL = 0.0254 / 96.0


@dataclass(frozen=True)
class Frame:
    """From user units of a drawing to metres of the world."""

    metres: float
    left: float
    bottom: float
    corner: str
    """what is (0, 0)"""
    scale: str
    """what is said of it"""

    @classmethod
    def of(cls, path: Path, look: SvgLook, options: Options) -> Frame:
        """Of the page of a drawing; raises ImportSourceError where it has no one scale."""
        page = look.page
        box = [float(one) for one in NUMBER.findall(page.get("viewBox", ""))]
        size = [pixels_of(page.get(key, "")) for key in SIZES]
        pixels, wrong = _pixels(page, box, size)
        if wrong:
            raise refused(path, wrong, look.line)
        unit = re.sub(r"[-+0-9.eE\s]", "", page.get("width", "")).lower()
        if options.scale is not None:
            metres = options.scale
            scale = f"{options.scale:g} m per user unit (--scale)"
        elif unit in UNITS:
            metres = METRES_PER_PIXEL * pixels
            scale = f"real-world units of the page ({unit}): {metres:.6g} m per user unit"
        else:
            raise refused(
                path,
                "the page has no real-world units; --scale M says how many metres a user unit is",
                look.line,
            )
        left, top, _, height = box or [0.0, 0.0, *size]
        is_known = bool(box) or height > 0.0
        corner = f"the page's {'lower' if is_known else 'upper'} left corner"
        return cls(metres, left, top + height, corner, scale)

    def placed(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) in units of the drawing, y down, in metres of the world."""
        return np.stack([points[:, 0] - self.left, self.bottom - points[:, 1]], 1) * self.metres


def _pixels(
    page: Mapping[str, str], box: Sequence[float], size: Sequence[float]
) -> tuple[float, str]:
    """Pixels of a user unit of a page with this viewBox [units] and size [px], and what is wrong.

    A size that is not known is 0: that of the window, which is as large as is needed.
    """
    sides = sorted(known / side for known, side in zip(size, box[2:], strict=False) if known > 0.0)
    if not sides:
        return 1.0, ""
    ratio = RATIO.fullmatch(page.get("preserveAspectRatio", ""))
    if sides[-1] > sides[0] * 1.000001 and ratio is not None and ratio[1] == "none":
        return 1.0, (
            "<svg>: width, height and viewBox stretch the page, by "
            f"{sides[0]:.4g} and {sides[-1]:.4g}; give it one scale"
        )
    return sides[-1 if ratio is not None and ratio[2] == "slice" else 0], ""
