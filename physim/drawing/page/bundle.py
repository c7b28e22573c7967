"""The scripts and styles of the page as two texts, put together from the files in ``assets``.

Each script is a module of its own that a browser or editor reads as it stands. Within the page
there is one: each file is a function that gives what the file exports, after those that it imports.
"""

from __future__ import annotations

import base64
import hashlib
import re
from functools import cache
from pathlib import Path

ASSETS = Path(__file__).parent / "assets"
MAIN = "main"
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./([a-z]+)\.js";$', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:async )?(?:function|class|const) (\w+))", re.MULTILINE)


@cache
def asset(name: str) -> str:
    """Text of a file of ``assets``."""
    return (ASSETS / name).read_text(encoding="utf-8")


def order() -> list[str]:
    """Names of all scripts that `MAIN` needs, each after those that it imports."""
    found: list[str] = []

    def visit(name: str) -> None:
        if name not in found:
            for _, needed in IMPORT.findall(asset(f"{name}.js")):
                visit(needed)
            found.append(name)

    visit(MAIN)
    return found


@cache
def script() -> str:
    """All scripts as one."""
    return "\n".join(map(_as_function, order()))


def _as_function(name: str) -> str:
    """A script as a function that gives what it exports."""
    text = asset(f"{name}.js")
    given = ", ".join(found[1] for found in EXPORT.findall(text))
    body = EXPORT.sub(r"\1", IMPORT.sub(r"const \1 = of_\2;", text))
    return f"const of_{name} = (() => {{\n{body}return {{ {given} }};\n}})();"


def sheets(*names: str) -> str:
    """Style sheets behind one another."""
    return "".join(asset(name) for name in names)


def policy(script: str, style: str) -> str:
    """Content-Security-Policy: one script, one style, pictures within the page, no network."""
    return (
        f"default-src 'none'; script-src '{_digest(script)}'; style-src '{_digest(style)}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def still_policy(style: str) -> str:
    """As `policy`, for a page that runs nothing."""
    return (
        f"default-src 'none'; style-src '{_digest(style)}'; img-src data:; base-uri 'none'; "
        "form-action 'none'"
    )


def _digest(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
