"""Words of messages; signs that would act on a terminal are escaped, all others stay."""

from __future__ import annotations

import html
import json
import re
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.errors import place_text, plural
from physim.escaping import escaped, escaped_lines
from physim.html import labelled
from physim.html import text as html_text
from physim.units import amount
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
    table = labelled([("<b>", "</td><script>1</script>"), ("a", "\u202eb")])
    assert re.findall(r"<(\w+)", table) == ["table", "tr", "th", "td", "tr", "th", "td"]
    assert r"\u202eb" in table


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ((0, "robot"), "0 robots"),
        ((1, "robot"), "1 robot"),
        ((2, "robot"), "2 robots"),
        ((1, "stretch", "stretches"), "1 stretch"),
        ((2, "stretch", "stretches"), "2 stretches"),
    ],
)
def test_plural(given, told) -> None:
    assert plural(*given) == told


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ((1.5, -4.0), "(1.5, -4)"),
        ((0.12345678, 4321.0987), "(0.123457, 4321.1)"),
        ((0.12345678, 4321.0987, 4), "(0.1235, 4321.1)"),
        ((432100.5, 5812345.257), "(432100.5, 5812345.26)"),
        ((-432070.0, 812398.996, 4), "(-432070, 812399)"),
    ],
)
def test_places_are_told_to_the_centimetre_far_from_the_origin(given, told) -> None:
    assert place_text(*given) == told


def test_small_amounts_keep_two_digits_and_large_ones_have_commas() -> None:
    """The impulses of a robot of 0.15 kg were all 0.0 N s."""
    told = [amount(x, "N s", 1) for x in (0.00798, 0.39, 0.0, 12.34, -0.02, 12345.6)]
    assert told == ["0.0080 N s", "0.39 N s", "0.0 N s", "12.3 N s", "-0.020 N s", "12,345.6 N s"]
