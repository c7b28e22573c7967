"""Values that are of no world, each refused where it stands; and what is odd but good."""

from __future__ import annotations

import pytest

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
    "very large": (number("1.0e+308"), ("E", LENGTH, "at most 1000", "1e+308")),
    "a list": (number("[1.0]"), ("E", LENGTH, "number", "list of 1")),
    "two points": (number("0..05"), ("E", LENGTH, '"0..05"', "bare number")),
    "a coordinate nan": (boundary("[[0, 0], [.nan, 1], [2, 0]]"), ...,
        ("E", AT, "boundaries[1][1][0]", ".nan")),
    "one coordinate": (boundary("[[0], [1]]"), ...,
        ("E", AT, "boundaries[1][0][1]", "one more number")),
    "a flat list": (boundary("[0, 0, 1, 0]"), ...,
        ("E", AT, "boundaries[1]", "points [x, y]", "list of 4")),
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
    "a step that hides arrivals": (timed("step: 10, duration: 100"),
        ("E", "2:14 time.step", "at most 0.5 [s]", "given 10")),
    "a step longer than the run": (timed("step: 0.5, duration: 0.1"), ...,
        ("E", "2:14 time.step", "0.5 s", "longer", "0.1 s")),
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
