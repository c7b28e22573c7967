"""Every pitfall of YAML, refused where it stands; nothing executed; no other error than ours."""

from __future__ import annotations

import re
import sys
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.errors import WorldError
from physim.world.file import parse_world, read_document
from tests.helpers import STRAIGHT, check_error, examples, facts, inside

MOST_FAULTS = sys.modules[read_document.__module__].MOST_FAULTS
RefusedScalarError, scalar = inside("physim.world.file", "RefusedScalarError", "scalar")


def refusal(text: str) -> str:
    """First line of the message that refuses ``text``."""
    with pytest.raises(WorldError) as caught:
        parse_world(text, "w.yaml")
    assert len(caught.value.positions) == len(caught.value.faults)
    return str(caught.value).splitlines()[0]


def with_seed(text: str) -> str:
    return STRAIGHT.replace("seed: 3", f"seed: {text}")


@pytest.mark.parametrize(
    ("given_text", "parts"),
    [
        ("1e3", ("1e3", "1.0e+3", "1000")),
        ("1.0e3", ("1.0e3", "1.0e+3", "1000")),
        ("1e-9", ("1e-9", "1.0e-9")),
        ("1:30", ("1:30", "base 60")),
        ("yes", ("yes", "true")),
        ("Off", ("Off", "false")),
        ("010", ("010", "octal")),
        ("0o10", ("0o10", "octal")),
        ("0x10", ("0x10", "decimal", "16")),
        ("1_000", ("1_000", "1000")),
        (".nan", (".nan", "finite")),
        ("-.inf", ("-.inf", "finite")),
        ("1" * 5000, ("5000 digits",)),
        ("9" * 400 + ".0", ("finite",)),
        ("", ("empty",)),
        ("~", ("empty",)),
        ("nan", ("whole number", '"nan"')),
        ('"3"', ('"3"', "number", "quotes")),
        ("!!python/object/apply:os.system ['touch pwned']", ("tag",)),
        ("!include other.yaml", ("tag",)),
        ("!!int 3", ("tag",)),
    ],
)
def test_ambiguous_values_are_refused_with_their_place(given_text, parts):
    column = 6 if given_text == "" else 7
    check_error(f"{refusal(with_seed(given_text))}\n", f"w.yaml:3:{column}: seed:", *parts)


@pytest.mark.parametrize(
    ("text", "place", "parts"),
    [
        ("a: 1\n\tb: 2", "2:1", ("tab",)),
        ("a:\t[1,\n\t2", "2:1", ("tab",)),
        ("a: 1\n---\nb: 2", "3:1", ("second document",)),
        ("a: 1\n...\nb: 2", "3:1", ()),
        ("a: &x [1, *x]", "1:8", ("nested", "50")),
        ("a: *x", "1:4", ("undefined alias",)),
        ("a: \x07", "1:4", ("U+0007",)),
        ("a: [1, 2", "1:4", ("YAML", '"["', "not closed", "end")),
        ("a: {b: 1\nc: 2", "1:4", ("YAML", '"{"', "not closed", "line 2")),
        ("? [a, b]\n: 1", "1:3", ("list", "mapping", "key")),
        ("a: " + "[" * 60 + "]" * 60, "1:54", ("nested", "50")),
        ("a:\n  b: 1\n b: 2", "3", ()),
        ("- 1", "1:1", ("world", "mapping")),
        ("just words", "1:1", ("world", "mapping")),
        ("", "1:1", ("empty",)),
        ("# nothing\n", "1:1", ("empty",)),
        ("null", "1:1", ()),
        ("%YAML 1.1\n%YAML 1.1\n---\na: 1", "2:1", ()),
    ],
)
def test_texts_that_are_no_world_are_refused_with_one_place(text, place, parts):
    check_error(f"{refusal(text)}\n", f"w.yaml:{place}:", *parts)


def test_a_duplicate_key_is_told_at_the_second_place():
    message = refusal(STRAIGHT + "seed: 4\n")
    check_error(f"{message}\n", f"w.yaml:{STRAIGHT.count(chr(10)) + 1}:1: seed:", "twice", "line 3")


