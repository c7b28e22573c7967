"""The formation: spacing, length, speed, gain, and the time that a run needs for it."""

from __future__ import annotations

import pytest

from tests.world.worlds import (
    CORRIDOR,
    changed,
    check,
    check_finding,
    lines,
    only_error,
    only_warning,
    with_facts,
)


@pytest.mark.parametrize(
    ("spacing", "gap"), [("[0.0, 0.0]", "0 m"), ("[0.0, -1.8]", "1.8 m"), ("[0.0, -1.0]", "1 m")]
)
def test_spacing_is_longer_than_the_footprints(tmp_path, spacing, gap):
    text = changed(CORRIDOR, ("[0.0, -3.0]", spacing), ("offset: -1.0", "offset: 1.0"))
    error = only_error(tmp_path, text)
    column = 12 + len("{spacing: [0.0, ")
    check_finding(error, f"13:{column} formation.spacing[1]", gap, '"a"', '"b"', "overlap")
    abreast = changed(CORRIDOR, ("[0.0, -3.0]", spacing))
    assert lines(check(tmp_path, abreast)) == ([], [])


def test_the_reference_path_is_longer_than_the_formation(tmp_path):
    error = only_error(tmp_path, changed(CORRIDOR, ("-3.0]", "-31.0]")))
    check_finding(error, "3:24 corridor.centreline", "30 m", "formation 31 m")
    warning = only_warning(tmp_path, changed(CORRIDOR, ("-3.0]", "-28.0], range: 30.0")))
    figures = ("station 3.00 m", "stop station, 2.00 m")
    check_finding(warning, "11:11 robots[1].pose", '"b"', *figures)


def test_a_steady_speed_outside_its_limits_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("{spacing", "{speed: 1.5, spacing"))
    given = ("1.5 m/s", "formation.limits", "at 1.3 m/s")
    check_finding(only_warning(tmp_path, text), "13:20 formation.speed", *given)
    slow = changed(CORRIDOR, ("{spacing", "{limits: [1.1, 1.3], spacing"))
    given = ("1 m/s", "outside", "at 1.1 m/s")
    check_finding(only_warning(tmp_path, slow), "13:21 formation.limits", *given)


def test_a_robot_slower_than_the_formation_cannot_keep_up(tmp_path):
    slow = ("path: {offset: -1.0}", "path: {offset: -1.0}\n    limits: {v: 0.5}")
    _, warnings = lines(check(tmp_path, changed(CORRIDOR, slow)))
    assert len(warnings) == 1
    figures = ("at most 0.5 m/s", "formation.limits", "at least 0.8 m/s")
    check_finding(warnings[0], "13:17 robots[1].limits.v", '"b"', *figures)
    fast = (slow[0], slow[1].replace("0.5", "0.8"))
    assert lines(check(tmp_path, changed(CORRIDOR, fast))) == ([], [])


def four(neighbours: str, spacing: str = "[0, -5, -10, -15]", gap: float = 5.0) -> str:
    """Robots in formation, 4 m apart two by two, with ``gap`` between b and c."""
    robots = "".join(
        f"  - {{name: {name}, footprint: {{length: 1.2, width: 0.7}}, pose: [{x}, 0, 0], "
        "path: {offset: 0}}\n"
        for name, x in zip("abcd", (24 + gap, 20 + gap, 20, 16), strict=True)
    )
    return (
        "name: four\ntime: {step: 0.01, duration: 60.0}\n"
        f"corridor: {{centreline: [[0, 0], [80, 0]], width: 6.0}}\nrobots:\n{robots}"
        f"formation: {{gain: 0.1, spacing: {spacing}, {neighbours}}}\nsensing: {{range: 12.0}}\n"
    )


@pytest.mark.parametrize(
    ("told", "untold", "parts"),
    [
        (four("range: 4.99"), four("range: 6.0"), ("formation.range", "in formation", "4.99 m")),
        (
            four("range: 6.0", gap=9.0),
            four("range: 1.0, neighbours: all", gap=9.0),
            ("formation.range", "at the start", '"c", "d"', "6 m"),
        ),
        (
            four("neighbours: [[a, b], [c, d]]"),
            four("neighbours: [[d, a], [a, b], [c, b]]"),
            ("formation.neighbours", '"c", "d"'),
        ),
    ],
)
def test_a_formation_in_parts_that_no_neighbours_connect_is_a_warning(
    tmp_path, told, untold, parts
):
    assert with_facts(lines(check(tmp_path, told))[1], "whatever the gain", *parts)
    assert not with_facts(lines(check(tmp_path, untold))[1], "whatever the gain")
