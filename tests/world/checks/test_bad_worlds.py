"""Values and files that are no world, each refused where it stands; and what is odd but good."""

from __future__ import annotations

import os
import re

import pytest

from physim.world.checks import check_world
from tests.helpers import facts
from tests.world.worlds import CORRIDOR, DRAWN, changed, check, check_told

PLACE = "boundaries:\n  - [[-3, -4], [33, -4], [33, 4]]\n"
BOX = "length: 1.8, width: 1.0}\n    pose: [6.0"
FIRST = "footprint: {length: 1.8, width: 1.0}\n    pose: [6.0, 1.0, 0.0]"
LENGTH = "6:25 robots[0].footprint.length"
AT = "5:"


def number(given: str) -> str:
    """A world whose first robot has this length."""
    return changed(CORRIDOR, (BOX, BOX.replace("1.8", given)))


def boundary(given: str) -> str:
    """A world with one more boundary."""
    return changed(DRAWN, (PLACE, f"{PLACE}  - {given}\n"))


def named(given: str) -> str:
    return changed(CORRIDOR, ("name: b", f"name: {given}"))


def formation(given: str) -> str:
    return changed(CORRIDOR, ("{spacing: [0.0, -3.0]}", given))


def timed(given: str) -> str:
    return changed(CORRIDOR, ("step: 0.01, duration: 60.0", given))


COMB = ", ".join(f"[{k / 5000}, {(k % 2) / 100}]" for k in range(5000))
TOLD = {
    "a byte order mark": ("\ufeff" + CORRIDOR,),
    "nan": (number(".nan"), ("E", LENGTH, ".nan", "finite")),
    "minus infinity": (number("-.inf"), ("E", LENGTH, "-.inf", "finite")),
    "infinity in words": (number("Infinity"), ("E", LENGTH, '"Infinity"', "finite")),
    "an exponent without a sign": (number("1.0e3"), ("E", LENGTH, "1.0e3", "text", "1.0e+3")),
    "octal": (number("010"), ("E", LENGTH, "010", "octal", "leading zeros")),
    "quotes": (number('"1.0"'), ("E", LENGTH, '"1.0"', "text", "without quotes")),
    "yes": (number("yes"), ("E", LENGTH, "yes", "true")),
    "very large": (number("1.0e+308"), ("E", LENGTH, "at most 1000", "1e+308")),
    "very many digits": (number("1" + "0" * 400), ("E", LENGTH, "401 digits", "at most 18")),
    "hexadecimal": (number("0x10"), ("E", LENGTH, "0x10", "decimal", "16")),
    "null": (number("~"), ("E", LENGTH, "empty")),
    "a list": (number("[1.0]"), ("E", LENGTH, "number", "list of 1")),
    "two points": (number("0..05"), ("E", LENGTH, '"0..05"', "no number")),
    "a coordinate nan": (boundary("[[0, 0], [.nan, 1], [2, 0]]"), ...,
        ("E", AT, "boundaries[1][1][0]", ".nan")),
    "one coordinate": (boundary("[[0], [1]]"), ...,
        ("E", AT, "boundaries[1][0][1]", "one more number")),
    "a flat list": (boundary("[0, 0, 1, 0]"), ...,
        ("E", AT, "boundaries[1]", "points [x, y]")),
    "a mapping for a point": (boundary("[{x: 0, y: 0}, {x: 1, y: 0}]"), ...,
        ("E", AT, "list", "given a mapping")),
    "one point": (boundary("[[0, 0]]"), ("E", "5:5 boundaries[1]", "at least 2", "given 1")),
    "a point far off": (boundary("[[1.0e+9, 1.0e+9], [1.0e+9, 1.000000001e+9]]"), ...,
        ("E", AT, "at most 1000000", "1000000000.0")),
    "a tiny piece": (boundary("[[0, 3], [1.0e-12, 3]]"), ...,
        ("E", AT, "boundaries[1][1]", "repeats")),
    "five thousand corners": (changed(CORRIDOR, (FIRST, f"footprint: [{COMB}, [0, 1]]\n"
                                                        "    pose: [6.0, 1.0, 0.0]")),
        ("E", "6:16 robots[0].footprint", "at most 2000", "5001")),
    "robots as a mapping":
        (CORRIDOR[: CORRIDOR.index("robots:")] + "robots: {a: {pose: [0, 0, 0]}}\n", ...,
         ("E", "4:9 robots", "list", "mapping")),
    "two robots of one name": (named("a"),
        ("E", "9:11 robots[1].name", '"a"', "robots[0]")),
    "a path for a name": (named('"../../etc/x"'),),
    "no for a name": (named("no"), ("E", "9:11 robots[1].name", "no", "false")),
    "an unknown neighbour": (formation("{spacing: [0.0, -3.0], neighbours: [[a, zed]]}"),
        ("E", "13:52 formation.neighbours[0][1]", '"zed"', "a, b")),
    "one pair twice": (formation("{spacing: [0.0, -3.0], neighbours: [[a, b], [b, a]]}"),
        ("E", "13:56 formation.neighbours[1]", "twice")),
    "too many leads": (formation("{spacing: [0.0, -3.0, -6.0]}"),
        ("E", "13:22 formation.spacing", "3 leads", "2 robots")),
    "a step of nothing": (timed("step: 0, duration: 60.0"),
        ("E", "2:14 time.step", "at least 1e-06")),
    "a step longer than the run": (timed("step: 10, duration: 1"), ...,
        ("E", "2:14 time.step", "10.0 s", "longer", "1.0 s")),
    "no whole number of steps": (timed("step: 0.03, duration: 1.0"),
        ("E", "2:30 time.duration", "1.0 s", "0.03 s", "0.99", "1.02")),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_what_is_refused_is_told_where_it_stands(tmp_path, name):
    text, *told = TOLD[name]
    found = check(tmp_path, text)
    check_told(found, *told)
    assert all(finding.line is not None for finding in found.errors)
    assert all(len(str(finding)) < 700 for finding in (*found.errors, *found.warnings))


def test_files_of_other_kinds(tmp_path):
    (tmp_path / "dangling.yaml").symlink_to(tmp_path / "nowhere")
    (tmp_path / "loop.yaml").symlink_to(tmp_path / "loop.yaml")
    (tmp_path / "folder.yaml").mkdir()
    os.mkfifo(tmp_path / "pipe.yaml")
    reasons = {
        "missing.yaml": ["no such file"],
        "dangling.yaml": ["no such file"],
        "loop.yaml": ["cannot be read", "symbolic links"],
        "folder.yaml": ["folder", "not a world file"],
        "pipe.yaml": ["not a regular file"],
        "missing/w.yaml": ["no such file", "no folder"],
        "/dev/zero": ["not a regular file"],
        "a\0b.yaml": ["cannot be read", "null byte"],
    }
    for name, parts in reasons.items():
        found = check_world(tmp_path / name)
        (error,) = found.errors
        assert re.search(facts(*parts), error.message), error.message
        assert found.clearance == ()
        assert str(error).isprintable()


def test_a_file_name_that_is_too_long(tmp_path):
    (error,) = check_world(tmp_path / ("x" * 300 + ".yaml")).errors
    assert re.search(facts("cannot be read", "too long"), error.message)
