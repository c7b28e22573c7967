"""What the site's pages take from the code when it is built.

A line ``<!-- generated: NAME WORD … -->`` of a page becomes what the function of that name in
`GENERATED` makes of the words. What has no description raises ValueError, which ends the build.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, get_type_hints

import griffe
from pydantic import BaseModel

import physim.world
from physim import campaigns
from physim.analysis.metrics import DEFINITIONS
from physim.cli.commands import GROUPS, app_of
from physim.cli.help import overview, page
from physim.parts.declarations import STANDARD_COLUMNS
from physim.parts.registry import (
    CONTROLLER,
    DRIVE,
    STAGES,
    find_part,
    settings_model,
    shipped_parts,
)
from physim.record.layout import TABLE, Attributes, AttributesModel
from physim.statistics import clopper_pearson
from physim.world.file.files import shipped_worlds

MARK = re.compile(r"^<!-- generated: (?P<name>\w+)(?P<words>[^>]*) -->$", re.MULTILINE)
FARTHEST = 1.0e6
"""Bounds of numbers that the page states once, for all lengths and coordinates"""
JOBS = {"run": "Run worlds", "judge": "Judge runs", "author": "Author worlds", "study": "Many runs"}


def on_page_markdown(markdown: str, **_: object) -> str:
    """Put what the code knows in the place of the marks of a page."""
    return MARK.sub(lambda mark: GENERATED[mark["name"]](*mark["words"].split()), markdown)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown. Raises ValueError for a row without a meaning."""
    rows, told = list(rows), head.index("meaning")
    if missing := [cells[0] for cells in rows if not cells[told].strip()]:
        raise ValueError(f"{missing[0]} has no description")
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines) + "\n"


def prose(text: str) -> str:
    """Plain text of the code, on one line, so that Markdown shows it as it is; code stays code."""
    text = html.escape(" ".join(text.split()), quote=False).replace("``", "`")
    return re.sub(r"([|*])", r"\\\1", text)


# Keys of a world


def keys(name: str, controller: str = "") -> str:
    """Table of the keys of a model of `physim.world`, or of the ``settings`` of a controller, or of
    a ``drive``."""
    if name in ("settings", "drive"):
        part = find_part(CONTROLLER if name == "settings" else DRIVE, controller)
        model = settings_model(part)
        assert model is not None
    else:
        model = getattr(physim.world, name)
    return keys_of(model, controller or slug(name))


def keys_of(model: type[BaseModel], anchor: str) -> str:
    """Table of the keys of a model, below an anchor."""
    properties = model.model_json_schema()["properties"]
    rows = []
    for key, field in model.model_fields.items():
        unit, text = re.match(r"(?:\[(.+?)\] )?(.*)", field.description or "").groups()  # type: ignore[union-attr]
        default = "required" if field.is_required() else default_of(field.get_default())
        rows.append((f"`{key}`", prose(text), unit or "", default, kind(properties[key])))
    head = ("key", "meaning", "unit", "default", "type and bounds")
    return f'<a id="key-{anchor}"></a>\n\n{table(head, rows)}'


def stages() -> str:
    """Every stage that ships with physim: what it does, and its keys."""
    text = ""
    for kind in STAGES:
        for name in shipped_parts(kind):
            part = find_part(kind, name)
            text += f"\n#### `{name}` ({kind.word})\n\n{prose(part.__doc__ or '')}\n\n"
            if (model := settings_model(part)) is None:
                continue
            text += keys_of(model, name)
            inner: dict[type[BaseModel], list[str]] = {}
            for key, field in model.model_fields.items():
                if isinstance(field.default, BaseModel):
                    inner.setdefault(type(field.default), []).append(f"`{key}`")
            for one, named in inner.items():
                text += f"\nKeys of {' and '.join(named)}:\n\n{keys_of(one, slug(one.__name__))}"
    return text


def slug(name: str) -> str:
    """``RandomRoad`` as ``random-road``."""
    return re.sub(r"(?<!^)(?=[A-Z])", "-", name).lower()


def default_of(value: Any) -> str:
    """A default as it is written in a world."""
    if value is None or value in ("", ()):
        return "none"
    if isinstance(value, BaseModel):
        return "its defaults"
    if isinstance(value, list | tuple):
        return f"`[{', '.join(v if isinstance(v, str) else f'{v:.5g}' for v in value)}]`"
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def kind(schema: dict[str, Any], s: str = "") -> str:
    """What a key takes, by its JSON Schema: ``number > 0``, a link to a mapping; many with an s."""
    if "$ref" in schema:
        name = slug(schema["$ref"].rpartition("/")[2])
        many = "es" if s and name.endswith("x") else s
        return f"[{name.replace('-', ' ')}{many}](#key-{name})"
    if options := schema.get("anyOf") or schema.get("oneOf"):
        return " or ".join(kind(one, s) for one in options if one.get("type") != "null")
    if words := schema.get("enum") or ("const" in schema and [schema["const"]]):
        return " or ".join(f"`{one}`" for one in words)
    if schema["type"] != "array":
        named = {"integer": f"whole number{s}", "boolean": "`true` or `false`", "string": "text"}
        return named.get(schema["type"], f"{schema['type']}{s}") + bounds(schema)
    if items := schema.get("prefixItems"):
        if all(one.get("maximum") == FARTHEST for one in items):
            return f"point{s}"
        alike = not s and all(one == items[0] for one in items)
        listed = f"[{', '.join(map(kind, items))}]"
        return f"{len(items)} {kind(items[0], 's')}" if alike else listed
    least, most = schema.get("minItems", 0), schema.get("maxItems")
    many = f"{least:,} to {most:,} " if least and most else f"up to {most:,} " if most else ""
    return f"list{s} of {many}{kind(schema['items'], 's')}"


