"""The shared collections of bad inputs, handled as they expect.

The 400 YAML texts stand as whole worlds. The 72 small faults are in neutral keys, so each is
translated into a world of ours: either the snippet's own bytes stand as the file (``WHOLE``), or a
good world gets the same fault in our keys (``TRANSLATED``). ``BAD`` refuses, ``GOOD`` accepts,
``DOUBTFUL`` accepts with a warning; with the facts that one finding must name.
"""

from __future__ import annotations

import os
import re

import pytest

from physim.world.checks import Findings, check_world
from tests.helpers import facts
from tests.world.worlds import CORRIDOR, DRAWN, changed, with_facts

BAD, GOOD, DOUBTFUL = "refuse", "accept", "accept with a warning"


PLACE = "boundaries:\n  - [[-3, -4], [33, -4], [33, 4]]\n"
BOX = "length: 1.8, width: 1.0}\n    pose: [6.0"
FIRST = "footprint: {length: 1.8, width: 1.0}\n    pose: [6.0, 1.0, 0.0]"
PATH = "path: {offset: 1.0}"


def number(given: str) -> str:
    """A world whose first robot has this length."""
    return changed(CORRIDOR, (BOX, BOX.replace("1.8", given)))


def boundary(given: str) -> str:
    """A world with one more boundary."""
    return changed(DRAWN, (PLACE, f"{PLACE}  - {given}\n"))


def outline(given: str, pose: str = "[6.0, 1.0, 0.0]") -> str:
    """A world whose first robot has these corners."""
    return changed(CORRIDOR, (FIRST, f"footprint: {given}\n    pose: {pose}"))


def path(given: str) -> str:
    """A world whose first robot has this path."""
    return changed(CORRIDOR, (PATH, f"path: {given}"), ("formation: {spacing: [0.0, -3.0]}\n", ""))


def walls(left: str, right: str, given: str, box: str = "{length: 1.8, width: 1.0}") -> str:
    """A world between two walls with closed ends, and one robot on a path."""
    ends = [line.strip("[]").split("], [") for line in (left, right)]
    first, last = ([f"[{line[k]}]" for line in ends] for k in (0, -1))
    return (
        f"name: w\ntime: {{step: 0.01, duration: 5.0}}\nboundaries:\n  - {left}\n  - {right}\n"
        f"  - [{', '.join(first)}]\n  - [{', '.join(last)}]\nreference_path: {given}\n"
        f"robots: [{{name: a, footprint: {box}, pose: [2, 0, 0], path: {given}}}]\n"
    )


def robot(given: str) -> str:
    """A world whose first robot has these keys, too."""
    return changed(CORRIDOR, (PATH, f"{PATH}\n    {given}"))


