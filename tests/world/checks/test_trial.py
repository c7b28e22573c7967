"""``physim check`` runs a world once, and tells what that shows."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path

import pytest

from tests.cli.commands import physim
from tests.helpers import inside

TRIAL = inspect.getmodule(inside("physim.analysis", "try_world"))

DOOR = """
name: door
time: {step: 0.01, duration: 60.0}
boundaries:
  - [[0, -3], [12, -3], [12, 3], [0, 3], [0, -3]]
obstacles:
  - [[6, 0.35], [6.2, 0.35], [6.2, 3], [6, 3]]
  - [[6, -3], [6.2, -3], [6.2, -0.35], [6, -0.35]]
robots:
  - {name: a, footprint: {length: 1.7, width: 0.6}, pose: [2, 0, 0], path: [[1.5, 0], [10.5, 0]]}
reference_path: [[1.5, 0], [10.5, 0]]
"""
LANE = """
name: lane
time: {step: 0.01, duration: 30.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 1.9}
robots:
  - {name: east, footprint: {length: 1.8, width: 1.0}, pose: [3, 0, 0], path: [[0, 0], [30, 0]]}
  - {name: west, footprint: {length: 1.8, width: 1.0}, pose: [27, 0, 3.1416],
     path: [[30, 0], [0, 0]]}
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "door.yaml").write_text(DOOR)
    (tmp_path / "lane.yaml").write_text(LANE)
    return tmp_path