def bounds(schema: dict[str, Any]) -> str:
    """Least and greatest value of a number; empty where they are those of `FARTHEST`."""
    least, above = schema.get("minimum"), schema.get("exclusiveMinimum")
    most, below = schema.get("maximum"), schema.get("exclusiveMaximum")
    if most == FARTHEST:
        most, least = None, None if least == -FARTHEST else least
    if least is not None and most is not None:
        return f" {plain(least)} to {plain(most)}"
    signs = {"&gt;": above, "≥": least, "&lt;": below, "≤": most}
    told = ", ".join(f"{sign} {plain(x)}" for sign, x in signs.items() if x is not None)
    return f" {told}" if told else ""


def plain(number: float) -> str:
    """A number without an exponent, as it may stand in a world, but for commas."""
    return f"{number:,.6f}".rstrip("0").rstrip(".").replace("-", "−")


# Other tables


def commands() -> str:
    """All commands on a screen, then the help of each, by job."""
    text = f"```text\n{overview()}```\n"
    for job, group in GROUPS.items():
        text += f"\n## {JOBS[job]}\n"
        for name in group:
            app = app_of(name)
            for one in app.assemble_argument_collection():
                if one.parse and not one.children and not one.parameter.help:
                    raise ValueError(f"physim {name}: {one.name} has no description")
            text += f"\n### {name}\n\n```text\n{page(name, app)}```\n"
    return text


def record() -> str:
    """Attributes of a record, its datasets, and the columns of its tables."""
    attributes = []
    for name, hint in get_type_hints(Attributes, include_extras=True).items():
        key = AttributesModel.model_fields[name].alias or name
        attributes.append((f"`{key}`", prose(hint.__metadata__[-1]), f"`{name}`"))
    datasets = [
        (f"`{one.path}`", prose(one.words), f"({', '.join(one.shape)})", one.unit, f"`{one.name}`")
        for one in TABLE.values()
    ]
    text = f"## Attributes\n\n{table(('attribute', 'meaning', '`Record` has it as'), attributes)}"
    head = ("dataset", "meaning", "shape", "unit", "`Record` has it as")
    text += f"\n## Datasets\n\n{table(head, datasets)}\n## Columns\n"
    for one in TABLE.values():
        if one.fields[0].name:
            rows = [(f"`{f.name}`", prose(f.words), f.unit) for f in one.fields]
            text += f"\n### {one.path}\n\n{table(('column', 'meaning', 'unit'), rows)}"
    return text


def metrics() -> str:
    """Every metric of a run."""
    rows = [
        (f"`{one.name}`", prose(one.meaning), one.unit.replace("^2", "²"), one.source.strip("-"))
        for one in DEFINITIONS.values()
    ]
    return table(("metric", "meaning", "unit", "in the paper"), rows)


def columns() -> str:
    """Columns that a controller may declare, whose meaning is fixed."""
    rows = [(f"`{one.name}`", prose(one.words), one.unit) for one in STANDARD_COLUMNS]
    return table(("column", "meaning", "unit"), rows)


def results() -> str:
    """Columns of the results of a sweep."""
    rows = [(f"`{name}`", prose(meaning), unit) for name, unit, meaning in campaigns.columns()]
    return table(("column", "meaning", "unit"), rows)


def fields(module: str, name: str) -> str:
    """Table of the attributes of a class, as they are annotated and told where they are defined.

    Of an enumeration the values, and what they are.
    """
    path = Path(import_module(module).__file__ or "")
    rows, is_typed = [], True
    for key, one in griffe.visit(module, path, path.read_text("utf-8"))[name].attributes.items():
        if key.startswith("_"):
            continue
        is_typed = one.annotation is not None
        written = re.sub(r"^Annotated\[(\w+),.*", r"\1", str(one.annotation)).replace(" | ", " or ")
        written = "str" if written in ("Name", "Words") else written
        called = f"`{key}`" if is_typed else f"`{one.value}`".replace("'", "")
        words = "" if one.docstring is None else prose(one.docstring.value)
        rows.append((called, words, f"`{written}`") if is_typed else (called, words))
    return table(("name", "meaning", "type")[: 2 + is_typed], rows)


