"""Stages and observers from outside, found by entry point: what they may do, and what they may not.

The parts are the examples of docs/EXTENDING.md, installed for these tests alone.
"""

from __future__ import annotations

import copy
import importlib
import pickle
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim.control import Batched, Decision, Sensed
from physim.errors import ControllerError
from physim.record import Record
from physim.recording import record_run, simulate
from physim.registry import CONTROLLER, make_part
from physim.simulation import Simulation
from physim.stages import for_each, observer_of_row, with_poses
from physim.world import World
from physim.world_file import load_world
from tests.extending import entry_points, install

HAZE = "sensing.stages=[{type: haze, sd: 0.2}]"
RAMP = "filters=[{type: ramp, acceleration: 1.0}]"
GAINS = "disturbances=[{type: gains, spread: 0.1}]"
SHORT = "time.duration=3.0"


@pytest.fixture(autouse=True, scope="module")
def _installed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    folder = install(tmp_path_factory.mktemp("stages") / "installed")
    targets = [target for names in entry_points().values() for target in names.values()]
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    yield
    sys.path.remove(str(folder))
    for target in targets:
        sys.modules.pop(target.split(":")[0], None)


def world(*overrides: str, name: str = "three_robots") -> World:
    return load_world(name, overrides=[SHORT, "expect=null", *overrides])


# Sense


def test_each_observer_sees_others_where_they_are_not_and_itself_where_it_is() -> None:
    simulation = Simulation(world(HAZE))
    for _ in range(30):
        simulation.step()
    truth, seen = simulation.now, {}
    for i in range(3):
        me = simulation.observe(i)
        assert (me.pose == truth.pose[i]).all()
        assert (me.station, me.reference_station) == (
            truth.station[i], truth.reference_station[i],
        )  # fmt: skip
        for other in me.others:
            seen[i, other.index] = other
            off = other.pose - truth.pose[other.index]
            assert 0.0 < np.abs(off[:2]).max() < 1.2
            assert off[2] == 0.0
    assert len(seen) == 6
    for j in range(3):
        one, two = (seen[i, j] for i in range(3) if i != j)
        assert (one.pose != two.pose)[:2].all()
        assert one.station != two.station
    stations = {i: {n.index: n.station for n in simulation.observe(i).neighbours} for i in range(3)}
    assert stations[0][2] == seen[0, 2].station != truth.reference_station[2]


def test_truth_is_what_it_is_whatever_is_sensed() -> None:
    """With commands from outside, robots do not look at what they sense, and move alike."""
    clear, hazy = Simulation(world()), Simulation(world(HAZE))
    for k in range(60):
        commands = np.full((3, 2), (0.8, 0.1 * np.sin(k)))
        clear.step(commands)
        hazy.step(commands)
        assert hazy.last is not None
        assert hazy.last.truth.pose is not hazy.last.sensed.pose
    assert np.array_equal(clear.pose, hazy.pose)
    assert np.array_equal(clear.now.reference_station, hazy.now.reference_station)


def offsets(simulation: Simulation, steps: int) -> dict[tuple[int, int], tuple[float, ...]]:
    """How far observers see others from where they are, by observer and observed, at a step."""
    for _ in range(steps + 1):
        simulation.step(np.zeros((simulation.scene.robots, 2)))
    assert simulation.last is not None
    sensed, truth = simulation.last.sensed, simulation.last.truth
    off = sensed.pose - truth.pose[sensed.robot]
    pairs = zip(observer_of_row(sensed).tolist(), sensed.robot.tolist(), strict=True)
    return {pair: tuple(row) for pair, row in zip(pairs, off.round(9).tolist(), strict=True)}


def test_noise_depends_on_seed_step_observer_and_observed_alone() -> None:
    hazy = world(HAZE)
    fewer = hazy.changed(robots=hazy.robots[:2])
    here = offsets(Simulation(hazy, seed=3), 7)
    assert offsets(Simulation(hazy, seed=3), 7) == here
    for other in (offsets(Simulation(hazy, seed=4), 7), offsets(Simulation(hazy, seed=3), 8)):
        assert all((other[pair] == here[pair]) == (pair[0] == pair[1]) for pair in here)
    without = offsets(Simulation(fewer, seed=3), 7)
    assert without == {pair: here[pair] for pair in without}
    assert len(without) == 4


class Plain:
    """The paper's controller without its batch form."""

    def __init__(self, inner: Any) -> None:
        self.inner, self.settings = inner, inner.settings
        self.modes, self.rules, self.columns = inner.modes, inner.rules, inner.columns

    def decide(self, observation: Any, memory: Any) -> Any:
        return self.inner.decide(observation, memory)


