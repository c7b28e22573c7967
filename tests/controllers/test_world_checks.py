"""What the paper's controller says of worlds: its speed, how far it sees, where it stops."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim import Simulation
from physim.errors import WorldError
from physim.world.checks import Findings, check_world
from physim.world.file import parse_world
from tests.helpers import inside

CONTROLLER, make_part = inside("physim.parts", "CONTROLLER", "make_part")

ALONE = """\
name: alone
time: {step: 0.01, duration: 2.0}
corridor: {centreline: [[0, 0], [40, 0]], width: 8.0}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [2, 0, 0], path: {offset: 1.5}}
  - {name: b, footprint: {length: 1.8, width: 1.0}, pose: [6, 0, 0], path: {offset: -1.5}}
"""
CORNER = 1.0295630  # [m] of either robot, from its reference point
TOGETHER = ALONE + "formation: {}\n"


def checked(tmp_path, text: str, *overrides: str, controller: str | None = None) -> Findings:
    (tmp_path / "w.yaml").write_text(text)
    return check_world(tmp_path / "w.yaml", overrides=overrides, controller=controller)


def said(findings: Findings) -> dict[str, str]:
    return {finding.key: finding.message for finding in findings.warnings}


# Speed


@pytest.mark.parametrize("name", ["mode_switching", "path_following"])
@pytest.mark.parametrize(("speed", "driven"), [(None, 1.0), (0.4, 0.4), (9.0, 1.5)])
def test_robots_go_at_the_speed_that_is_set_where_there_is_no_formation(name, speed, driven):
    """At most at their limits, 1.5 m/s."""
    settings = {} if speed is None else {"speed": speed}
    world = parse_world(ALONE).changed(controller={"type": name, **settings})
    simulation = Simulation(world, controller=make_part(CONTROLLER, name, settings))
    for _ in range(20):
        simulation.step()
    assert simulation.command[:, 0] == pytest.approx([driven, driven])


def test_a_formation_has_a_speed_of_its_own():
    world = parse_world(TOGETHER + "controller: {type: mode_switching}\n")
    again = world.changed(formation={"speed": 1.2, "gain": 0.0})
    for one, driven in ((world, 1.0), (again, 1.2)):
        simulation = Simulation(one)
        simulation.step()
        assert simulation.command[:, 0] == pytest.approx([driven, driven])


@pytest.mark.parametrize("name", ["mode_switching", "path_following"])
def test_a_speed_beside_a_formation_is_one_fault(name):
    text = f"{TOGETHER}controller: {{type: {name}, speed: 0.5}}\n"
    with pytest.raises(WorldError) as caught:
        parse_world(text, "w")
    place = f"w:8:{text.splitlines()[-1].index('0.5') + 1}"
    assert str(caught.value).startswith(f"{place}: controller.speed: ")
    assert "formation.speed" in str(caught.value)
    assert len(caught.value.faults) == 1
    world = parse_world(TOGETHER).changed(controller={"type": name, "speed": 0.5})
    with pytest.raises(WorldError, match=r"controller\.speed: .*formation\.speed"):
        Simulation(world)


@pytest.mark.parametrize("controller", ["mode_switching", "path_following"])
def test_a_speed_that_no_robot_reaches_is_doubted(tmp_path, controller):
    """It is the limits that hold: 1.5 m/s, and 0.5 m/s where nobody wrote a speed."""
    reached = ("controller.speed=1.5",), ("robots.0.limits.v=2.0", "controller.speed=1.9")
    slow = ("robots.0.limits.v=0.5", "robots.1.limits.v=0.5")
    for overrides in (*reached, slow):
        found = checked(tmp_path, ALONE, *overrides, controller=controller)
        assert "controller.speed" not in said(found)
    beyond = checked(tmp_path, ALONE, "controller.speed=1.6", controller=controller)
    assert beyond.ok
    assert {"1.6", "1.5"} <= set(said(beyond)["controller.speed"].split())
    fast = "formation={speed: 1.6, limits: [0.8, 2.0], range: 20.0}"
    together = checked(tmp_path, ALONE, fast, controller=controller)
    assert "limits.v" in said(together)["formation.speed"]
    slow = "formation={speed: 0.5, limits: [0.8, 2.0], range: 20.0}"
    told = said(checked(tmp_path, ALONE, slow, controller=controller))
    if controller == "path_following":  # it does not drive by (7)
        assert "formation.speed" not in told
    else:
        assert {"outside", "0.8"} <= set(told["formation.speed"].split())


def test_a_corridor_without_a_safe_area_is_doubted(tmp_path):
    for width, is_told in ((1.9, True), (2.1, False)):
        narrow = (f"corridor.width={width}", "robots.0.path.offset=0", "robots.1.path.offset=0")
        told = said(checked(tmp_path, ALONE, *narrow))
        assert ("controller.safe_distance" in told) == is_told
        if is_told:
            assert "0.95 m" in told["controller.safe_distance"]
        other = said(checked(tmp_path, ALONE, *narrow, controller="path_following"))
        assert "controller.safe_distance" not in other


# Arrival


def test_stops_short_of_arrival_are_doubted_and_can_happen(tmp_path):
    for text in (ALONE, TOGETHER):
        for controller in (None, "path_following"):
            usual = checked(tmp_path, text, controller=controller)
            equal = checked(tmp_path, text, "arrival.tolerance=0.06", controller=controller)
            assert said(usual) == said(equal) == {}
            tight = checked(tmp_path, text, "arrival.tolerance=0.059", controller=controller)
            assert tight.ok
            assert "0.059" in said(tight)["arrival.tolerance"]
    wide = said(checked(tmp_path, ALONE, "controller.arrival_tolerance=0.2"))
    assert list(wide) == ["controller.arrival_tolerance"]
    run = ("time.duration=45.0", "controller.arrival_tolerance=0.2", "formation=null")
    for overrides, ended in ((run, "duration"), ((*run, "arrival.tolerance=0.2"), "finished")):
        record = physim.simulate(parse_world(ALONE, overrides=overrides))
        assert record.ended == ended
        still = np.ptp(record.pose[-50:], axis=0).max()
        assert still == 0.0


# Range


@pytest.mark.parametrize(
    ("overrides", "needed", "why"),
    [
        # 1.3 m/s at most in formation
        ((), 2 * CORNER + 2 * 1.3 * 1.0, "controller.time_low"),
        (("controller.time_low=0.1",), 3.0, "controller.safe_distance"),
        (
            ("controller.time_low=0.1", "controller.safe_distance=0.4"),
            2 * CORNER + 0.5,
            "distance_low",
        ),
        (("formation=null", "controller.speed=3.0"), 2 * CORNER + 2 * 1.5, "time_low"),
        (("formation=null", "robots.1.limits.v=0.2"), 2 * CORNER + 1.2, "time_low"),
    ],
)
def test_a_range_is_doubted_where_thresholds_cannot_be_kept(tmp_path, overrides, needed, why):
    enough = checked(tmp_path, TOGETHER, *overrides, f"sensing.range={needed + 0.001}")
    assert "sensing.range" not in said(enough)
    short = checked(tmp_path, TOGETHER, *overrides, f"sensing.range={needed - 0.001}")
    assert short.ok
    assert why in said(short)["sensing.range"]


# Intervals


@pytest.mark.parametrize(("held", "finished"), [(1.0, True), (1.5, False)])
def test_commands_held_for_long_are_doubted_and_lose_the_path(held, finished):
    """A robot alone, at 1 m/s with a look-ahead of 2 m, circles instead of arriving."""
    given = f"controller.longest_interval={held}"
    warned = said(check_world("single_robot", overrides=[given]))
    assert ("controller.longest_interval" in warned) != finished
    world = physim.load_world("single_robot").changed(controller={"longest_interval": held})
    assert (physim.simulate(world).ended == "finished") == finished
