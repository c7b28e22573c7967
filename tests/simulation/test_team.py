"""Controllers of single robots and groups, beside the world's: run, recorded, judged, told."""

from __future__ import annotations

import json
import pickle
import re
from typing import Any

import numpy as np
import pytest

import physim
from physim import Decision, Decisions, Mode, Observation, Rule, Simulation, View, World, simulate
from physim.errors import ControllerError, WorldError
from physim.record import Record
from physim.world.file import load_world, parse_world
from tests.helpers import check_error, facts, inside

validate = inside("physim.analysis.validation", "validate")
robots_in_contact = inside("physim.analysis.validation", "robots_in_contact")
summarise = inside("physim.analysis", "summarise")
own_parts = inside("physim.campaigns", "own_parts")
Space = inside("physim.campaigns.falsify", "Space")

APART = """
name: mixed
time: {{step: 0.02, duration: 8}}
corridor: {{centreline: [[0, 0], [60, 0]], width: 40}}
controller: {{{own}}}
robots:
  - {{name: a, footprint: {{length: 1, width: 1}}, pose: [6, 0, 0.3], path: [[2, 0], [12, 0]]{a}}}
  - {{name: b, footprint: {{length: 1, width: 1}}, pose: [6, 12, 0], path: [[2, 12], [58, 12]]{b}}}
  - {{count: 2, name: "g{{number}}", footprint: {{length: 1, width: 1}},
      path: [[2, -13], [30, -13]],
      start: {{region: [[3, -16], [14, -16], [14, -10], [3, -10]], heading: along}}{g}}}
"""
"""Robots a, b and a group farther apart than they sense"""
CONSTANT = ", controller: {type: constant, v: 0.3, omega: 0.05}"
DEAF = ", controller: {type: path_following, speed: 0.6}"


def apart(own: str = "", a: str = "", b: str = "", g: str = "") -> World:
    return parse_world(APART.format(own=own, a=a, b=b, g=g))


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("mixed") / "record.h5"
    simulate(apart(b=CONSTANT, g=DEAF), path=path).close()
    with Record.load(path) as record:
        yield record


def test_each_robot_does_what_its_controller_alone_makes_it_do(mixed: Record) -> None:
    alone = {
        "type: mode_switching": (0,),
        "type: constant, v: 0.3, omega: 0.05": (1,),
        "type: path_following, speed: 0.6": (2, 3),
    }
    for own, robots in alone.items():
        with simulate(apart(own)) as record:
            until = min(len(record.pose), len(mixed.pose))  # one may end where all have arrived
            for i in robots:
                assert np.array_equal(record.pose[:until, i], mixed.pose[:until, i])


def test_equal_members_decide_as_one_controller_does() -> None:
    # written otherwise they are two members; that robots of both meet shows in what they consider
    world = load_world("three_robots", overrides=["time.duration=6"])
    own = list(world.robots)
    beta = inside("physim.controllers", "ModeSwitchingSettings")().beta
    chosen = {"type": "mode_switching", **world.controller.settings, "beta": beta}
    own[1] = type(own[1])(**{**dict(own[1]), "controller": chosen})
    team = world.changed(robots=own)
    assert len(team.drivers()) == 2
    with simulate(world) as one, simulate(team) as other:
        assert np.array_equal(one.pose, other.pose)
        assert np.array_equal(one.updates, other.updates)
        assert np.array_equal(one.considered, other.considered)
        assert one.declared == other.declared


class Slow:
    """A plain controller of a user's, with a rule that the paper's has in another sense."""

    modes = (Mode("creeping", "#000000"),)
    rules = (Rule("stop", "never stops"),)

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return Decision(0.1, 0.0, 0.1, mode="creeping", rule="stop", memory=(memory or 0) + 1)


