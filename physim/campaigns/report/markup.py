"""Pages of HTML that need nothing beside them: their frame and colours, and harmless text."""

from __future__ import annotations

import html
from pathlib import Path

from physim.drawing.page.colours import styles
from physim.escaping import escaped
from physim.html import policy as still_policy

GENERATOR = "physim report"
"""By which the page of a report is known: the next report takes its place."""


def text(value: object) -> str:
    """What comes from a file, as text of a page or as a value within quotes: nothing in it acts."""
    return html.escape(escaped(str(value)), quote=True)


def figures(words: str, unit: str) -> str:
    """Numbers with true minus signs, behind them maybe their unit as it is; text of a page."""
    numbers = words.removesuffix(f" {unit}") if unit else words
    return text(numbers.replace("-", "−") + words[len(numbers) :])


def is_ours(file: Path) -> bool:
    """Whether a file is the page of a report."""
    try:
        with open(file, "rb") as stream:
            return f'<meta name="generator" content="{GENERATOR}">'.encode() in stream.read(1000)
    except OSError:
        return False


def code(value: object) -> str:
    """Words to be typed."""
    return f"<code>{text(value)}</code>"


def page(title: str, body: str, generator: str = GENERATOR) -> str:
    """A whole page, light or dark as the reader's machine is; it loads nothing and runs nothing."""
    css = styles("campaign.css")
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="generator" content="{generator}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{still_policy(css)}">
<title>{text(title)}</title>
<style>{css}</style>
</head>
<body>
<main class="sheet">
{body}
</main>
</body>
</html>
"""