@pytest.mark.parametrize("name", ["three_robots", "nonconvex"])
def test_batch_and_plain_form_decide_alike_on_the_same_sensed_rows(name: str) -> None:
    hazy = world("sensing.stages=[{type: haze, sd: 0.5}, {type: haze, sd: 0.1}]", name=name)
    inner = make_part(CONTROLLER, "mode_switching", hazy.controller.settings)
    batch, plain = Simulation(hazy), Simulation(hazy, controller=Plain(inner))
    assert isinstance(batch.parts.controller, Batched)
    assert not isinstance(plain.parts.controller, Batched)
    decided = 0
    for _ in range(250):
        batch.step()
        plain.step()
        assert batch.last is not None
        assert plain.last is not None
        one, two = batch.last.decisions, plain.last.decisions
        assert (one is None) == (two is None)
        if one is not None and two is not None:
            for a, b in zip(one, two, strict=True):
                assert np.array_equal(a, b, equal_nan=True)
            decided += len(one.robot)
    assert decided > 40
    assert np.array_equal(batch.pose, plain.pose)
    clear = simulate(world(name=name))
    assert not np.array_equal(clear.pose[250], batch.pose)


class Blind:
    """Nobody sees anybody: rows of the others are left out."""

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, truth: Any, sensed: Sensed, state: Any) -> Any:
        rows = for_each(sensed)
        own = observer_of_row(rows) == rows.robot
        number = np.arange(scene.robots)
        return rows._replace(
            robot=rows.robot[own], pose=rows.pose[own], command=rows.command[own],
            reference_station=rows.reference_station[own], age=rows.age[own],
            first=number, end=number + 1,
        ), state  # fmt: skip


def test_rows_may_be_left_out() -> None:
    simulation = Simulation(world(), sensing=[Blind()])
    assert [simulation.observe(i).others for i in range(3)] == [()] * 3
    assert [simulation.observe(i).neighbours for i in range(3)] == [()] * 3
    simulation.step()
    assert simulation.last is not None
    assert simulation.last.decisions is not None
    assert len(simulation.last.decisions.considered) == 0


class Drift:
    """Every robot believes that it is 0.3 m further along the x axis than it is."""

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, truth: Any, sensed: Sensed, state: Any) -> Any:
        rows = for_each(sensed)
        own = observer_of_row(rows) == rows.robot
        return with_poses(scene, rows, rows.pose + np.outer(own, (0.3, 0.0, 0.0))), state


def test_a_robot_that_errs_about_itself_errs_about_its_stations() -> None:
    simulation = Simulation(world(name="straight"), sensing=[Drift()])
    for _ in range(100):
        simulation.step()
    truth, one = simulation.now, simulation.observe(0)
    assert one.pose[0] == pytest.approx(truth.pose[0, 0] + 0.3)
    assert one.station == pytest.approx(truth.station[0] + 0.3)
    assert one.reference_station == pytest.approx(truth.reference_station[0] + 0.3)
    assert one.others[0].station == truth.reference_station[1]
    assert (one.others[0].pose == truth.pose[1]).all()


# Filter and disturbance


class Line:
    """Commands times a factor, and something more."""

    def __init__(self, factor: float, more: float) -> None:
        self.factor, self.more = factor, more

    def start(self, scene: Any) -> None:
        return None

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return nominal * self.factor + self.more, state

    def disturb(self, scene: Any, truth: Any, filtered: Any, state: Any) -> Any:
        return filtered * self.factor + self.more, state


def test_filters_stand_in_their_order() -> None:
    half, more = Line(0.5, 0.0), Line(1.0, 0.2)
    for first, second, reached in ((half, more, 0.7), (more, half, 0.6)):
        for kind in ("filters", "disturbances"):
            given: dict[str, Any] = {kind: [first, second]}
            simulation = Simulation(world(), **given)
            simulation.step(np.array([[1.0, 0.0]] * 3))
            assert simulation.last is not None
            assert simulation.last.applied[:, 0] == pytest.approx([reached] * 3)


def test_filters_see_what_is_sensed_and_remember() -> None:
    seen = []

    class Looks:
        def start(self, scene: Any) -> int:
            return 0

        def filter(self, scene: Any, sensed: Sensed, nominal: Any, state: int) -> Any:
            seen.append((state, sensed.step, sensed.pose))
            return nominal, state + 1

    simulation = Simulation(world(HAZE), filters=[Looks()])
    for _ in range(5):
        simulation.step()
        assert simulation.last is not None
        assert seen[-1][2] is simulation.last.sensed.pose
        assert simulation.last.filtered is simulation.last.nominal
    assert [(state, step) for state, step, _ in seen] == [(k, k) for k in range(5)]
    assert len(seen[0][2]) == 9