def test_one_from_python_takes_the_place_of_the_worlds_alone() -> None:
    world = apart(b=CONSTANT, g=", controller: {type: mode_switching}")
    with simulate(world, controller=Slow()) as record:
        drivers = [(part.name.rpartition(":")[2], who) for part, who in record.setup.controllers]
        assert drivers == [("Slow", (0,)), ("constant", (1,)), ("mode_switching", (2, 3))]
        assert record.pose[-1, 0, 0] == pytest.approx(6.0 + 0.8 * np.cos(0.3), abs=1e-9)
        rules = [rule.name for rule in record.declared.rules]
        assert rules[0] == "stop"
        assert "stop_3" in rules  # each keeps its words
        rows = record.updates
        assert {rules[k] for k in rows["rule"][rows["robot"] == 0]} == {"stop"}
        assert {rules[k] for k in rows["rule"][rows["robot"] > 1]} <= {"path_following_3", *rules}
        assert np.isnan(rows["target_x"][rows["robot"] == 0]).all()
    simulation = Simulation(world, controller=Slow())
    for _ in range(40):
        simulation.step()
    kept = pickle.loads(pickle.dumps(simulation))
    for one in (simulation, kept):
        for _ in range(40):
            one.step()
    assert np.array_equal(simulation.pose, kept.pose)
    assert kept.state.memory["0/memory"].tolist()[0] == 16


def test_a_name_in_two_senses_is_refused() -> None:
    class Clashing(Slow):
        modes = (Mode("safe", "#123456"),)

    with pytest.raises(ControllerError) as caught:
        Simulation(apart(b=DEAF), controller=Clashing())
    assert re.search(facts("mode", '"safe"', "path_following", "another name"), str(caught.value))


def test_errors_name_the_controller_that_made_them() -> None:
    class Fast(Slow):
        def decide(self, observation: Observation, memory: Any) -> Decision:
            return Decision(9.0, 0.0, 0.1)

    with pytest.raises(ControllerError, match=r"Fast, a at 0 s: command v = 9"):
        simulate(apart(b=CONSTANT), controller=Fast())


class Together:
    """One of a user's for all its robots at once; ``first`` is what it begins with."""

    def __init__(self, first: Any) -> None:
        self.first = first

    def start(self, scene: Any) -> Any:
        return self.first

    def decide_all(self, view: View, due: Any, memory: Any) -> Decisions:
        command = np.zeros((len(due), 2))
        command[:, 0] = memory["v"][due] = memory["v"][due] + 0.01
        return Decisions.of(due, command, 0.1)


@pytest.mark.parametrize("own", [{}, {"b": CONSTANT}], ids=["alone", "in a team"])
def test_one_for_all_begins_with_named_arrays_of_rows(own: dict[str, str]) -> None:
    world = apart(**own)
    simulation = Simulation(world, controller=Together({"v": np.full(4, 0.1)}))
    for _ in range(11):
        simulation.step()
    assert simulation.command[0, 0] == pytest.approx(0.13)
    for first in ([0.1] * 4, {"v": np.zeros(3)}, {"v": 0.1}):
        with pytest.raises(ControllerError, match=r"Together, start: .*4 robots.*\.py:\d+\)$"):
            Simulation(world, controller=Together(first))
    with pytest.raises(ControllerError, match=r"Together at 0 s: KeyError: 'v' \(.*\.py:\d+\)$"):
        simulate(world, controller=Together(None))


@pytest.mark.parametrize(
    ("own", "place", "said"),
    [
        ("{type: constant, w: 0.3}", "robots[1].controller.w", ("unknown key", "omega")),
        ("{type: constant, v: 2.5}", "robots[1].controller.v", ("beyond", '"b"')),
        ("{type: mode_switching, look_ahed: 2}", "robots[1].controller.look_ahed",
         ("look_ahead",)),
        ("{type: mode_switching, omegas: [0, 9]}", "robots[1].controller.omegas[1]", ('"b"',)),
        ("{type: constnat}", "robots[1].controller.type", ("constant",)),
        ("{type: 'my:Class'}", "robots[1].controller.type", ("registered",)),
        ("{v: 0.3}", "robots[1].controller.type", ("missing",)),
    ],
)  # fmt: skip
def test_settings_are_checked_at_their_place(own: str, place: str, said: tuple[str, ...]) -> None:
    with pytest.raises(WorldError) as caught:
        apart(b=f", controller: {own}")
    told = str(caught.value)
    check_error(f"{told[told.index('robots') :]}\n", place, *said)
    assert "--controller" not in str(caught.value)


