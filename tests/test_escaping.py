"""Signs that would act on a terminal are escaped, all others stay."""

from __future__ import annotations

import html
import json
import re
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.escaping import escaped, escaped_lines, html_table, html_text
from tests.helpers import examples

ANY = st.text(st.characters(codec=None) | st.sampled_from("\x00\x1b\x7f\x85\x9b\u202e\u2066\ud800"))


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ("r1", "r1"),
        ("Tür 🤖 — x²", "Tür 🤖 — x²"),
        ("\x1b[31m", r"\u001b[31m"),
        ("\x9b2J", r"\u009b2J"),
        ("a\u202eb", r"a\u202eb"),
        ("a\nb\t", r"a\u000ab\u0009"),
        ("\ud800", r"\ud800"),
        ("\U000e0001", r"\udb40\udc01"),
    ],
)
def test_what_acts_is_escaped(given: str, shown: str) -> None:
    assert escaped(given) == shown


@examples(25, deep=200)
@given(ANY)
def test_nothing_escaped_acts(text: str) -> None:
    shown = escaped(text)
    assert shown.isprintable()
    assert all(unicodedata.category(sign) not in ("Cc", "Cf", "Cs", "Zl", "Zp") for sign in shown)
    assert escaped_lines(text).count("\n") == text.count("\n")


@examples(25, deep=200)
@given(ANY, st.sampled_from(["ascii", "latin-1", "cp1252", "shift_jis", "utf-8"]))
def test_json_stays_the_same_in_any_encoding(text: str, encoding: str) -> None:
    shown = escaped_lines(json.dumps([text], ensure_ascii=False), encoding)
    shown.encode(encoding)
    assert json.loads(shown) == json.loads(json.dumps([text]))


def test_of_lines_their_ends_alone_stay() -> None:
    assert escaped_lines("a\x1b[31m\n\u202eb\r\n") == "a\\u001b[31m\n\\u202eb\\u000d\n"


def test_an_unknown_encoding_gets_ascii() -> None:
    assert escaped_lines("é", "no-such-encoding").isascii()


@examples(25, deep=200)
@given(ANY)
def test_in_html_a_text_is_only_text(text: str) -> None:
    shown = html_text(text)
    assert not set(shown) & set("<>\"'")
    assert html.unescape(shown) == escaped(text)


def test_in_a_table_labels_and_texts_are_only_texts() -> None:
    table = html_table([("<b>", "</td><script>1</script>"), ("a", "\u202eb")])
    assert re.findall(r"<(\w+)", table) == ["table", "tr", "th", "td", "tr", "th", "td"]
    assert r"\u202eb" in table