def test_billion_laughs_are_refused_at_once():
    """A few more than are allowed first: a reader that takes these never ends with the others."""
    for names in ("abcdef", "abcdefghi"):
        lines = ["a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
        for old, new in pairwise(names):
            lines.append(f"{new}: &{new} [{', '.join(['*' + old] * 9)}]")
        assert re.search(facts("500000", "values"), refusal("\n".join(lines)))


@pytest.mark.parametrize("text", ["[" * 100_000, "- " * 100_000, "a: " + "{a: " * 5_000])
def test_nesting_is_told_as_such_however_far_ahead_the_parser_looks(text):
    check_error(f"{refusal(text)}\n", "w.yaml:1:", "nested", "50")


def test_merge_keys_are_refused():
    text = STRAIGHT.replace("expect: {contacts: 0}", "expect: {<<: {contacts: 0}}")
    assert "merge keys" in refusal(text)


def test_aliases_are_read_as_what_they_stand_for():
    text = STRAIGHT.replace(
        "footprint: {length: 1.8, width: 1.0}  # [m]", "footprint: &box {length: 1.8, width: 1.0}"
    ).replace("footprint: {length: 1.8, width: 1.0}\n", "footprint: *box\n")
    assert "*box" in text
    assert parse_world(text) == parse_world(STRAIGHT)


def test_keys_that_could_break_a_message_are_not_repeated():
    message = refusal(STRAIGHT + '"a\\nb": 1\n')
    assert '"a\\u000ab" cannot be a key' in message
    assert '"' + "k" * 40 + "…" in refusal(STRAIGHT + "k" * 500 + ": 1\n")


def verdict(text: str) -> str:
    """``world`` or ``refused``; any other error fails the test that asks."""
    try:
        parse_world(text)
    except WorldError as error:
        return "refused" if error.positions else "refused without a place"
    return "world"


def test_every_cut_of_a_world_is_a_world_or_a_refusal():
    verdicts = [verdict(STRAIGHT[:end]) for end in range(len(STRAIGHT))]
    assert verdicts.count("world") > 10
    assert verdicts.count("refused") > 500
    assert set(verdicts) == {"world", "refused"}


@examples(30, deep=200)
@given(st.binary(max_size=8), st.integers(0, len(STRAIGHT)), st.integers(0, 8))
def test_damaged_worlds_are_worlds_or_refusals(junk, at, removed):
    text = STRAIGHT[:at] + junk.decode("latin-1") + STRAIGHT[at + removed :]
    assert verdict(text) in ("world", "refused")


@examples(30, deep=200)
@given(st.from_regex(r"[-+.0-9_eExXob:infaNIF]{1,9}", fullmatch=True))
def test_a_number_that_is_read_is_what_python_reads(text):
    try:
        value = scalar(text)
    except RefusedScalarError:
        return
    if isinstance(value, int | float) and not isinstance(value, bool):
        assert value == float(text)
    else:
        assert isinstance(value, str)


def test_aliases_cannot_nest_deeper_than_brackets_may():
    text = "a0: &a0 [[[[[[[[[[1]]]]]]]]]]\n"
    for k in range(1, 6):
        text += f"a{k}: &a{k} [[[[[[[[[[*a{k - 1}]]]]]]]]]]\n"
    assert re.search(facts("nested", "50"), refusal(text))


def test_floods_of_keys_and_faults_end_early():
    flood = "\n".join(f"k{i}: 1" for i in range(5000))
    check_error(f"{refusal(flood)}\n", "w.yaml:1001:1:", "1000 keys")
    with pytest.raises(WorldError) as caught:
        parse_world("seed: [" + "yes, " * 5000 + "]")
    assert len(caught.value.faults) == MOST_FAULTS + 1


def test_faults_of_one_cause_are_one_line():
    """Each of a hundred robots that a script writes has the same two faults; some have a third."""
    robots = "".join(
        f'- {{name: r{k}, footprint: {{length: "1.{k}", width: 1.0}}, pose: [0, 0, 0], headng: 1, '
        f"mass: {-1 if k % 10 == 3 else 1}, path: [[0, 0], [9, 0]]}}\n"
        for k in range(100)
    )
    with pytest.raises(WorldError) as caught:
        parse_world(f"name: w\ntime: {{step: 0.01, duration: 1}}\nrobots:\n{robots}", "w.yaml")
    first, second, third = str(caught.value).splitlines()
    for line, row, *parts in (
        (first, 4, "robots[0].footprint.length", '"1.0"', "99 more", "robots[1] to robots[99]"),
        (second, 4, "robots[0].headng", "99 more", "robots[1] to robots[99]"),
        (third, 7, "robots[3].mass", "9 more", "robots[13] to robots[93]"),
    ):
        check_error(f"{line}\n", f"w.yaml:{row}:", *parts)
    assert len(caught.value.faults) == len(caught.value.positions) == 210
