"""Colours of the page: those of all pictures on white, and what they become on a dark ground.

Modes and contacts have the same colours on both. Robots' own lines are lightened in the dark, so
that the darkest of them are seen.
"""

from __future__ import annotations

from types import MappingProxyType

from physim.drawing import palette
from physim.drawing.page.bundle import sheets
from physim.drawing.palette import Colour, hexed, mix

LIGHT = MappingProxyType({**palette.KEYS, "link": (11, 92, 173)})
"""By name, on white."""
DARK: MappingProxyType[str, Colour] = MappingProxyType(
    {
        **LIGHT,
        "paper": (24, 27, 31),
        "ink": (232, 234, 237),
        "quiet": (160, 167, 176),
        "rule": (62, 68, 76),
        "faint": (38, 42, 48),
        "outside": (17, 19, 22),
        "floor": (34, 38, 44),
        "danger": (74, 52, 44),
        "safe": (36, 47, 56),
        "wall": (214, 219, 226),
        "obstacle": (110, 116, 124),
        "reference": (138, 145, 154),
        "band": (146, 164, 196),
        "link": (122, 178, 238),
    }
)
"""By name, in the dark."""
LIGHTER = 0.45
"""Share of white in the robots' own colours in the dark"""


def schemes() -> dict[str, dict[str, object]]:
    """Both schemes for the page: colours by name, and the robots' own."""
    own = {
        "light": palette.ROBOTS,
        "dark": tuple(mix(colour, palette.WHITE, LIGHTER) for colour in palette.ROBOTS),
    }
    named = {"light": LIGHT, "dark": DARK}
    return {
        scheme: {
            **{name: hexed(colour) for name, colour in named[scheme].items()},
            "robots": [hexed(colour) for colour in own[scheme]],
        }
        for scheme in named
    }


def styles(*names: str) -> str:
    """Style sheet of a page: the colours, what all pages have in common, and sheets of its own."""
    return custom_properties() + sheets("common.css", *names)


def custom_properties() -> str:
    """Colours as CSS custom properties, light and, where the reader prefers it, dark."""
    light = "".join(f"--{name}:{hexed(colour)};" for name, colour in LIGHT.items())
    dark = "".join(f"--{name}:{hexed(colour)};" for name, colour in DARK.items())
    return (
        f":root{{color-scheme:light dark;{light}}}\n"
        f"@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
    )
