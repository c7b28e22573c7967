"""One style for all pictures: readable in print and under the common kinds of colour blindness.

Colours are those of Okabe and Ito (2008), as in the videos. Figures are objects of their own: no
state of matplotlib's is read or changed outside `styled`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

INK = "#22262c"
QUIET = "#62686f"
RULE = "#d6dade"
BLUE = "#0072b2"
GREEN = "#009e73"
VERMILION = "#d55e00"
"""contacts, as in the videos"""
CYCLE = ("#0072b2", "#e69f00", "#009e73", "#cc5aa0", "#56b4e9", "#882255", "#22262c", "#b8ad00")
"""robots, by index; none is near `VERMILION`, which contacts alone have"""
ROBOTS = (*CYCLE, "#332288", "#b39ddb", "#7a5c1e", "#999999")
"""robots one by one, by index"""
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
"""robots, by index: colour is never the only mark"""

MODES = {0: BLUE, 1: "#e69f00", 2: "#cc5aa0", 3: GREEN}
"""modes, as in the videos"""
MODE_WORDS = {
    0: "safe",
    1: "danger, by distance",
    2: "danger, by collision time",
    3: "arrived",
}
SAFE_AREA = "#d8eedf"
DANGER_AREA = "#f2b8a2"
"""darker than the safe area, so that the two differ without colour"""
OBSTACLE = "#8c9197"

WIDTH = 6.9
"""[in] two columns of a paper"""
NARROW = 5.0
"""[in] curves: their writing can still be read when set to one column of 3.4 in"""
DPI = 200


@contextmanager
def styled() -> Iterator[None]:
    """Settings of matplotlib for one picture; restored afterwards."""
    import matplotlib

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
    with matplotlib.rc_context(settings):
        yield


def robot_mark(index: int) -> tuple[str, str]:
    """Colour and marker of a robot; the pair repeats only after 24 robots."""
    return robot_colour(index), MARKERS[index % len(MARKERS)]


def robot_colour(index: int) -> str:
    """Colour of a robot; it repeats after twelve."""
    return ROBOTS[index % len(ROBOTS)]