def test_controllers_are_asked_about_their_own_robots() -> None:
    # 1.6 rad/s of a is too slow for the paper's turns of 2; b alone is driven by it
    slow = "type: mode_switching, omegas: [0, 1.7]"
    limits = ", limits: {omega: 1.8}"
    with pytest.raises(WorldError):
        apart(b=f"{limits}, controller: {{{slow}}}", own=slow)
    apart(b=f"{limits}, controller: {{{slow}}}")
    with pytest.raises(WorldError) as caught:  # of a group, at its entry
        apart(g=f", controller: {{{slow}}}")
    assert "robots[2].controller.omegas[1]" in str(caught.value)


def test_a_controller_that_would_drive_nobody_is_refused(tmp_path: Any) -> None:
    world = apart(a=CONSTANT, b=CONSTANT, g=CONSTANT)
    with simulate(world) as record:
        assert [part.name for part, _ in record.setup.controllers] == ["constant"]
        assert [robots for _, robots in record.setup.controllers] == [(0, 1, 2, 3)]
    with pytest.raises(ControllerError, match="would drive no robot"):
        simulate(world, controller=Slow())
    with pytest.raises(WorldError, match="would drive no robot"):
        parse_world(world.to_yaml(), controller="path_following")
    kept = parse_world(apart(b=CONSTANT).to_yaml(), controller="path_following")
    assert [one.type for one in kept.drivers()] == ["path_following", "constant"]


def test_a_world_is_written_and_read_again_with_them() -> None:
    world = apart(b=CONSTANT, g=DEAF)
    assert parse_world(world.to_yaml()) == world


def test_a_record_tells_who_drives_whom(mixed: Record) -> None:
    told = [(str(part), robots) for part, robots in mixed.setup.controllers]
    assert told == [
        ("mode_switching", (0,)),
        ("constant (omega 0.05, v 0.3)", (1,)),
        ("path_following (speed 0.6)", (2, 3)),
    ]
    summary = summarise(mixed)
    tree = json.loads(summary.to_json())
    assert [one["robots"] for one in tree["by_controller"]] == [["a"], ["b"], ["g3", "g4"]]
    assert [one["arrived"] for one in tree["by_controller"]] == [1, 0, 0]
    assert [one["contacts"] for one in tree["by_controller"]] == [0, 0, 0]
    text = inside("physim.analysis", "table")(summary)
    words = "by controller", "mode_switching", "1 of 1 arrived", "contacts 0", "a"
    assert re.search(facts(*words), text)
    with simulate(load_world("straight", overrides=["time.duration=0.2"])) as one:
        assert "by_controller" not in summarise(one).to_json()


def test_a_validation_makes_the_run_again_and_its_decisions(mixed: Record) -> None:
    found = validate(mixed)
    assert found.verdict == "contact-free"
    assert found.rerun.same_digest
    other = validate(mixed, rerun=False)
    assert other.verdict == "contact-free"
    assert other.recomputed.replayed == len(mixed.updates)


