"""The pages: nothing in a name has a meaning of its own, every picture is in them."""

from __future__ import annotations

import base64
from html.parser import HTMLParser
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

from tests.helpers import inside

pages, HTML, MARKDOWN = inside("physim.reproduction", "pages", "HTML", "MARKDOWN")
Report, Section = inside("physim.reproduction", "Report", "Section")
Outcome, Verdict = inside("physim.reproduction", "Outcome", "Verdict")

PNG = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
VOID = ("meta", "link", "img")
HOSTILE = (
    "<script>alert(1)</script> & \"q\" 'a' | `b` *c* _d_ [e](f) ![g](h) $x$ {{i}} # j \\ ~~k~~"
)
TAGS = {
    "html", "head", "meta", "link", "title", "style", "body", "main", "h1", "h2", "h3", "p", "a",
    "strong", "div", "table", "thead", "tbody", "tr", "th", "td", "figure", "figcaption", "img",
    "video", "pre", "code",
}  # fmt: skip
"""What a page is made of."""


def report(text: str, outcome: Outcome = Outcome.NOT_MET) -> Report:
    row = Verdict(text, text, text, outcome, text, text, text)
    section = Section(
        "1", f"Figure 1: {text}", text, ("physim run x",), (row,),
        ("figures/a b.png",), (text,), ("w&/video.mp4",), text,
    )  # fmt: skip
    return Report("0.1.0", "physim reproduce", 3, (section,), {"w": {"x": 1.5}})


class Reader(HTMLParser):
    """What a browser makes of a page: tags, attributes, visible text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.words = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert tag in VOID or self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.words += data


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures/a b.png").write_bytes(PNG)
    return tmp_path


@pytest.mark.parametrize(
    "name", [HOSTILE, "</td></table><b>bold</b>", '" onerror="alert(1)', "&lt;b&gt; &#60;"]
)
def test_names_in_html_are_only_names(name: str, folder: Path) -> None:
    seen = Reader(pages(report(name), folder)[HTML])
    assert seen.open == []
    assert {tag for tag, _ in seen.tags} <= TAGS
    assert " ".join(seen.words.split()).count(" ".join(name.split())) >= 8
    assert not any(key.startswith("on") for _, attributes in seen.tags for key in attributes)


def test_html_needs_nothing_but_the_videos(folder: Path) -> None:
    text = pages(report("x"), folder)[HTML]
    links = [a.get(key) or "" for _, a in Reader(text).tags for key in ("src", "href") if key in a]
    pictures = [link for link in links if link.startswith("data:image/png;base64,")]
    assert base64.b64decode(pictures[0].split(",")[1]) == PNG
    others = {link for link in links if not link.startswith(("data:", "#"))}
    assert others == {"w%26/video.mp4"}
    assert "//" not in "".join(others)
    assert "http" not in text.replace("http-equiv", "")


def test_names_in_markdown_are_only_names(folder: Path) -> None:
    """As any reader of Markdown sees them, also one that follows raw HTML."""
    parser = MarkdownIt("commonmark").enable("table")
    seen = Reader(parser.render(pages(report(HOSTILE), folder)[MARKDOWN]))
    tags = {tag for tag, _ in seen.tags}
    assert not tags & {"script", "em", "hr", "h4"}
    assert {"table", "pre", "code", "h1"} <= tags
    assert seen.words.count(HOSTILE) >= 8
    links = [attributes.get("href") for tag, attributes in seen.tags if tag == "a"]
    assert [link for link in links if not str(link).startswith("#")] == ["w%26/video.mp4"]
    pictures = [attributes["src"] for tag, attributes in seen.tags if tag == "img"]
    assert pictures == ["figures/a%20b.png"]
    rows = [tag for tag, _ in seen.tags if tag in ("tr", "td")]
    assert rows == ["tr", "tr", *["td"] * 5, "tr", "tr", *["td"] * 6]


def test_report_comes_back_from_json() -> None:
    given = report(HOSTILE)
    assert Report.from_json(given.to_json()) == given
    for wrong in ("", "{}", given.to_json().replace("not met", "never met")):
        with pytest.raises(ValueError, match=r"Expecting|version|outcome"):
            Report.from_json(wrong)
