"""One style for all pictures: readable in print and under the common kinds of colour blindness.

Colours are those of `physim.drawing.palette`, as in the videos. Figures are objects of their own:
no state of matplotlib's is read or changed outside `styled`.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physim.drafts import discard, draft_of
from physim.drawing import palette
from physim.drawing.palette import hexed
from physim.drawing.plots.loading import load_matplotlib

INK = hexed(palette.INK)
QUIET = hexed(palette.QUIET)
RULE = hexed(palette.RULE)
CONTACT = hexed(palette.CONTACT)
"""contacts, swept ones included, and nothing else"""
WIDTHS = hexed(palette.WIDTH)
"""widths of the corridor"""
BAND = hexed(palette.BAND)
"""bands and medians of a crowd"""
CYCLE = tuple(hexed(colour) for colour in palette.ROBOTS)
"""robots, by index; arms of an experiment"""
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
"""robots, by index: colour is never the only mark"""

WIDTH = 6.9
"""[in] two columns of a paper"""
NARROW = 5.0
"""[in] curves: their writing can still be read when set to one column of 3.4 in"""
DPI = 200
OF_THE_PROCESS = ("backend", "backend_fallback", "interactive", "toolbar", "timezone", "date.epoch")
"""Settings that are no matter of one picture"""


@contextmanager
def styled() -> Iterator[None]:
    """Settings of matplotlib for one picture, whatever the user's are; restored afterwards."""
    settings: Any = {
        "font.family": "DejaVu Sans",
        "font.size": 9.0,
        "axes.titlesize": 9.5,
        "axes.titlelocation": "left",
        "axes.labelsize": 9.0,
        "axes.edgecolor": QUIET,
        "axes.labelcolor": INK,
        "axes.linewidth": 0.7,
        "axes.grid": True,
        "axes.axisbelow": True,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "grid.color": RULE,
        "grid.linewidth": 0.6,
        "xtick.color": QUIET,
        "ytick.color": QUIET,
        "xtick.labelcolor": INK,
        "ytick.labelcolor": INK,
        "text.color": INK,
        "text.parse_math": False,  # names are names, with $ and _
        "lines.linewidth": 1.3,
        "legend.frameon": False,
        "legend.fontsize": 8.5,
        "savefig.dpi": DPI,
        "svg.hashsalt": "physim",
        "svg.fonttype": "none",
        "pdf.fonttype": 42,
        "path.simplify_threshold": 0.2,
    }
    matplotlib = load_matplotlib()
    usual = {k: v for k, v in matplotlib.rcParamsDefault.items() if k not in OF_THE_PROCESS}
    with matplotlib.rc_context():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # some defaults are on their way out
            matplotlib.rcParams.update(usual | settings)
        yield


DATE = "SOURCE_DATE_EPOCH"
"""Variable by which builds date their files"""


def save_figure(path: Path, format: str, make: Callable[[], Any], **options: Any) -> None:
    """Write the figure that ``make()`` gives, whole or not at all.

    Without the date that would make files differ; ``options`` are those of ``Figure.savefig``.
    Raises OSError where it cannot be written.
    """
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    part = draft_of(path)
    with styled(), _undated(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # names in any script
        figure = make()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            figure.savefig(part, format=format, metadata=dates.get(format, {}), **options)
            part.replace(path)
        finally:  # of an error or Ctrl-C nothing is left
            discard(part)


@contextmanager
def _undated() -> Iterator[None]:
    """Without the variable by which files are dated: no date is written, and one that is no whole
    number would end in an error of matplotlib."""
    date = os.environ.pop(DATE, None)
    try:
        yield
    finally:
        if date is not None:
            os.environ[DATE] = date


def robot_mark(index: int) -> tuple[str, str]:
    """Colour and marker of a robot; the pair repeats only after 40 robots."""
    return robot_colour(index), MARKERS[index % len(MARKERS)]


def robot_colour(index: int) -> str:
    """Colour of a robot; it repeats after ten."""
    return hexed(palette.robot_colour(index))
