"""Each pitfall of YAML is told with its place and the way to write what is meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.world.checks import check_world
from tests.checking.worlds import CORRIDOR, changed


def only(folder: Path, data: bytes) -> str:
    """The one error of a file, as ``line:column key message``."""
    file = folder / "w.yaml"
    file.write_bytes(data)
    (found,) = check_world(file).errors
    return f"{found.line}:{found.column} {found.key} {found.message}".replace("  ", " ")


def width(given: str) -> bytes:
    return changed(CORRIDOR, ("width: 8.0", f"width: {given}")).encode()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("1e3", "1e3 is a text to many YAML readers; write 1.0e+3 or 1000"),
        ("1:30", '1:30 may be read in base 60; write a plain number, or "1:30" for a text'),
        ("yes", 'yes may be read as true; write true, or "yes" for a text'),
        ("010", "010 may be read as octal; write it without leading zeros"),
        (".nan", ".nan is not a finite number; finite ones are allowed"),
        ("1_000", "1_000 has underscores; write 1000"),
        ("0x1F", "0x1F is not decimal; write 31"),
        ("9" * 5000, "an integer of 5000 digits; at most 18 are allowed"),
        ("~", "empty value; give one, or leave the key out"),
        ("!!float 8", 'tag "tag:yaml.org,2002:float" is not allowed; write the bare value'),
        ("!!python/object/apply:os.getcwd []",
         'tag "tag:yaml.org,2002:python/object/apply:os…" is not allowed; write the bare value'),
    ],
)  # fmt: skip
def test_values_that_readers_take_differently(tmp_path, given, told):
    error = only(tmp_path, width(given))
    assert error.startswith("3:50 corridor.width ")
    assert told in error


@pytest.mark.parametrize("given", ["nan", "NaN", "inf", "-Infinity"])
def test_nan_and_infinity_as_text(tmp_path, given):
    text = changed(CORRIDOR, ("step: 0.01", f"step: {given}")).encode()
    assert only(tmp_path, text) == (
        f'2:14 time.step must be a number; given "{given}"; it must be finite'
    )


def test_duplicate_keys(tmp_path):
    text = changed(CORRIDOR, ("formation:", "name: again\nformation:")).encode()
    assert only(tmp_path, text) == "13:1 name key given twice, first on line 1; keep one"


def test_tabs(tmp_path):
    text = changed(CORRIDOR, ("    pose: [6.0", "\tpose: [6.0")).encode()
    assert only(tmp_path, text) == "7:1 a tab in the indentation; indent with spaces"


def test_two_documents(tmp_path):
    text = f"{CORRIDOR}---\n{CORRIDOR}".encode()
    assert only(tmp_path, text) == "14:1 a second document; a world file holds one"


def test_anchors_that_loop(tmp_path):
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]]", "&line [[0, 0], *line]")).encode()
    assert only(tmp_path, text) == "3:39 alias *line contains itself"


def test_billion_laughs(tmp_path):
    text = "a: &a [1,1,1,1,1,1,1,1,1]\n" + "".join(
        f"{b}: &{b} [{','.join([f'*{a}'] * 9)}]\n"
        for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    assert only(tmp_path, text.encode()).endswith("more than 500000 values, aliases written out")


def test_deep_nesting(tmp_path):
    deep = "[" * 60 + "]" * 60
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]]", deep)).encode()
    assert only(tmp_path, text) == f"3:{25 + 47} nested deeper than 50 levels"


def test_other_encodings(tmp_path):
    text = changed(CORRIDOR, ("name: corridor", "name: café"))
    assert only(tmp_path, text.encode("latin-1")) == (
        "1:10 byte 0xe9 is not UTF-8; save the file as UTF-8"
    )
    assert "is not UTF-8; save the file as UTF-8" in only(tmp_path, text.encode("utf-16"))


def test_no_yaml_at_all(tmp_path):
    error = only(tmp_path, changed(CORRIDOR, ("width: 8.0}", "width: 8.0")).encode())
    assert error == '3:11 not valid YAML: "{" opened here is not closed before line 4; add "}"'


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("name: corridor", "name:corridor"),
         '1:5 not valid YAML: a space is missing after the colon; write "name: …"'),
        (("    pose: [6.0", "    pose:[6.0"),
         '7:9 not valid YAML: a space is missing after the colon; write "pose: …"'),
        (("step: 0.01", "step:0.01"), "2:12 time.step a space is missing after the colon; "
         'write "step: …"'),
        (("[30, 0]]", "[30, 0]"),
         '3:24 not valid YAML: "[" opened here is closed by "}" at 3:52; close it with "]"'),
        (("    pose: [6.0, 1.0, 0.0]", "    pose: [6.0, 1.0, 0.0"),
         '7:11 not valid YAML: "[" opened here is not closed before line 8; add "]"'),
        (("duration: 60.0}", "duration: 60.0"),
         '2:7 not valid YAML: "{" opened here is not closed before line 3; add "}"'),
        (("[0.0, -3.0]}", "[0.0, -3.0"),
         '13:22 not valid YAML: "[" opened here is not closed by the end of the text; add "]"'),
        (("path: {offset: -1.0}", "path: {offset: -1.0"),
         '12:11 not valid YAML: "{" opened here is not closed before line 13; add "}"'),
        (("[0, 0], [30", "[0, 0] [30"),
         '3:32 not valid YAML: a comma is missing before this, in the "[" opened at 3:24'),
        (("0.01, duration", "0.01 duration"), "2:19 not valid YAML: a comma is missing before"),
        (("name: corridor", 'name: "corridor'), "1:7 not valid YAML: the quote opened here is not"),
        (("name: corridor", "name: a: b"), '1:8 not valid YAML: mapping values are not allowed '
         'in this context; put a text that holds ": " in quotes'),
        (("name: corridor", "name: @home"), "1:7 not valid YAML: found character that cannot start "
         "any token; put the text in quotes"),
    ],
)  # fmt: skip
def test_yaml_mistakes_are_told_where_they_lie(tmp_path, change, told):
    assert only(tmp_path, changed(CORRIDOR, change).encode()).startswith(told)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("0..05", 'must be a number; given "0..05", which is no number; correct it'),
        ('"0.05"', 'given "0.05", which is a text; write the number without quotes'),
    ],
)
def test_a_text_for_a_number_is_told_by_what_it_is(tmp_path, given, told):
    text = changed(CORRIDOR, ("step: 0.01", f"step: {given}")).encode()
    assert told in only(tmp_path, text)


def test_an_entry_of_a_list_without_its_dash(tmp_path):
    file = tmp_path / "w.yaml"
    file.write_text(changed(CORRIDOR, ("  - name: b", "    name: b")), encoding="utf-8")
    first, *others = check_world(file).errors
    assert (first.line, first.key) == (9, "robots[0].name")
    assert first.message == (
        'key given twice, first on line 5; keep one, or put a dash before it ("- ") where the next '
        "entry of the list begins"
    )
    others = [other.message for other in others if other.key.startswith("robots[0]")]
    assert len(others) == 3
    assert all(other.endswith("; keep one") for other in others)


def test_no_dash_is_missing_in_brackets(tmp_path):
    text = "robots: [{name: a, name: b}]\n"
    file = tmp_path / "w.yaml"
    file.write_text(text, encoding="utf-8")
    (twice,) = [e for e in check_world(file).errors if "twice" in e.message]
    assert twice.message.endswith("first on line 1; keep one")


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("'it's'", "1:7 not valid YAML: the text in quotes that begins here ends at 1:10 already; "
         "within it write '' for the quote, or put the text in double quotes"),
        ('"a "b" c"', "1:7 not valid YAML: the text in quotes that begins here ends at 1:10 "
         'already; within it write \\" for the quote, or put the text in single quotes'),
    ],
)  # fmt: skip
def test_a_quote_within_a_quoted_text(tmp_path, given, told):
    assert only(tmp_path, changed(CORRIDOR, ("name: corridor", f"name: {given}")).encode()) == told


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("time:\u00a0{", '2:6 not valid YAML: U+00A0 (no-break space) stands here for " "; type a '
         'plain " "'),
        ("time\uff1a {", '2:5 not valid YAML: U+FF1A (fullwidth colon) stands here for ":"; type a '
         'plain ":"'),
    ],
)  # fmt: skip
def test_characters_that_look_like_yaml(tmp_path, given, told):
    text = changed(CORRIDOR, ("time: {", given))
    assert only(tmp_path, text.encode()).replace(" ", " ") == told


def test_a_comment_without_a_blank_before_it_is_part_of_the_text(tmp_path):
    file = tmp_path / "w.yaml"
    text = changed(CORRIDOR, ("- name: a\n", "- name: a#first\n"))
    file.write_text(text, encoding="utf-8")
    found = check_world(file)
    assert found.ok
    (doubt,) = found.warnings
    assert (doubt.line, doubt.column, doubt.key) == (5, 11, "robots[0].name")
    assert doubt.message.startswith(
        '"a#first": the "#" belongs to the text; a comment needs a blank'
    )
    assert check_world(file, overrides=["robots.0.name=a"]).warnings == ()
    assert len(check_world(file, overrides=["seed=3"]).warnings) == 1
    file.write_text(changed(text, ("a#first", '"a#first"')), encoding="utf-8")
    assert check_world(file).warnings == ()
