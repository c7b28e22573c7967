"""Script, styles and colours of the page, put together from the files in ``assets``.

Each script is a module of its own that a browser or editor reads as it stands. Within the page
there is one: each file is a function that gives what the file exports, after those that it imports.

Colours are those of all pictures on white, and others on a dark ground. Modes and contacts have the
same on both. Robots' own lines are lightened in the dark, so that the darkest of them are seen.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from types import MappingProxyType

from physim.drawing import palette
from physim.drawing.palette import Colour, hexed, mix

ASSETS = Path(__file__).parent / "assets"
MAIN = "main"
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./([a-z]+)\.js";$', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:async )?(?:function|class|const) (\w+))", re.MULTILINE)

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
        "way": (190, 176, 60),
        "band": (146, 164, 196),
        "link": (122, 178, 238),
    }
)
"""By name, in the dark."""
LIGHTER = 0.45
"""Share of white in the robots' own colours in the dark"""


@cache
def asset(name: str) -> str:
    """Text of a file of ``assets``."""
    return (ASSETS / name).read_text(encoding="utf-8")


@cache
def script() -> str:
    """All scripts that `MAIN` needs as one, each after those that it imports."""
    found: dict[str, str] = {}

    def visit(name: str) -> None:
        text = asset(f"{name}.js")
        for _, needed in IMPORT.findall(text):
            if needed not in found:
                visit(needed)
        given = ", ".join(one[1] for one in EXPORT.findall(text))
        body = EXPORT.sub(r"\1", IMPORT.sub(r"const \1 = of_\2;", text))
        found[name] = f"const of_{name} = (() => {{\n{body}return {{ {given} }};\n}})();"

    visit(MAIN)
    return '"use strict";\n' + "\n".join(found.values())


def schemes() -> dict[str, dict[str, object]]:
    """Both schemes for the page: colours by name, and the robots' own."""
    lighter = [mix(colour, palette.WHITE, LIGHTER) for colour in palette.ROBOTS]
    return {
        scheme: {
            **{name: hexed(colour) for name, colour in named.items()},
            "robots": [hexed(colour) for colour in robots],
        }
        for scheme, named, robots in (("light", LIGHT, palette.ROBOTS), ("dark", DARK, lighter))
    }


def styles(*names: str) -> str:
    """Style sheet of a page: the colours as custom properties, light and, where the reader prefers
    it, dark; what all pages have in common; and sheets of its own."""
    light, dark = (
        "".join(f"--{name}:{hexed(colour)};" for name, colour in scheme.items())
        for scheme in (LIGHT, DARK)
    )
    return (
        f":root{{color-scheme:light dark;{light}}}\n"
        f"@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
        + "".join(asset(name) for name in ("common.css", *names))
    )
