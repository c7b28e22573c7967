"""One style for all pictures: readable in print and under the common kinds of colour blindness.

Colours are those of `physim.drawing.palette`, as in the videos. Figures are objects of their own:
no state of matplotlib's is read or changed outside `styled`.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from physim.drawing import palette
from physim.drawing.palette import hexed
from physim.files import draft

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

FONT = "DejaVu Sans"
OTHER_FONTS = (
    "Noto Sans CJK SC", "Noto Sans CJK JP", "Noto Sans SC", "Noto Sans JP", "Noto Sans KR",
    "Source Han Sans SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei", "Droid Sans Fallback",
    "PingFang SC", "Hiragino Sans", "Apple SD Gothic Neo", "Microsoft YaHei", "Yu Gothic",
    "Malgun Gothic", "Arial Unicode MS", "Noto Sans", "Noto Sans Devanagari", "Noto Sans Bengali",
    "Noto Sans Thai", "Noto Sans Tamil", "Noto Sans Ethiopic", "Nirmala UI", "Leelawadee UI",
    "Segoe UI Symbol", "Noto Sans Symbols2", "Noto Emoji", "Unifont",
)  # fmt: skip
"""Fonts for scripts that the first lacks, on Linux, macOS and Windows."""

WIDTH = 6.9
"""[in] two columns of a paper"""
NARROW = 5.0
"""[in] curves: their writing can still be read when set to one column of 3.4 in"""
DPI = 200
BACKEND = "MPLBACKEND"
"""Variable that names a backend for windows and notebooks; all that a notebook starts inherits it,
and `import matplotlib` ends in a ValueError where that backend is not installed"""
DATE = "SOURCE_DATE_EPOCH"
"""Variable by which builds date their files; one that is no whole number is an error in matplotlib
"""
SETTINGS = "matplotlibrc"
"""File by which matplotlib would draw; one in the working folder may have come from a stranger"""
OF_THE_PROCESS = ("backend", "backend_fallback", "interactive", "toolbar", "timezone", "date.epoch")
"""Settings that are no matter of one picture"""


def load_matplotlib() -> Any:
    """The module, loaded whatever the environment asks of it; a backend that exists is taken over.

    physim draws into files, for which matplotlib takes a backend by their format.
    """
    if "matplotlib" in sys.modules:
        return sys.modules["matplotlib"]
    with _without(BACKEND) as wanted, _settings_unseen():
        import matplotlib
    if wanted:
        with suppress(ValueError):  # no such backend: the one that matplotlib finds
            matplotlib.rcParams["backend"] = wanted
    return matplotlib


@contextmanager
def _without(variable: str) -> Iterator[str | None]:
    """The value of a variable of the environment, which is not there meanwhile."""
    value = os.environ.pop(variable, None)
    try:
        yield value
    finally:
        if value is not None:
            os.environ[variable] = value


@contextmanager
def _settings_unseen() -> Iterator[None]:
    """Be in the root folder meanwhile, where the working folder has settings of matplotlib."""
    if not os.path.lexists(SETTINGS):
        yield
        return
    here = os.getcwd()
    os.chdir(os.sep)
    try:
        yield
    finally:
        os.chdir(here)


@contextmanager
def styled() -> Iterator[None]:
    """Settings of matplotlib for one picture, whatever the user's are; restored afterwards."""
    settings: Any = {
        "font.family": FONT,
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


def save_figure(path: Path, format: str, make: Callable[[], Any], **options: Any) -> bool:
    """Write the figure that ``make()`` gives, whole or not at all; False where that is None.

    Without the date that would make files differ; ``options`` are those of ``Figure.savefig``.
    Raises OSError where it cannot be written.
    """
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with styled(), _without(DATE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # names in any script
        figure = make()
        if figure is None:
            return False
        path.parent.mkdir(parents=True, exist_ok=True)
        with draft(path) as part:
            figure.savefig(part, format=format, metadata=dates.get(format, {}), **options)
    return True


def robot_mark(index: int) -> tuple[str, str]:
    """Colour and marker of a robot; the pair repeats only after 40 robots."""
    return robot_colour(index), MARKERS[index % len(MARKERS)]


def robot_colour(index: int) -> str:
    """Colour of a robot; it repeats after ten."""
    return hexed(palette.robot_colour(index))


def families(words: str) -> tuple[list[str], frozenset[int]]:
    """Fonts that together have the most signs for some words, and the signs they have.

    Most words need the first alone; others are looked for among those installed.
    """
    from matplotlib.font_manager import findfont, fontManager, get_font

    chosen, wanted = [FONT], set(map(ord, words))
    signs = set(get_font(findfont(FONT)).get_charmap())
    installed = {entry.name for entry in fontManager.ttflist} if wanted - signs else set()
    for family in filter(installed.__contains__, OTHER_FONTS):
        more = set(get_font(findfont(family)).get_charmap())
        if more & (wanted - signs):
            chosen.append(family)
            signs |= more
    return chosen, frozenset(signs)