SMALL = "{length: 0.6, width: 0.4}"
TRANSLATED = {
    "utf8_bom": ("\ufeff" + CORRIDOR, GOOD),
    "emoji_name": (changed(CORRIDOR, ("name: corridor", 'name: "corridor 🤖"')), GOOD),
    "num_nan": (number(".nan"), BAD, ".nan", "finite"),
    "num_neg_inf": (number("-.inf"), BAD, "-.inf", "finite"),
    "num_inf_word": (number("Infinity"), BAD, '"Infinity"', "finite"),
    "num_exp_dot": (number("1.0e3"), BAD, "1.0e3", "text", "1.0e+3"),
    "num_octal": (number("010"), BAD, "010", "octal", "leading zeros"),
    "num_quoted": (number('"1.0"'), BAD, '"1.0"', "text", "without quotes"),
    "num_yes": (number("yes"), BAD, "yes", "true"),
    "num_huge": (number("1.0e+308"), BAD, "at most 1000", "1e+308"),
    "num_bigint": (number("1" + "0" * 400), BAD, "401 digits", "at most 18"),
    "num_hex": (number("0x10"), BAD, "0x10", "decimal", "16"),
    "num_null": (number("~"), BAD, "empty"),
    "num_list": (number("[1.0]"), BAD, "number", "list of 1"),
    "num_coord_nan": (boundary("[[0, 0], [.nan, 1], [2, 0]]"), BAD, "boundaries[1][1][0]", ".nan"),
    "num_one_coord": (boundary("[[0], [1]]"), BAD, "boundaries[1][0][1]", "one more number"),
    "num_flat": (boundary("[0, 0, 1, 0]"), BAD, "boundaries[1]", "points", "[[0, 0], [1, 0]]"),
    "num_point_map": (boundary("[{x: 0, y: 0}, {x: 1, y: 0}]"), BAD, "list", "given a mapping"),
    "boundary_one_point": (boundary("[[0, 0]]"), BAD, "boundaries[1]", "at least 2", "given 1"),
    "boundary_duplicate_neighbour": (
        boundary("[[0, 3], [1, 3], [1, 3], [2, 3]]"), BAD, "boundaries[1][2]", "repeats",
    ),
    "boundary_self_crossing": (
        boundary("[[0, 2], [1, 3], [1, 2], [0, 3]]"), DOUBTFUL, "crosses itself", "(0.5, 2.5)",
    ),
    "boundary_huge_offset": (
        boundary("[[1.0e+9, 1.0e+9], [1.0e+9, 1.000000001e+9]]"),
        BAD, "at most 1000000", "1000000000.0",
    ),
    "boundary_tiny": (boundary("[[0, 3], [1.0e-12, 3]]"), BAD, "boundaries[1][1]", "repeats"),
    "walls_swapped": (
        # boundaries have no sides here: whatever encloses the path is the road
        walls("[[0, -3], [20, -3]]", "[[0, 3], [20, 3]]", "[[2, 0], [18, 0]]"), GOOD,
    ),
    "walls_touch": (
        walls("[[0, 3], [10, 0], [20, 3]]", "[[0, -3], [10, 0], [20, -3]]", "[[2, 0], [18, 0]]"),
        BAD, "boundaries[1]", "crosses", "boundaries[0]", "(10, 0)",
    ),
    "too_narrow": (
        walls("[[0, 0.1], [20, 0.1]]", "[[0, -0.1], [20, -0.1]]", "[[2, 0], [18, 0]]", SMALL),
        BAD, "robots[0].path", '"a"', "not fit", "station",
    ),
    "poly_collinear": (outline("[[0, 0], [1, 0], [2, 0]]"), BAD, "footprint", "no area"),
    "poly_concave": (outline("[[0, 0], [1, 0], [0.5, 0.2], [0.5, 1]]"), GOOD),
    "poly_closed": (outline("[[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]"), GOOD),
    "poly_off_origin": (
        changed(outline("[[5, 0], [6, 0], [6, 1], [5, 1]]"), ("step: 0.01", "step: 0.005")),
        DOUBTFUL, "footprint", "5 m", "outside",
    ),
    "poly_5000": (
        outline(f"[{', '.join(f'[{k / 5000}, {(k % 2) / 100}]' for k in range(5000))}, [0, 1]]"),
        BAD, "at most 2000", "5001",
    ),
    "path_repeat": (path("[[0, 1], [1, 1], [1, 1], [30, 1]]"), BAD, "robots[0].path[2]", "repeats"),
    "path_u_turn": (  # it does not get past that place
        path("[[0, 1], [20, 1], [0, 1]]"), DOUBTFUL, "robots[0].path", "180 degrees", "(20, 1)",
    ),
    "path_hits_wall_mid_segment": (
        walls(
            "[[0, 3], [8, 3], [10, -0.2], [12, 3], [20, 3]]", "[[0, -3], [20, -3]]",
            "[[2, 0], [18, 0]]",
        ),
        BAD, "robots[0].path", '"a"', "leaves", "7.88 m", "8.12 m",
    ),
    "path_clearance_too_small": (
        walls("[[0, 0.55], [20, 0.55]]", "[[0, -3], [20, -3]]", "[[2, 0.4], [18, 0.4]]", SMALL)
        + "controller: {type: path_following}\n",
        BAD, "robots[0].path", '"a"', "not fit", "station 0.00 m", "(2, 0.4)", "0.15 m", "0.2 m",
    ),
    "start_identical": (
        changed(CORRIDOR, ("[3.0, -1.0,", "[6.0, 1.0,")), BAD, '"b"', "overlaps", '"a"',
    ),
    "start_in_wall": (changed(CORRIDOR, ("[6.0, 1.0,", "[6.0, 4.0,")), BAD, '"a"', "0.5 m", "over"),
    "start_backwards": (
        changed(CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 1.0, 3.14159]")),
        DOUBTFUL, '"a"', "180 degrees",
    ),
    "pose_missing_heading": (
        changed(CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 1.0]")),
        BAD, "robots[0].pose[2]", "one more number",
    ),
    "robots_is_map": (
        CORRIDOR[: CORRIDOR.index("robots:")] + "robots: {a: {pose: [0, 0, 0]}}\n",
        BAD, "robots", "list", "mapping",
    ),
    "robot_duplicate_name": (
        changed(CORRIDOR, ("name: b", "name: a")), BAD, "robots[1].name", '"a"', "robots[0]",
    ),
    "robot_name_path": (changed(CORRIDOR, ("name: b", 'name: "../../etc/x"')), GOOD),
    "robot_name_csv": (changed(CORRIDOR, ("name: b", 'name: "=1+1,b"')), GOOD),
    "robot_name_no": (changed(CORRIDOR, ("name: b", "name: no")), BAD, "no", "false"),
    "formation_unknown_robot": (
        changed(CORRIDOR, ("-3.0]}", "-3.0], neighbours: [[a, zed]]}")), BAD, '"zed"', "a, b",
    ),
    "formation_cycle": (
        # neighbours are pairs, not a chain: one given in both senses is one pair twice
        changed(CORRIDOR, ("-3.0]}", "-3.0], neighbours: [[a, b], [b, a]]}")),
        BAD, "formation.neighbours[1]", "twice",
    ),
    "formation_zero": (
        changed(CORRIDOR, ("-3.0]}", "0.0]}"), ("offset: -1.0", "offset: 1.0")),
        BAD, "formation.spacing[1]", "0 m", '"a"', '"b"', "overlap",
    ),
    "formation_count": (
        changed(CORRIDOR, ("-3.0]}", "-3.0, -6.0]}")), BAD, "3 leads", "2 robots",
    ),
    "dt_zero": (changed(CORRIDOR, ("step: 0.01", "step: 0")), BAD, "time.step", "at least 1e-06"),
    "dt_larger_than_duration": (
        changed(CORRIDOR, ("step: 0.01, duration: 60.0", "step: 10, duration: 1")),
        BAD, "time.step", "10.0 s", "longer", "1.0 s",
    ),
    "duration_not_multiple": (
        # stricter than asked: the nearest two durations are named
        changed(CORRIDOR, ("step: 0.01, duration: 60.0", "step: 0.03, duration: 1.0")),
        BAD, "1.0 s", "0.03 s", "0.99", "1.02",
    ),
    "speeds_negative_only": (robot("speeds: [-0.5]"), DOUBTFUL, "above 0", "forward"),
    "omegas_no_zero": (robot("omegas: [-1.0, 1.0]"), DOUBTFUL, "straight on", "0"),
    "speed_huge": (robot("speeds: [0, 1.0e+6]"), BAD, "speeds[1]", "at most 1", "1000000.0"),
}  # fmt: skip


