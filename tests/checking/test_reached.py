"""Room is judged where robots are to be, and who is left out is said."""

from __future__ import annotations

import pytest

from tests.checking.worlds import DRAWN, changed, check, lines
from tests.helpers import facts, inside

ANY, NOT = inside("physim.world.checks", "ANY", "NOT")

UPPER = "[[33, 4], [-3, 4], [-3, -4]]"


def dented(at: float, depth: float = 2.7) -> str:
    """Boundaries with a dent of the upper one over the path of a, whose room there is 3 m less."""
    return f"[[33, 4], [{at + 1}, 4], [{at}, {4 - depth}], [{at - 1}, 4], [-3, 4], [-3, -4]]"


@pytest.mark.parametrize(("at", "clearance"), [(2.0, 3.0), (15.0, 0.3)])
def test_what_lies_behind_the_start_is_not_judged(tmp_path, at, clearance):
    """a starts at station 6 of 30."""
    found = check(tmp_path, changed(DRAWN, (UPPER, dented(at))))
    a = found.clearance[0]
    assert a.reached == pytest.approx((6.0, 30.0))
    assert a.narrowest[3] == pytest.approx(clearance)
    assert a.verdict == (NOT if clearance < 0.5 else ANY)
    assert a.as_json()["reached"] == {"from": 6.0, "to": 30.0}
    assert (a.danger_share > 0.0) == (at == 15.0)
    assert (NOT in {part.verdict for part in a.stretches}) == (at == 15.0)
    assert found.ok


@pytest.mark.parametrize(("at", "is_judged"), [(28.5, False), (26.0, True)])
def test_what_lies_beyond_the_stop_is_not_judged(tmp_path, at, is_judged):
    """b stops at station 27 of 30, 3 m behind a; the dent is over its path."""
    lower = f"[[-3, -4], [{at - 0.2}, -4], [{at}, -1.3], [{at + 0.2}, -4], [33, -4], [33, 4]]"
    found = check(tmp_path, changed(DRAWN, ("[[-3, -4], [33, -4], [33, 4]]", lower)))
    b = found.clearance[1]
    assert b.reached == pytest.approx((3.0, 27.0))
    assert (b.narrowest[3] < 0.5) == is_judged
    assert (b.verdict == NOT) == is_judged


REGION_BEHIND = DRAWN.replace(
    "pose: [6.0, 1.0, 0.0]", "start: {region: [[5, 0], [9, 0], [9, 3], [5, 3]]}"
)


@pytest.mark.parametrize(("duration", "first"), [("60.0", (5.0, 9.0)), ("60.005", (9.0, 9.0))])
def test_what_lies_behind_a_region_is_not_judged(tmp_path, duration, first):
    """Beside a fault elsewhere the start is not drawn, and was taken for the beginning."""
    text = changed(REGION_BEHIND, (UPPER, dented(2.0)), ("60.0", duration))
    found = check(tmp_path, text)
    assert {fault.key for fault in found.errors} == set(
        () if duration == "60.0" else ["time.duration"]
    )
    a = found.clearance[0]
    assert first[0] <= a.reached[0] <= first[1]
    assert a.verdict == ANY


def test_a_robot_with_a_fault_is_named_as_left_out(tmp_path):
    text = changed(DRAWN, ("path: [[0, 1], [30, 1]]", "path: [[0, 1], [30, x]]"))
    found = check(tmp_path, text)
    assert [profile.robot for profile in found.clearance] == ["b"]
    (note,) = found.notes
    assert facts_in(note, '"a"', "left out")
    assert found.as_json()["notes"] == [note]
    assert check(tmp_path, DRAWN).notes == ()


def test_without_walls_it_is_said_that_no_room_is_judged(tmp_path):
    found = check(
        tmp_path, changed(DRAWN, ("[[-3, -4], [33, -4], [33, 4]]", "[[1, x]]"), (UPPER, "7"))
    )
    assert lines(found)[0]
    assert found.clearance == ()
    assert facts_in(found.notes[0], "not judged", "boundaries")


def test_room_is_not_judged_by_half_of_what_there_is(tmp_path):
    """One obstacle alone was taken for all that stands there."""
    obstacle = "obstacles: [[[40, 9], [42, 9], [42, 10]]]\n"
    for wrong in ((UPPER, "7"), ("[[-3, -4]", "[[-3, x]")):
        found = check(tmp_path, changed(DRAWN, wrong) + obstacle)
        assert found.clearance == ()
        assert facts_in(found.notes[0], "not judged", "boundaries", "obstacles")
    assert check(tmp_path, DRAWN + obstacle).clearance


def facts_in(text: str, *parts: str) -> bool:
    import re

    return re.search(facts(*parts), text) is not None