def test_a_robot_that_stands_at_a_door_is_told(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    done = physim("check", "door.yaml", capture=capsys)
    assert (done.code, done.err) == (0, "")
    told = next(line for line in done.out.splitlines() if "robots[0].path" in line)
    assert re.search(r'door\.yaml:10:\d+: .*"a" stands \d\.\d+ m short .*"obstacle 1"', told)
    assert "1 warning" in done.out.splitlines()[-1]
    left_out = physim("check", "door.yaml", "--no-run", capture=capsys)
    assert "no warnings" in left_out.out.splitlines()[-1]


def test_two_that_meet_head_on_are_told_under_any_controller(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Path following looks at nobody: the two touch, and push each other for ever."""
    done = physim("check", "lane.yaml", "--controller", "path_following", "--json", capture=capsys)
    assert done.code == 0
    (world,) = json.loads(done.out)["worlds"]
    assert "2 of 2 robots do not arrive" in world["trial"]
    first, *others = world["warnings"]
    assert (first["key"], first["line"]) == ("robots[0].path", 6)
    touch = re.search(
        r'^"east" touches "west" at \(([\d.]+), (\S+)\) after ([\d.]+) s$', first["message"]
    )
    assert touch is not None
    x, y, time = map(float, touch.groups())
    assert (x, y) == pytest.approx((15.0, 0.0), abs=1.0)
    assert 10.0 < time < 13.0
    short = [re.search(r'^"(\w+)" .* short of its stop', one["message"])[1] for one in others]
    assert sorted(short) == ["east", "west"]


def test_what_the_world_expects_is_not_told(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ("--set", "expect={finished: false}")
    assert "no warnings" in physim("check", "door.yaml", *given, capture=capsys).out


SIZE = "footprint: {length: 1.2, width: 0.7}"
FOLLOWING = f"""
name: following
time: {{step: 0.02, duration: 24.0}}
corridor: {{centreline: [[0, 0], [40, 0]], width: 7.0}}
robots:
  - {{name: front, {SIZE}, pose: [30, 0, 3.1416], path: [[38, 0], [2, 0]], limits: {{v: 0.4}}}}
  - {{name: rear, {SIZE}, pose: [34, 0, 3.1416], path: [[38, 0], [6, 0]]}}
"""
JUNCTION = f"""
name: junction
time: {{step: 0.02, duration: 60.0}}
boundaries:
  - [[-15, -3], [25, -3], [25, 3], [3, 3], [3, 20], [-3, 20], [-3, 3], [-15, 3], [-15, -3]]
reference_path: [[-12, 0], [22, 0]]
robots:
  - {{name: a, {SIZE}, pose: [-2, 0, 0], path: [[-12, 0], [5, 0]]}}
  - {{name: b, {SIZE}, pose: [0, 8, -1.5708], path: [[0, 17], [0, 0], [20, 0]]}}
"""
SAME_STOP = """
name: two
time: {step: 0.01, duration: 30.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}
robots:
  - {name: a, footprint: &box {length: 1.8, width: 1.0}, pose: [6.0, 1.5, 0.0], path: {offset: 1.5}}
  - {name: b, footprint: *box, pose: [3.0, -1.0, 0.0], path: {offset: 1.5}}
"""
WALL = """
name: alone
time: {step: 0.01, duration: 20.0}
boundaries: [[[-2, -2], [12.7, -2], [12.7, 2], [-2, 2], [-2, -2]]]
reference_path: [[0, 0], [12, 0]]
robots:
  - {name: r1, footprint: {length: 0.8, width: 0.5}, pose: [2, 0, 0], path: {offset: 0}}
"""


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (FOLLOWING, r'"front" touches "rear" at'),
        (JUNCTION, r'"b" (stands|still moves).* short '),
        (SAME_STOP, r'"b" stops where "a" does, at \(20, 1.5\)'),
        (SAME_STOP.replace("*box", "{length: 0.4, width: 0.3}"), r'"b" stops where "a" does'),
        (SAME_STOP, r'"b" (stands|still moves).* short .* waits for "a"'),
        (SAME_STOP.replace("30.0}", "8.0}"), r"time.duration ends too early, it needs about \d+ s"),
        (WALL, r'"r1" stands .* short .* nearest is "boundary 1"'),
        (LANE, r'"(east|west)" (stands|touches) '),
    ],
    ids=[
        "runs into another",
        "in the way",
        "stops in one place",
        "stops within another",
        "who is there",
        "too short",
        "a wall ahead",
        "head on",
    ],
)
def test_what_keeps_robots_from_their_stops_is_told(
    here: Path, capsys: pytest.CaptureFixture[str], text: str, told: str
) -> None:
    (here / "w.yaml").write_text(text)
    out = physim("check", "w.yaml", capture=capsys).out
    assert re.search(told, out), out


def test_a_run_that_would_take_long_is_not_made(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(TRIAL, "MOST_STEPS", 100)
    done = physim("check", "door.yaml", capture=capsys)
    assert re.search(r"^not tried: 6,000 steps of 1 robot", done.out, re.MULTILINE)
    assert "no warnings" in done.out.splitlines()[-1]


def test_a_trial_cut_by_the_clock_does_not_say_who_fails_to_arrive(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(TRIAL, "MOST_SECONDS", 0.0)
    done = physim("check", "door.yaml", capture=capsys)
    assert re.search(
        r"^tried for 0\.\d s of 60 s.*: 1 of 1 robot under way", done.out, re.MULTILINE
    )
    assert "no warnings" in done.out.splitlines()[-1]


def test_a_controller_that_fails_in_the_run_is_told(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (here / "late.py").write_text(
        "class Late:\n    def decide(self, seen, memory):\n        raise RuntimeError('too late')\n"
    )
    monkeypatch.syspath_prepend(str(here))
    done = physim("check", "door.yaml", "--controller", "late:Late", capture=capsys)
    assert done.code == 2
    assert re.search(r"controller: .*too late", done.out)
    assert "1 error, no warnings" in done.out.splitlines()[-1]


BEHIND = DOOR.replace("pose: [2, 0, 0], path: [[1.5, 0]", "pose: [2, 0, 0], path: [[7.5, 0]")


@pytest.mark.parametrize(
    ("text", "given", "told"),
    [
        (DOOR, "seed=0", r"0\.05 m beside it, .* 0\.15 m .*controller\.boundary_low"),
        (DOOR, "controller.boundary_low=0.04", "all robots arrive"),
        (
            BEHIND,
            "seed=0",
            r"5\.49 m short of its stop station [^:]*: it is 2\.5 m before its path",
        ),
    ],
    ids=["kept off by a setting", "let through", "before its path"],
)
def test_what_is_said_of_a_robot_that_stands_is_true(
    here: Path, capsys: pytest.CaptureFixture[str], text: str, given: str, told: str
) -> None:
    (here / "w.yaml").write_text(text)
    out = physim("check", "w.yaml", "--set", given, capture=capsys).out
    assert re.search(told, out), out
