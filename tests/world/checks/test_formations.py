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


@pytest.mark.parametrize(
    ("pose", "path", "is_told"),
    [
        ("9.0, 1.0", "offset: 1.0", True),  # wholly ahead of the one that is to lead
        ("9.0, 1.0", "offset: -1.0", False),  # but beside it, on a path of its own
        ("6.6, 1.0", "offset: 1.0", False),  # next to it, past its middle
        ("3.0, 1.0", "offset: 1.0", False),  # in the order of the leads
    ],
)
def test_an_order_against_that_of_the_start_is_a_warning(tmp_path, pose, path, is_told):
    text = CORRIDOR.replace("3.0, -1.0", pose).replace("offset: -1.0", path)
    text = text.replace("[6.0, 1.0, 0.0]", "[6.0, -1.0, 0.0]")
    _, warnings = lines(check(tmp_path, text))
    told = with_facts(warnings, "formation.spacing[0]")
    assert len(told) == is_told
    for one in told:
        check_finding(one, "13:23 formation.spacing[0]", '"a"', "3 m ahead", '"b"', "3 m behind")


def test_the_reference_path_is_longer_than_the_formation(tmp_path):
    error = only_error(tmp_path, changed(CORRIDOR, ("-3.0]", "-31.0]")))
    check_finding(error, "3:24 corridor.centreline", "30 m", "formation 31 m")
    warning = only_warning(tmp_path, changed(CORRIDOR, ("-3.0]", "-28.0], range: 30.0")))
    figures = ("station 3.00 m", "stop station, 2.00 m")
    check_finding(warning, "11:11 robots[1].pose", '"b"', *figures)


def test_a_run_too_short_to_finish_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("duration: 60.0", "duration: 20.0")) + "expect: {finished: true}\n"
    warning = only_warning(tmp_path, text)
    figures = ("24 m", "24 s at 1 m/s", "20 s", "expect.finished")
    check_finding(warning, "2:30 time.duration", "short", '"a"', *figures)
    assert lines(check(tmp_path, text.replace("finished: true", "contacts: 0"))) == ([], [])


def test_a_steady_speed_outside_its_limits_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("{spacing", "{speed: 1.5, spacing"))
    given = ("1.5 m/s", "formation.limits", "at most 1.3 m/s")  # a run tells it, too
    check_finding(only_warning(tmp_path, text), "13:20 formation.speed", *given)
    slow = changed(CORRIDOR, ("{spacing", "{limits: [1.1, 1.3], spacing"))
    given = ("1 m/s", "outside", "1.1 to 1.3 m/s", "at 1.1 m/s")
    check_finding(only_warning(tmp_path, slow), "13:21 formation.limits", *given)


@pytest.mark.parametrize(
    ("spacing", "bound"),
    [
        ("[0.0, -3.0]", 4.0),  # 0.2 m/s over 1 neighbour x 0.5 m/s x 0.1 s
        ("[0.0, -5.0]", 1.0),  # both 2 m from their places: 0.2 m/s over a tenth of that
        ("initial", 4.0),
    ],
)
@pytest.mark.parametrize("neighbours", ["range", "all", "[[a, b]]"])
def test_a_gain_that_saturates_the_cluster_is_a_warning_with_its_bound(
    tmp_path, spacing, bound, neighbours
):
    def text(gain: float) -> str:
        plan = f"{{gain: {gain}, neighbours: {neighbours}, spacing: {spacing}}}"
        return changed(CORRIDOR, ("{spacing: [0.0, -3.0]}", plan))

    assert lines(check(tmp_path, text(0.99 * bound))) == ([], [])
    warning = only_warning(tmp_path, text(1.01 * bound))
    figures = (f"{1.01 * bound:.3g} 1/s", f"at most {bound:.3g} 1/s", "0.2 m/s")
    check_finding(warning, "13:19 formation.gain", *figures)


def test_a_robot_slower_than_the_formation_cannot_keep_up(tmp_path):
    slow = ("path: {offset: -1.0}", "path: {offset: -1.0}\n    limits: {v: 0.5}")
    _, warnings = lines(check(tmp_path, changed(CORRIDOR, slow)))
    assert len(warnings) == 1
    figures = ("at most 0.5 m/s", "formation.limits", "at least 0.8 m/s")
    check_finding(warnings[0], "13:17 robots[1].limits.v", '"b"', *figures)
    fast = (slow[0], slow[1].replace("0.5", "0.8"))
    assert lines(check(tmp_path, changed(CORRIDOR, fast))) == ([], [])
