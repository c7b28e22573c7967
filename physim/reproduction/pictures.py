"""Pictures small enough to lie in a repository and to stand inside a page."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physim.plots.style import styled

DPI = 160
COLOURS = 128
"""A palette: a third of the size of full colour, and the eye sees no difference in drawings."""


@contextmanager
def picture(path: Path) -> Iterator[Callable[[Any], None]]:
    """Style of all pictures while a figure is drawn; the function given saves it as PNG.

    The file appears whole or not at all; the same figure gives the same file.
    """

    def keep(figure: Any) -> None:
        from PIL import Image

        drawn = io.BytesIO()
        figure.savefig(drawn, format="png", dpi=DPI)
        small = Image.open(drawn).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
        part = path.with_name(f".{path.name}.part")
        try:
            small.save(part, format="PNG", optimize=True)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)

    with styled(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # names in any script
        yield keep
