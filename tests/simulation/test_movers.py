"""Movers and obstacles that can be pushed: where they are, what they push, who sees them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from physim import (
    Decision,
    Observation,
    Record,
    Simulation,
    SimulationState,
    World,
    check_world,
    simulate,
)
from physim.geometry import collision_time
from tests.helpers import Says, facts, inside

deep_contacts = inside("physim.analysis", "deep_contacts")

SQUARE = {"length": 1.0, "width": 1.0}
BOX_CORNERS = [[7.0, 4.5], [8.0, 4.5], [8.0, 5.5], [7.0, 5.5]]


class Goes:
    """Goes straight on at a speed [m/s]."""

    def __init__(self, speed: float) -> None:
        self.speed = speed

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return Decision(self.speed, 0.0, hold=100.0)


STAND = Goes(0.0)


def room(movers: list[Any], start: float = 5.0, **more: Any) -> World:
    """A room of 20 m by 10 m with one robot in its middle that looks along the x axis."""
    robot = {
        "name": "r", "footprint": {"length": 1.0, "width": 0.6}, "pose": [start, 5.0, 0.0],
        "path": [[2.0, 5.0], [18.0, 5.0]],
    }  # fmt: skip
    return World(
        **{
            "name": "room",
            "time": {"step": 0.01, "duration": 6.0},
            "boundaries": [[[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]],
            "reference_path": [[2.0, 5.0], [18.0, 5.0]],
            "robots": [robot],
            "movers": [
                {"name": f"m{k}", "footprint": SQUARE, **one} for k, one in enumerate(movers)
            ],
            **more,
        }
    )


def stepped(simulation: Simulation, steps: int) -> Simulation:
    """The simulation so many steps on."""
    for _ in range(steps):
        simulation.step()
    return simulation


def between(a: Any, b: Any, share: float) -> NDArray[np.float64]:
    """Pose a share of the way from a to b: turned about the fixed point of the motion."""
    (p, q), turn = (complex(one[0], one[1]) for one in (a, b)), b[2] - a[2]
    if turn == 0.0:
        place = p + share * (q - p)
    else:
        centre = (q - p * np.exp(1j * turn)) / (1.0 - np.exp(1j * turn))
        place = centre + (p - centre) * np.exp(1j * share * turn)
    return np.array([place.real, place.imag, a[2] + share * turn])


WAYPOINTS = [[4.0, 5.0, 0.3], [7.0, 7.0, 1.5], [7.0, 7.0, -0.2], [12.0, 4.0, -0.2], [4.0, 5.0, 0.3]]
TIMES = [0.5, 1.75, 2.25, 2.25 + 2.0**-3, 3.5]


@pytest.mark.parametrize("repeat", ["once", "loop", "to_and_fro"])
def test_a_mover_is_exactly_where_it_should_be_at_every_step(repeat: str) -> None:
    """Against poses turned about fixed centres, worked out with complex numbers."""
    path = {"waypoints": WAYPOINTS, "times": TIMES, "repeat": repeat}
    simulation = Simulation(room([path], 1.0, time={"step": 0.002, "duration": 9.0}))
    length = TIMES[-1] - TIMES[0]
    for _ in range(0, 4400, 11):
        time = max(0.0, simulation.time - TIMES[0])
        rounds, time = divmod(time, length) if repeat != "once" else (0.0, min(time, length))
        if repeat == "to_and_fro" and rounds % 2:
            time = length - time
        k = min(int(np.searchsorted(TIMES, time + TIMES[0], side="right")) - 1, len(TIMES) - 2)
        share = (time + TIMES[0] - TIMES[k]) / (TIMES[k + 1] - TIMES[k])
        expected = between(WAYPOINTS[k], WAYPOINTS[k + 1], share)
        assert simulation.now.moving_pose[1] == pytest.approx(expected, abs=1e-9)
        simulation.step(np.zeros((1, 2)), steps=11)


@pytest.mark.parametrize(
    ("mover", "twist"),
    [
        ({"waypoints": [[10, 9.4], [10, 0.6]], "speed": 1.5}, (0.0, 0.0, -1.5)),
        ({"waypoints": [[11, 8, 0], [11, 8, 1.5]], "times": [0, 4],
          "footprint": [[0, -0.1], [-4, -0.1], [-4, 0.1], [0, 0.1]]}, (0.0, 0.375, 0.0)),
    ],
)  # fmt: skip
def test_it_is_first_touched_at_the_collision_time(mover: dict[str, Any], twist: Any) -> None:
    simulation = Simulation(room([mover]), controller=Goes(1.5))
    robot = [[-0.5, -0.3], [0.5, -0.3], [0.5, 0.3], [-0.5, 0.3]]
    corners = mover.get("footprint", [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    due = collision_time(
        robot, simulation.pose[0], (1.5, 0.0, 0.0), corners,
        simulation.now.moving_pose[1], twist, 10.0, frame="body",
    )  # fmt: skip
    while not len(simulation.contacts):
        simulation.step()
    assert simulation.step_number == int(due / 0.01) + 1
    assert simulation.contacts[["a", "b"]].tolist() == [(0, 1)]


def test_a_robot_is_pushed_at_the_speed_of_the_mover() -> None:
    mover = {"waypoints": [[2.0, 5.0], [12.0, 5.0]], "speed": 1.0}
    simulation = stepped(Simulation(room([mover]), controller=STAND), 500)
    assert simulation.now.moving_pose[1].tolist() == [7.0, 5.0, 0.0], "nothing holds it back"
    assert simulation.velocity[0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert simulation.pose[0] == pytest.approx([8.0, 5.0, 0.0], abs=2e-3)


def test_an_obstacle_is_pushed_and_stays_where_it_is_left() -> None:
    go = Says(lambda o: Decision(1.0 if o.time < 3.0 else 0.0, 0.0, hold=3.0))
    pushed = [{"corners": BOX_CORNERS, "mass": 30.0}]
    simulation = stepped(Simulation(room([], obstacles=pushed), controller=go), 300)
    left = simulation.now.moving_pose[1].copy()
    assert left[0] > 8.0
    assert simulation.now.moving_velocity[1, 0] == pytest.approx(1.0 * 60 / 90, rel=1e-3)
    stepped(simulation, 100)
    assert simulation.now.moving_pose[1] == pytest.approx(left, abs=0.01)
    assert not simulation.now.moving_velocity[1].any()


def test_a_robot_crushed_against_a_wall_ends_nothing_and_the_depth_is_told() -> None:
    mover = {"waypoints": [[14.0, 5.0], [19.4, 5.0]], "speed": 1.0}
    with simulate(room([mover], 17.0), controller=STAND) as record:
        assert record.moving_pose[-1, 1].tolist() == [19.4, 5.0, 0.0], "nothing holds it back"
        assert record.ended == "duration"
        assert record.pose[-1, 0, 0] < 20.0
        assert record.contacts["depth"].max() > 0.1
        assert deep_contacts(record), "which every report says"


def test_movers_have_no_contacts_among_themselves_or_with_walls() -> None:
    along_wall = {"waypoints": [[3.0, 0.5], [17.0, 0.5]], "speed": 3.0}
    across = {"waypoints": [[10.0, 0.5], [10.0, 9.5]], "speed": 2.0, "repeat": "to_and_fro"}
    with simulate(room([along_wall, across], 2.0), controller=STAND) as record:
        assert not len(record.contacts)
        assert record.moving == 3
        assert record.pose.shape[1] == record.clearance.shape[1] == 1
        apart = np.abs(record.moving_pose[:, 1:, :2] - [2.0, 5.0]) - [1.0, 0.8]
        gap = np.hypot(*np.maximum(apart, 0.0).transpose(2, 0, 1)).min(axis=1, keepdims=True)
        assert record.clearance == pytest.approx(gap, abs=1e-9)


def cart(controller: str) -> Record:
    """A robot on whose way a cart goes to and fro."""
    mover = {"waypoints": [[7.0, 2.0], [7.0, 8.5]], "speed": 0.7, "repeat": "to_and_fro"}
    world = room([mover], 2.0, time={"step": 0.01, "duration": 40.0})
    return simulate(world, controller=controller)


def test_the_papers_controller_sees_a_cart_that_crosses_its_way() -> None:
    with cart("mode_switching") as record:
        assert record.ended == "finished"
        assert not len(record.contacts)
        assert 1 in record.considered["other"]
    with cart("path_following") as blind:
        assert len(blind.contacts)


@pytest.mark.parametrize("opens", [True, False])
def test_a_door_that_opens_lets_robots_pass(opens: bool) -> None:
    door = {
        "footprint": {"length": 0.2, "width": 2.4},
        "waypoints": [[9.75, 5.0], [9.75, 7.4 if opens else 5.0]],
        "times": [6.0, 9.0],
    }
    walls = [[[9.9, y], [10.1, y], [10.1, y + 4.0], [9.9, y + 4.0]] for y in (0.0, 6.0)]
    world = room([door], obstacles=walls, time={"step": 0.01, "duration": 40.0})
    with simulate(world) as record:
        assert (record.ended == "finished") == opens
        assert not len(record.contacts)


def test_a_run_goes_on_bit_for_bit_from_any_step_with_movers_in_contact() -> None:
    movers = [
        {"waypoints": [[3.5, 5, 0], [6, 7, 1.2], [3.5, 5, 0]], "times": [0, 3, 6],
         "repeat": "loop"},
        {"waypoints": [[6.5, 3, 0.2], [6.5, 3, 2.5]], "times": [0.5, 3], "repeat": "to_and_fro",
         "footprint": [[0, -0.1], [3, -0.1], [3, 0.1], [0, 0.1]]},
    ]  # fmt: skip
    world = room(
        movers, physics={"friction": 0.3, "elasticity": 0.2}, time={"step": 0.01, "duration": 15},
        obstacles=[{"corners": BOX_CORNERS, "mass": 30.0}],
    )  # fmt: skip
    go, states, poses, touching = Goes(0.6), list[SimulationState](), list[bytes](), 0
    simulation = Simulation(world, controller=go)
    for _ in range(1200):
        states.append(simulation.state)
        simulation.step()
        poses.append(simulation.now.moving_pose.tobytes())
        touching += len(simulation.contacts) > 1
    assert touching > 100
    for k in range(0, 1170, 71):
        other = Simulation(world, controller=go, state=states[k])
        for m in range(k, k + 30):
            other.step()
            assert other.now.moving_pose.tobytes() == poses[m]


def test_what_moves_is_sensed_with_its_kind() -> None:
    movers = [{"waypoints": [[9.0, 2.0], [9.0, 8.0]], "speed": 0.7}]
    pushed = [{"corners": BOX_CORNERS, "mass": 30.0}]
    simulation = stepped(Simulation(room(movers, obstacles=pushed), controller=STAND), 10)
    seen = simulation.observe(0)
    assert [(one.index, one.kind, one.v, one.station) for one in seen.others] == [
        (1, "mover", 0.0, 7.0), (2, "obstacle", 0.0, 5.5),
    ]  # fmt: skip
    assert seen.others[0].velocity == pytest.approx([0.0, 0.7, 0.0])
    assert not seen.neighbours
    assert simulation.arrays().others_mask.sum() == 2


BAD = """\
name: bad
time: {step: 0.01, duration: 5}
boundaries: [[[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]]
reference_path: [[2, 5], [18, 5]]
robots:
  - {name: r, footprint: {length: 1.0, width: 0.6}, pose: [5, 5, 0], path: {offset: 0}}
obstacles:
  - {corners: OBSTACLE, mass: MASS}
movers:
  - name: NAME
    footprint: {length: 1.0, width: 1.0}
    waypoints: WAYPOINTS
    TIMES
"""
GOOD = {"OBSTACLE": "[[7, 7], [8, 7], [8, 8]]", "MASS": "30", "NAME": "cart",
        "WAYPOINTS": "[[9, 2], [9, 8]]", "TIMES": "speed: 1.0"}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"TIMES": "times: [3, 2]"}, ("bad.yaml:13:16", "times[1]", "2.0 s", "3.0 s")),
        ({"TIMES": "times: [3]"}, ("bad.yaml:13:12", "1 times", "2 waypoints")),
        ({"TIMES": "repeat: once"}, ("bad.yaml:10:5", "movers[0].times", "speed")),
        ({"TIMES": "speed: 1.0\n    times: [0, 1]"}, ("bad.yaml:13:12", "times", "one of them")),
        ({"WAYPOINTS": "[[9, 2], [9, 2]]"}, ("bad.yaml:12:25", "speed", "times")),
        ({"WAYPOINTS": "[[9, 2], [9, 8, 1]]"}, ("bad.yaml:12:17", "[x, y, heading]")),
        ({"WAYPOINTS": "[[9, 2, 0], [9, 8, 4]]"}, ("bad.yaml:12:28", "4 rad", "in between")),
        ({"TIMES": "speed: 1.0\n    repeat: loop"}, ("bad.yaml:12:25", "[9, 2]", "loop")),
        ({"WAYPOINTS": "[[9, 2], [9, 9.7]]"}, ("bad.yaml:12:25", '"cart"', "7.5 s", "0.2 m")),
        ({"WAYPOINTS": "[[5.5, 5], [9, 8]]"}, ("bad.yaml:12:16", '"cart"', '"r"', "overlaps")),
        ({"TIMES": "speed: 30"}, ("bad.yaml:12:25", "0.3 m", "0.25 m", "0.0083 s")),
        ({"NAME": "r"}, ("bad.yaml:10:11", "robots[0]", "differ")),
        ({"OBSTACLE": "[[4, 4], [5, 4], [5, 5]]"}, ("bad.yaml:8:15", "obstacle 1", '"r"')),
        ({"MASS": "0"}, ("bad.yaml:8:", "obstacles[0].mass", "greater than 0")),
    ],
)  # fmt: skip
def test_bad_movers_are_refused_where_they_are_written(
    tmp_path: Path, changes: dict[str, str], said: tuple[str, ...]
) -> None:
    text = BAD
    for key, value in (GOOD | changes).items():
        text = text.replace(key, value)
    file = tmp_path / "bad.yaml"
    file.write_text(text)
    told = [str(one) for one in check_world(file).errors]
    assert len(told) == 1
    assert re.match(facts(*said), told[0]), told