def test_stages_go_one_after_the_other_and_stand_in_the_record() -> None:
    given = world(RAMP, GAINS)
    record = simulate(given)
    plain = simulate(world())
    steps = len(record.pose) - 1
    stages = [record.commands_over(s, 0, steps) for s in ("nominal", "filtered", "applied")]
    nominal, filtered, applied = stages
    rise = np.diff(filtered[..., 0], axis=0, prepend=0.0)
    assert np.abs(rise).max() <= 1.0 * record.dt + 1e-12
    assert np.abs(np.diff(nominal[..., 0], axis=0, prepend=0.0)).max() > 0.5
    gains = applied[-1, :, 0] / filtered[-1, :, 0]
    assert np.allclose(applied[..., 0], filtered[..., 0] * gains, atol=1e-12)
    assert (np.abs(gains - 1.0) > 1e-3).all()
    turn = applied[..., 1] * record.dt
    assert np.allclose(np.diff(record.pose[..., 2], axis=0), turn, atol=1e-9)
    assert record.world == given
    assert record.given == ()
    assert len(plain.commands) == 0
    assert len(record.commands) == (np.abs(applied - nominal).max(axis=2) > 0.0).sum()


@pytest.mark.parametrize("way", ["deepcopy", "pickle", "restore"])
def test_what_stages_remember_comes_along_with_a_state(way: str) -> None:
    hazy = world(HAZE, RAMP, GAINS)
    simulation = Simulation(hazy)
    for _ in range(25):
        simulation.step()
    if way == "deepcopy":
        other = copy.deepcopy(simulation)
    elif way == "pickle":
        other = pickle.loads(pickle.dumps(simulation))
    else:
        other = Simulation(hazy, state=simulation.state)
    for _ in range(75):
        simulation.step()
        other.step()
        assert simulation.last is not None
        assert other.last is not None
        for name in ("nominal", "filtered", "applied", "pose"):
            assert np.array_equal(getattr(simulation.last, name), getattr(other.last, name))
    assert (simulation.last.filtered != simulation.last.nominal).any()
    assert (simulation.last.applied != simulation.last.filtered).any()


def test_limits_bind_filters_but_not_disturbances() -> None:
    class Twice:
        def start(self, scene: Any) -> None:
            return None

        def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
            return 2.0 * nominal, state

        def disturb(self, scene: Any, truth: Any, filtered: Any, state: Any) -> Any:
            return 2.0 * filtered, state

    commands = np.array([[1.0, 0.2]] * 3)
    pushed = Simulation(world(), disturbances=[Twice()])
    before = pushed.pose
    pushed.step(commands)
    assert np.allclose(np.hypot(*(pushed.pose - before)[:, :2].T), 2.0 * pushed.scene.dt)
    with pytest.raises(ControllerError, match=r"^filter Twice: r1 at 0 s: command v = 2 m/s"):
        Simulation(world(), filters=[Twice()]).step(commands)


# What fails