def test_pictures_tell_controllers_and_modes_apart(mixed: Record) -> None:
    timeline = inside("physim.drawing", "Timeline")(mixed)
    told = inside("physim.drawing.page", "explanations")(mixed)
    assert timeline.partly_modeless  # b
    assert told["controller"] == "mode_switching, constant and path_following"
    assert [one["robots"] for one in told["drivers"]] == [(0,), (1,), (2, 3)]
    assert [bool(one["thresholds"]) for one in told["drivers"]] == [True, False, False]
    prose = {one["name"]: one["prose"] for one in told["rules"]}
    assert "ignores robots" in prose["path_following_3"]
    assert "ignores robots" not in prose["path_following"]
    assert timeline.marks == ["·A", "·B", "·C", "·C"]
    assert [one.words for one in timeline.drivers] == [
        "A mode_switching: a",
        "B constant: b",
        "C path_following: g3, g4",
    ]
    given = [[mixed.modes[k].name for k in one.modes] for one in timeline.drivers]
    paper = [mode.name for mode in physim.PAPER_MODES]
    assert given == [paper, [], ["safe", "arrived"]]
    ground, signs = inside("physim.drawing.video", "ground", "signs")
    assert {"safe area of A", "danger area of A"} <= set(signs(timeline, ground(timeline)))
    (axis,) = (figure := inside("physim.drawing.plots", "modes")(mixed)).axes
    assert [one.get_text() for one in axis.get_yticklabels()] == ["a·A", "b·B", "g3·C", "g4·C"]
    assert [one.xy[1] for one in axis.texts if one.get_gid() == "share"] == [0]
    assert re.search(facts("out of danger", "A 100 %"), axis.get_title("right"))
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    first, *_, last = (legend.index(one.words) for one in timeline.drivers)
    assert "safe" in legend[first:last]
    assert "safe" in legend[last:]
    text = inside("physim.analysis.validation", "report")(validate(mixed, rerun=False), False)
    assert re.search(facts("path_following (speed 0.6) for g3, g4"), " ".join(text.split()))


ACROSS = """
name: across
time: {{step: 0.02, duration: 14}}
corridor: {{centreline: [[0, 0], [40, 0]], width: 8}}
robots:
  - {{name: slow, footprint: {{length: 1, width: 1}}, pose: [9, 0, 0], path: {{offset: 0}}{slow}}}
  - {{name: fast, footprint: {{length: 1, width: 1}}, pose: [4, 0, 0], path: {{offset: 0}}{fast}}}
"""


@pytest.mark.parametrize(
    ("slow", "fast", "responsible"),
    [
        ("{type: constant, v: 0.2}", "{type: mode_switching, avoidance: none}", "fast"),
        ("{type: mode_switching, speed: 0.2}", "{type: constant, v: 1.0}", ""),
    ],
)
def test_only_the_papers_robots_have_to_give_way(slow: str, fast: str, responsible: str) -> None:
    text = ACROSS.format(slow=f", controller: {slow}", fast=f", controller: {fast}")
    with simulate(parse_world(text)) as record:
        found = validate(record)
        first = found.contacts[0]
        assert "".join(record.names[i] for i in first.responsible) == responsible
    with simulate(parse_world(text, overrides=["time.duration=3"])) as record:
        near = validate(record).near_misses.times[0]
        assert (near.behind is None) == (not responsible)


def test_campaigns_and_searches_know_all_controllers(monkeypatch: Any) -> None:
    monkeypatch.setattr("physim.campaigns.sources.shipped_parts", lambda kind: ["mode_switching"])
    names = [name for _, name in own_parts(apart(b=CONSTANT, g=DEAF))]
    assert names == ["constant", "path_following"]
    world = apart(b=CONSTANT)
    least = {(one.robot, one.key): one.low for one in Space(world, ["speed"]).dimensions}
    assert least[1, "omega"] == 0.8  # a constant does not mind; the paper's turns are faster
    assert least.get((0, "omega"), 1.6) > 0.8


def test_the_check_of_a_controller_lets_it_drive_all() -> None:
    said: list[object] = []
    found = physim.testing.check_controller(
        "constant", worlds=[apart(b=DEAF)], seconds=0.2, report=said.append
    )
    assert not found
    assert not said
