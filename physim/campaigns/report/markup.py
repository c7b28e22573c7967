"""Pages of HTML that need nothing beside them: their frame and colours, and harmless text."""

from __future__ import annotations

import html
from pathlib import Path

from physim.drawing.palette import BAND, CONTACT, INK, QUIET, RULE, WHITE, WIDTH, Colour, hexed, mix
from physim.escaping import escaped

NIGHT: Colour = (20, 23, 27)
"""Ground of the dark page."""
GENERATOR = "physim report"
"""By which a page is known to be one of these."""


def text(value: object) -> str:
    """What comes from a file, as text of a page or as a value within quotes: nothing in it acts."""
    return html.escape(escaped(str(value)), quote=True)


def is_ours(file: Path) -> bool:
    """Whether a file is a page that was written here."""
    try:
        with open(file, "rb") as stream:
            return f'<meta name="generator" content="{GENERATOR}">'.encode() in stream.read(1000)
    except OSError:
        return False


def code(value: object) -> str:
    """Words to be typed."""
    return f"<code>{text(value)}</code>"


def page(title: str, body: str) -> str:
    """A whole page, light or dark as the reader's machine is; it loads nothing and runs nothing."""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="generator" content="{GENERATOR}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; \
style-src 'unsafe-inline'">
<title>{text(title)}</title>
<style>
{style()}</style>
</head>
<body>
<main>
{body}
</main>
</body>
</html>
"""


def style() -> str:
    """Colours by theme, then the rest."""
    light = {
        "ground": WHITE, "card": mix(WHITE, RULE, 0.22), "ink": INK, "quiet": QUIET, "rule": RULE,
        "contact": CONTACT, "free": BAND, "other": WIDTH, "band": mix(WHITE, BAND, 0.30),
    }  # fmt: skip
    dark = {
        "ground": NIGHT, "card": mix(NIGHT, WHITE, 0.06), "ink": mix(WHITE, NIGHT, 0.10),
        "quiet": mix(WHITE, NIGHT, 0.36), "rule": mix(NIGHT, WHITE, 0.20),
        "contact": mix(CONTACT, WHITE, 0.15), "free": mix(BAND, WHITE, 0.45),
        "other": mix(WIDTH, WHITE, 0.42), "band": mix(NIGHT, BAND, 0.70),
    }  # fmt: skip
    names = [" ".join(f"--{k}: {hexed(v)};" for k, v in each.items()) for each in (light, dark)]
    return (
        f":root {{ color-scheme: light dark; {names[0]} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root {{ {names[1]} }} }}\n{RULES}"
    )


RULES = """\
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
  font-variant-numeric: tabular-nums; }
main { max-width: 74rem; margin: 0 auto; padding: 2.2rem 1.4rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .3rem; overflow-wrap: anywhere; }
h2 { font-size: 1.3rem; margin: 2.8rem 0 .4rem; padding-top: 1.1rem;
  border-top: 1px solid var(--rule); }
h3 { font-size: 1rem; margin: 0 0 .2rem; overflow-wrap: anywhere; }
p { max-width: 50rem; margin: .45rem 0; }
.quiet, figcaption, small { color: var(--quiet); font-size: .86rem; line-height: 1.4; }
code { font: .84em/1.4 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace;
  overflow-wrap: anywhere; }
a { color: var(--other); }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(8.5rem, 1fr)); gap: .8rem;
  margin: 1.3rem 0 0; padding: 0; }
.figures div { background: var(--card); border-radius: 8px; padding: .7rem .9rem; }
.figures dt { color: var(--quiet); font-size: .84rem; }
.figures dd { margin: 0; font-size: 1.45rem; font-weight: 600; overflow-wrap: anywhere; }
.figures .bad { color: var(--contact); }
.wide { overflow-x: auto; margin: .9rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: left; vertical-align: top; padding: .55rem 1.1rem .55rem 0;
  border-bottom: 1px solid var(--rule); }
th { color: var(--quiet); font-weight: 600; font-size: .82rem; vertical-align: bottom; }
th.number, td.number { text-align: right; }
td.number { white-space: nowrap; }
.dense th, .dense td { padding-right: .8rem; }
tr > :last-child { padding-right: 0; }
td b { font-size: 1.02rem; }
.name { min-width: 11rem; overflow-wrap: anywhere; }
.name span { display: block; color: var(--quiet); font-size: .84rem; }
.tiles { display: grid; gap: 1rem; margin: 1rem 0;
  grid-template-columns: repeat(auto-fill, minmax(min(20rem, 100%), 1fr)); }
.large { grid-template-columns: repeat(auto-fill, minmax(min(26rem, 100%), 1fr)); }
.tile { background: var(--card); border-radius: 8px; padding: .9rem 1rem; margin: 0;
  min-width: 0; }
.tile img { display: block; width: 100%; height: auto; border-radius: 4px; margin: 0 0 .6rem; }
.tile .big { font-size: 1.25rem; font-weight: 600; }
.tile .bad { color: var(--contact); }
.verdict { font-weight: 600; }
svg { display: block; max-width: 100%; height: auto; overflow: visible; }
svg.whole { width: 100%; max-width: 28rem; margin: .2rem 0 .4rem; }
svg text { font: 11px system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
  fill: var(--quiet); }
svg .axis { stroke: var(--quiet); stroke-width: 1; fill: none; }
svg .grid { stroke: var(--rule); stroke-width: 1; }
svg .free { fill: var(--free); } svg .contact { fill: var(--contact); }
svg .other { fill: var(--other); } svg .band { fill: var(--band); }
svg .line { stroke: var(--ink); stroke-width: 2; }
svg .dot { fill: var(--ink); }
svg .point { fill: var(--free); fill-opacity: .55; }
svg .zero { stroke: var(--ink); stroke-width: 1; stroke-dasharray: 3 3; }
@media (max-width: 44rem) {
  main { padding: 1.3rem .9rem 3rem; }
  h1 { font-size: 1.5rem; }
  .figures { grid-template-columns: repeat(auto-fit, minmax(7.2rem, 1fr)); gap: .6rem; }
  .figures dd { font-size: 1.15rem; }
  .stack thead { display: none; }
  .stack, .stack tbody { display: block; }
  .stack tr { display: block; padding: .8rem 0; border-bottom: 1px solid var(--rule); }
  .stack td { display: block; border: 0; padding: .2rem 0; text-align: left; white-space: normal; }
  .stack td[data-name]::before { content: attr(data-name) " "; color: var(--quiet);
    font-size: .84rem; margin-right: .4rem; }
  .stack td:empty { display: none; }
}
@media print { .tile, tr { break-inside: avoid; } }
"""