def notebook(name: str) -> str:
    """Cells of a notebook in the folder of the pages, with what they printed and drew."""
    text = ""
    for cell in json.loads((Path(__file__).parent / name).read_text("utf-8"))["cells"]:
        source = "".join(cell["source"])
        text += f"```python\n{source}\n```\n\n" if cell["cell_type"] == "code" else f"{source}\n\n"
        for output in cell.get("outputs", ()):
            if "text" in output:
                text += f"```text\n{''.join(output['text'])}```\n\n"
            elif "image/png" in output["data"]:
                picture = "".join(output["data"]["image/png"].split())
                source = f"data:image/png;base64,{picture}"
                text += f'<img alt="what the cell above draws" src="{source}">\n\n'
    return text


# Gallery


RATES = Path(__file__).parent / "gallery/rates.json"
"""Of each shipped world, written by ``python -m benchmarks.avoidance --write``"""
VERDICTS = ("**yes**", "in some runs", "rarely or never", "has none")


def gallery(name: str = "") -> str:
    """Card of a shipped world: film, description, command, rates; without a name, a table of all.

    Every number in it is of `RATES`; descriptions are those of ``physim list``.
    """
    rates, shown = json.loads(RATES.read_text("utf-8")), shipped_worlds()
    if name:
        return card(name, prose(shown[name]), rates[name])
    order = sorted(
        shown,
        key=lambda one: (
            VERDICTS.index(verdict(rates[one])),
            rates[one]["without"]["contact_free"] / rates[one]["seeds"],
        ),
    )
    text = "| | world | needs avoidance;<br>contact-free with, without |\n|---|---|---|\n"
    for one in order:
        of = rates[one]
        counts = [str(of[arm]["contact_free"]) for arm in ("with", "without") if arm in of]
        text += f'| <img class="thumb" alt="" loading="lazy" src="{one}.webp">'
        text += f" | [`{one}`](#{one})<br>{prose(shown[one])} | {verdict(of)}<br>"
        text += f"{' and '.join(counts)} of {of['seeds']} |\n"
    versions = sorted({one["version"] for one in rates.values()})
    return f"{text}\nMeasured with physim {' and '.join(versions)}.\n"


def card(name: str, words: str, of: dict[str, Any]) -> str:
    """One world of the gallery."""
    null = verdict(of) == VERDICTS[0]
    without = f"\nphysim run {name} --set controller.avoidance=none -o without" if null else ""
    arms = {"with": "with avoidance", "without": "without avoidance"}
    arms = {arm: title for arm, title in arms.items() if arm in of}
    text = (
        f"### {name} {{ #{name} }}\n\n"
        f'<video controls preload="none" poster="{name}.webp" width="960" height="540" '
        f'aria-label="Film of {name}"><source src="{name}.mp4" type="video/mp4"></video>\n\n'
        f"{words}\n\n```sh\nphysim run {name}{without}\n```\n\n"
        f"| | {' | '.join(arms.values())} |\n|---{'|---' * len(arms)}|\n"
    )
    for title, figure in (("contact-free", "contact_free"), ("all robots arrive", "finished")):
        cells = [rate(of[arm][figure], of["seeds"]) for arm in arms]
        text += f"| {title} | {' | '.join(cells)} |\n"
    told = []
    if "with" in of:
        acts = 100.0 * (of["with"]["by_distance"] + of["with"]["by_time"])
        near, least = of["with"]["shortest_distance"], of["with"]["least_distance"]
        told += [
            f"Avoidance makes {acts:.2g} % of the decisions." if acts else "Avoidance never acts."
        ]
        if near is not None:
            spread = f" (median; least {least:.2f} m)" if of["seeds"] > 1 else ""
            told += [f"Robots come as near as {near:.2f} m{spread}."]
    if depth := 1e3 * of["without"]["deepest_contact"]:
        without = "Without it contacts" if "with" in of else "Contacts"
        told += [
            f"{without} are up to {depth:.1f} mm deep; runs that have any spend "
            f"{of['without']['time_in_contact']:.1f} s in contact (median)."
        ]
    return f"{text}\n{' '.join(told).replace('-', '−')}\n"


def verdict(of: dict[str, Any]) -> str:
    """Whether a world needs avoidance, by its runs without a contact: one of `VERDICTS`."""
    if "with" not in of:
        return VERDICTS[3]
    free, bare = of["with"]["contact_free"], of["without"]["contact_free"]
    low, high = clopper_pearson([free, bare], of["seeds"])
    if low[0] <= high[1]:
        return VERDICTS[2]
    return VERDICTS[0] if bare < 0.5 * of["seeds"] else VERDICTS[1]


def rate(runs: int, seeds: int) -> str:
    """Runs of which something holds, and below it the exact interval of their rate."""
    if seeds == 1:
        return f"{runs} of 1"
    low, high = (100.0 * float(end) for end in clopper_pearson(runs, seeds))
    return f"{runs} of {seeds}<br>({low:.1f}–{high:.1f} %)"


MADE = (keys, stages, commands, record, metrics, columns, results, fields, notebook, gallery)
GENERATED = {one.__name__: one for one in MADE}