def outcome(found: Findings) -> str:
    if not found.ok:
        return BAD
    return DOUBTFUL if found.warnings else GOOD


@pytest.mark.parametrize("name", TRANSLATED)
def test_translated_snippets(tmp_path, name):
    text, expected, *parts = TRANSLATED[name]
    file = tmp_path / "w.yaml"
    file.write_text(text, encoding="utf-8")
    found = check_world(file)
    lines = [str(finding) for finding in (*found.errors, *found.warnings)]
    assert outcome(found) == expected, lines
    assert all(len(line) < 700 for line in lines)
    if parts:
        assert with_facts(lines, *parts), lines
    for finding in found.errors:
        assert finding.line is not None, finding








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
        "x" * 300 + ".yaml": ["cannot be read", "too long"],
    }
    for name, parts in reasons.items():
        found = check_world(tmp_path / name)
        (error,) = found.errors
        assert re.search(facts(*parts), error.message), error.message
        assert found.clearance == ()
        assert str(found.errors[0]).isprintable()


def test_file_names_cannot_break_a_message(tmp_path):
    for name in ("two words.yaml", 'it\'s "quoted".yaml', "a\nb.yaml", "<b>.yaml", "\x1b[2J.yaml"):
        file = tmp_path / name
        file.write_text(changed(CORRIDOR, ("name: b", "nam: b")))
        found = check_world(file)
        assert len(found.errors) == 1
        assert str(found.errors[0]).isprintable()
        assert found.file.isprintable()
        assert found.errors[0].line == 9