class Fails:
    """Answers in every wrong way."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def start(self, scene: Any) -> Any:
        return self.answer() if self.answer is at_start else None

    def sense(self, scene: Any, truth: Any, sensed: Any, state: Any) -> Any:
        return self.answer(sensed)

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return self.answer(nominal)

    def disturb(self, scene: Any, truth: Any, filtered: Any, state: Any) -> Any:
        return self.answer(filtered)


def at_start() -> Any:
    raise KeyError("lost")


def in_a_step(given: Any) -> Any:
    return {}["lost"]


def leaves(given: Any) -> Any:
    raise SystemExit(3)


def writes(given: Any) -> Any:
    array = given.pose if isinstance(given, Sensed) else given
    array[0] = 0.0
    return given, None


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        (at_start, r"at 0 s: KeyError: 'lost' \(.*test_stages\.py:\d+\)"),
        (in_a_step, r"at 0 s: KeyError: 'lost' \(.*test_stages\.py:\d+\)"),
        (leaves, "at 0 s: SystemExit: 3"),
        (writes, "at 0 s: ValueError: assignment destination is read-only"),
        (
            lambda given: given,
            r"returned (a Sensed|an array).* must return \(.*, state",
        ),
        (
            lambda given: None,
            r" \w+ returned None; it must return \(.*, state\)",
        ),
        (lambda given: (given, 1, 2), "returned a tuple of 3; it must return"),
        (lambda given: ("x", None), "returned a str .*(must be a Sensed|numbers, shape \\(3, 2)"),
        (lambda given: ([[1.0], [1.0, 2.0]], None), "returned a list .*must be"),
    ],
)
@pytest.mark.parametrize("kind", ["sensing", "filters", "disturbances"])
def test_errors_in_a_stage_are_one_line_that_names_it(kind: str, answer: Any, told: str) -> None:
    words = {"sensing": "sensing stage", "filters": "filter", "disturbances": "disturbance"}
    with pytest.raises(ControllerError) as caught:
        Simulation(world(), **{kind: [Fails(answer)]}).step()  # type: ignore[arg-type]
    message = str(caught.value)
    assert re.match(f"{words[kind]} Fails at 0 s: ", message), message
    assert re.search(told, message), message
    assert "\n" not in message


@pytest.mark.parametrize("kind", ["sensing", "filters", "disturbances"])
def test_what_is_returned_wrongly_is_told_with_the_line_of_the_method(kind: str) -> None:
    method = {"sensing": Fails.sense, "filters": Fails.filter, "disturbances": Fails.disturb}[kind]
    here = re.escape(f"({__file__}:{method.__code__.co_firstlineno})")
    with pytest.raises(ControllerError, match=f"{here}$"):
        Simulation(world(), **{kind: [Fails(lambda given: None)]}).step()  # type: ignore[arg-type]


class Short:
    """Its methods take other arguments than they are given."""

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, sensed: Any, state: Any) -> Any:
        return sensed, state

    filter = disturb = sense


@pytest.mark.parametrize(
    ("kind", "called"),
    [
        ("sensing", "sense(scene, truth, sensed, state)"),
        ("filters", "filter(scene, sensed, nominal, state)"),
        ("disturbances", "disturb(scene, truth, filtered, state)"),
    ],
)
def test_a_method_with_other_arguments_is_told_what_it_is_given(kind: str, called: str) -> None:
    part: Any = Short()
    with pytest.raises(ControllerError) as caught:
        Simulation(world(), **{kind: [part]}).step()  # type: ignore[arg-type]
    message = str(caught.value)
    assert called in message
    assert message.endswith(f"({__file__}:{Short.sense.__code__.co_firstlineno})")


def test_start_and_decide_with_other_arguments_are_told_too() -> None:
    class NoStart(Short):
        def start(self) -> None:  # type: ignore[override]
            return None

    class Odd:
        def decide(self, observation: Any) -> Any:
            return None

    part: Any = NoStart()
    with pytest.raises(ControllerError, match=r"start\(scene\).*test_stages.py:\d+\)$"):
        Simulation(world(), filters=[part])
    odd: Any = Odd()
    with pytest.raises(
        ControllerError, match=r"^controller Odd, r1 at 0 s: .*decide\(observation, memory\).*py:\d"
    ):
        Simulation(world(), controller=odd).step()


def test_a_type_error_within_a_method_points_at_its_own_line() -> None:
    def adds(given: Any) -> Any:
        return 1 + "x"  # type: ignore[operator]

    line = adds.__code__.co_firstlineno + 1
    with pytest.raises(ControllerError, match=rf"TypeError: .*test_stages.py:{line}\)$"):
        Simulation(world(), filters=[Fails(adds)]).step()


@pytest.mark.parametrize(
    ("answer", "given"), [(None, "None"), (5, "an int"), ("no", "a str"), (["no"], "a str among")]
)
def test_what_is_no_list_of_faults_is_told(answer: Any, given: str) -> None:
    class Picky(Blind):
        def world_faults(self, world: World, where: Any) -> Any:
            return answer

    line = Picky.world_faults.__code__.co_firstlineno
    with pytest.raises(ControllerError) as caught:
        Simulation(world(), sensing=[Picky()])
    message = str(caught.value)
    assert f"world_faults returned {given}" in message
    assert "Fault(location, message)" in message
    assert message.endswith(f"({__file__}:{line})")


def test_one_stage_without_a_list_is_told() -> None:
    one: Any = Line(1.0, 0.0)
    for kind in ("sensing", "filters", "disturbances", "observers"):
        with pytest.raises(ControllerError, match=rf"^{kind} must be a list.*Line.*{kind}=\["):
            simulate(world(), **{kind: one})  # type: ignore[arg-type]
    with pytest.raises(ControllerError, match=r"^observers must be a list.*Line"):
        Simulation(world(), observers=one)
    assert Simulation(world(), filters=(f for f in [one])).parts.filters == (one,)  # type: ignore[arg-type]


def test_a_disturbance_that_is_not_finite_names_robot_and_value() -> None:
    bad = np.zeros((3, 2))
    bad[1, 1] = np.inf
    part: Any = Fails(lambda given: (bad, None))
    told = r"^disturbance Fails: r2 at 0 s: command omega = inf rad/s.*finite"
    with pytest.raises(ControllerError, match=told):
        Simulation(world(), disturbances=[part]).step()


def test_commands_and_holds_that_cannot_be_name_the_controller() -> None:
    class Fast:
        def __init__(self, v: float, hold: float) -> None:
            self.v, self.hold = v, hold

        def decide(self, observation: Any, memory: Any) -> Any:
            return Decision(self.v, 0.0, self.hold)

    for v, hold, told in ((9.0, 0.1, "command v = 9 m/s"), (0.0, -1.0, "hold = -1 s")):
        with pytest.raises(ControllerError, match=f"^controller Fast: r1 at 0 s: {told}"):
            Simulation(world(), controller=Fast(v, hold)).step()


@pytest.mark.parametrize("nonsense", [[[1.0, 2.0]], np.full((3, 2), np.nan)])
def test_commands_of_no_use_are_refused(nonsense: Any) -> None:
    for kind, word in (("filters", "filter Fails"), ("disturbances", "disturbance Fails")):
        part: Any = Fails(lambda given: (nonsense, None))
        with pytest.raises(ControllerError, match=word):
            Simulation(world(), **{kind: [part]}).step()  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"pose": np.zeros((2, 3))}, "pose has the shape"),
        ({"pose": np.full((3, 3), np.nan)}, "pose is not finite"),
        ({"robot": np.array([0, 1, 1])}, "must have one row of itself"),
        ({"robot": np.array([0.0, 1.0, 2.0])}, "robot is of type float64"),
        ({"robot": np.array([0, 1, 7])}, "names one that there is not"),
        ({"first": [0, 0, 0]}, "first is of type list"),
        ({"end": np.array([3, 3, 9])}, "there are 3"),
    ],
)
def test_rows_of_no_use_are_refused(change: dict[str, Any], told: str) -> None:
    part = Fails(lambda sensed: (sensed._replace(**change), None))
    with pytest.raises(ControllerError, match=told):
        Simulation(world(), sensing=[part]).step()


def test_stages_may_object_to_a_world_that_was_made_in_python() -> None:
    from physim.errors import Fault, WorldError

    class Picky(Blind):
        def world_faults(self, world: World, where: Any) -> Any:
            return [Fault((*where, "x"), f"not with {len(world.robots)} robots")]

    with pytest.raises(WorldError, match=r"sensing\.stages\[1\]\.x: not with 3 robots"):
        Simulation(world(HAZE), sensing=[Picky()])


# Observers


class Watches:
    """Takes down what it is told; fails where it is asked to."""

    def __init__(self, fails: str = "") -> None:
        self.fails, self.told = fails, list[str]()

    def _note(self, what: str) -> None:
        self.told.append(what)
        if what == self.fails:
            raise ZeroDivisionError("out of patience")

    def start(self, simulation: Simulation) -> None:
        self._note("start")

    def after_step(self, step: Any) -> None:
        self._note(f"step {step.truth.step}")

    def close(self, ended: str) -> None:
        self._note(f"close {ended}")


@pytest.mark.parametrize(
    ("fails", "at", "ended", "steps"),
    [("start", "0 s", "error", 0), ("step 4", "0.05 s", "error", 5),
     ("close duration", "0.1 s", "duration", 10)],
)  # fmt: skip
def test_an_observer_that_fails_ends_the_run_and_the_record_is_kept(
    tmp_path: Path, fails: str, at: str, ended: str, steps: int
) -> None:
    first, bad, last = Watches(), Watches(fails), Watches()
    simulation = Simulation(world("time.duration=0.1"))
    with pytest.raises(ControllerError, match=f"^observer Watches at {at}: ZeroDivisionError"):
        record_run(simulation, observers=[first, bad, last], path=tmp_path / "record.h5")
    with Record.load(tmp_path / "record.h5") as record:
        assert (record.ended, len(record.pose)) == (ended, steps + 1)
    assert (bad.told == ["start"]) is (fails == "start")
    assert first.told[-1] == f"close {ended}"
    assert first.told.count("start") == 1
    assert last.told[-1:] == ([] if fails == "start" else [f"close {ended}"])
    assert simulation.observers == []


def test_what_is_no_observer_is_refused_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(ControllerError, match="observer object has no method start"):
        record_run(Simulation(world()), observers=[object()])  # type: ignore[list-item]
