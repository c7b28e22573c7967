"""Every pitfall of YAML, refused where it stands; nothing executed; no other error than ours."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.errors import WorldError
from physim.world.file import parse_world, read_document, reading
from physim.world.file.pitfalls import RefusedScalarError, scalar
from tests.worlds_by_hand import STRAIGHT

SUITE = Path(__file__).parents[2] / ".." / "shared" / "cases" / "bad_worlds"


def refusal(text: str) -> str:
    """First line of the message that refuses ``text``."""
    with pytest.raises(WorldError) as caught:
        parse_world(text, "w.yaml")
    assert len(caught.value.positions) == len(caught.value.faults)
    return str(caught.value).splitlines()[0]


def with_seed(text: str) -> str:
    return STRAIGHT.replace("seed: 3", f"seed: {text}")


@pytest.mark.parametrize(
    ("given_text", "advice"),
    [
        ("1e3", "write 1.0e+3 or 1000"),
        ("1.0e3", "write 1.0e+3 or 1000"),
        ("1e-9", "write 1.0e-9"),
        ("1:30", "base 60"),
        ("yes", "write true"),
        ("Off", "write false"),
        ("010", "octal"),
        ("0o10", "octal"),
        ("0x10", "not decimal; write 16"),
        ("1_000", "write 1000"),
        (".nan", "not a finite number"),
        ("-.inf", "not a finite number"),
        ("1" * 5000, "5000 digits"),
        ("9" * 400 + ".0", "must be finite"),
        ("", "empty value"),
        ("~", "empty value"),
        ("nan", 'must be a whole number; given "nan"; it must be finite'),
        ('"3"', "write the number without quotes"),
        ("!!python/object/apply:os.system ['touch pwned']", "tag"),
        ("!include other.yaml", "tag"),
        ("!!int 3", "tag"),
    ],
)
def test_ambiguous_values_are_refused_with_their_place(given_text, advice):
    message = refusal(with_seed(given_text))
    assert message.startswith("w.yaml:3:")
    assert "seed: " in message
    assert advice in message


def test_one_ambiguous_value_is_one_fault():
    with pytest.raises(WorldError) as caught:
        parse_world(with_seed("yes"), "w.yaml")
    assert str(caught.value) == (
        'w.yaml:3:7: seed: yes may be read as true; write true, or "yes" for a text'
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1\n\tb: 2", "w.yaml:2:1: a tab in the indentation"),
        ("a:\t[1,\n\t2", "w.yaml:2:1: a tab"),
        ("a: 1\n---\nb: 2", "w.yaml:2:1: a second document"),
        ("a: 1\n...\nb: 2", "w.yaml:3:1: "),
        ("a: &x [1, *x]", "w.yaml:1:11: alias *x contains itself"),
        ("a: *x", "w.yaml:1:4: no anchor &x"),
        ("a: \x07", "w.yaml:1:4: character U+0007"),
        (
            "a: [1, 2",
            'w.yaml:1:4: not valid YAML: "[" opened here is not closed by the end of the text',
        ),
        (
            "a: {b: 1\nc: 2",
            'w.yaml:1:4: not valid YAML: "{" opened here is not closed before line 2',
        ),
        ("? [a, b]\n: 1", "w.yaml:1:3: a list or mapping cannot be a key"),
        ("a: " + "[" * 60, "w.yaml:1:53: nested deeper than 50"),
        ("a:\n  b: 1\n b: 2", "w.yaml:3:"),
        ("- 1", "w.yaml:1:1: a world is a mapping"),
        ("just words", "w.yaml:1:1: a world is a mapping"),
        ("", "w.yaml:1:1: the file is empty"),
        ("# nothing\n", "w.yaml:1:1: the file is empty"),
        ("null", "w.yaml:1:1: "),
        ("%YAML 1.1\n%YAML 1.1\n---\na: 1", "w.yaml:2:1: "),
    ],
)
def test_texts_that_are_no_world_are_refused_with_one_place(text, expected):
    assert refusal(text).startswith(expected)


def test_a_duplicate_key_is_told_at_the_second_place():
    message = refusal(STRAIGHT + "seed: 4\n")
    expected = f"w.yaml:{STRAIGHT.count(chr(10)) + 1}:1: seed: key given twice, first on line 3"
    assert expected in message


def test_billion_laughs_are_refused_at_once():
    lines = ["a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    for old, new in zip("abcdefgh", "bcdefghi", strict=True):
        lines.append(f"{new}: &{new} [{', '.join(['*' + old] * 9)}]")
    assert "more than 500000 values" in refusal("\n".join(lines))


def test_aliases_cannot_nest_deeper_than_brackets_may():
    text = "a0: &a0 [[[[[[[[[[1]]]]]]]]]]\n"
    for k in range(1, 6):
        text += f"a{k}: &a{k} [[[[[[[[[[*a{k - 1}]]]]]]]]]]\n"
    assert "nested deeper than 50" in refusal(text)


def test_floods_of_keys_and_faults_end_early():
    flood = "\n".join(f"k{i}: 1" for i in range(5000))
    assert "w.yaml:1001:1: more than 1000 keys in one mapping" in refusal(flood)
    with pytest.raises(WorldError) as caught:
        parse_world("seed: [" + "yes, " * 5000 + "]")
    assert len(caught.value.faults) == reading.MOST_FAULTS


def test_merge_keys_are_refused():
    text = STRAIGHT.replace("expect: {contacts: 0}", "expect: {<<: {contacts: 0}}")
    assert "merge keys" in refusal(text)


def test_aliases_are_read_as_what_they_stand_for():
    text = STRAIGHT.replace(
        "footprint: {length: 1.8, width: 1.0}  # [m]", "footprint: &box {length: 1.8, width: 1.0}"
    ).replace("footprint: {length: 1.8, width: 1.0}\n", "footprint: *box\n")
    assert "*box" in text
    assert parse_world(text) == parse_world(STRAIGHT)


def test_a_byte_order_mark_changes_nothing():
    assert parse_world("\ufeff" + STRAIGHT) == parse_world(STRAIGHT)


@pytest.mark.parametrize("name", ["../../etc/passwd", "a'b\"c", "<b>x</b>", "corridor 🤖", "=1+1"])
def test_names_are_labels(name):
    world = parse_world(STRAIGHT).changed(name=name)
    assert parse_world(world.to_yaml()).name == name


def test_keys_that_could_break_a_message_are_not_repeated():
    message = refusal(STRAIGHT + '"a\\nb": 1\n')
    assert '"a\\nb" cannot be a key' in message
    assert '"' + "k" * 40 + "…" in refusal(STRAIGHT + "k" * 500 + ": 1\n")


def test_given_values_are_repeated_only_briefly():
    message = refusal(STRAIGHT.replace("seed: 3", "seed: " + "long " * 5000))
    assert len(message) < 200


def verdict(text: str) -> str:
    """``world`` or ``refused``; any other error fails the test that asks."""
    try:
        parse_world(text)
    except WorldError as error:
        return "refused" if error.positions else "refused without a place"
    return "world"


@pytest.mark.parametrize("loader", ["CSafeLoader", "SafeLoader"])
def test_every_cut_of_a_world_is_a_world_or_a_refusal(loader, monkeypatch):
    monkeypatch.setattr(reading, "Loader", getattr(reading.yaml, loader, reading.yaml.SafeLoader))
    verdicts = [verdict(STRAIGHT[:end]) for end in range(len(STRAIGHT))]
    assert verdicts.count("world") > 10
    assert verdicts.count("refused") > 500
    assert set(verdicts) == {"world", "refused"}


@given(st.binary(max_size=8), st.integers(0, len(STRAIGHT)), st.integers(0, 8))
def test_damaged_worlds_are_worlds_or_refusals(junk, at, removed):
    text = STRAIGHT[:at] + junk.decode("latin-1") + STRAIGHT[at + removed :]
    assert verdict(text) in ("world", "refused")


@given(st.text(max_size=60))
def test_any_text_is_a_world_or_a_refusal(text):
    with pytest.raises(WorldError):
        parse_world(text)


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


@pytest.mark.skipif(not SUITE.exists(), reason="the shared cases are not here")
def test_no_text_of_the_yaml_suite_is_a_world():
    cases = json.loads((SUITE / "yaml_test_suite.json").read_text())["cases"]
    assert len(cases) >= 400
    for case in cases:
        with pytest.raises(WorldError) as caught:
            parse_world(case["yaml"], "w.yaml")
        assert all(len(line) < 600 for line in str(caught.value).splitlines()), case["id"]


def test_positions_are_those_of_the_text():
    document = read_document("a: 1\nb:\n  - {c: [1, 2]}\n", "f")
    assert str(document.position(("b", 0, "c", 1))) == "f:3:13"
    assert str(document.position(("b", 0, "c"), key=True)) == "f:3:6"
    assert str(document.position(("b", 0, "missing"))) == "f:3:5"
    assert str(document.position(("missing",))) == "f:1:1"


def test_a_quoted_key_with_a_colon_is_a_key() -> None:
    document = read_document('controller: {type: odd, "A:0": 1.0}', "w.yaml")
    assert not document.faults
    assert document.values() == {"controller": {"type": "odd", "A:0": 1.0}}
