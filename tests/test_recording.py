"""The record of a run: the same however it is written, and it says how the run ended."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim import PAPER_MODES, Decision, Observation, SaveAt, Simulation, build_scene, simulate
from physim.analysis.metrics import contact_episodes
from physim.contacts import FALSE_CONTACT_ROW
from physim.errors import ControllerError
from physim.record import Record, RecordWriter
from physim.world.file import load_world
from tests.helpers import THREE, Says, facts, inside, road

Recorder, LateError, record_run = inside("physim.simulation", "Recorder", "LateError", "record_run")
find_world = inside("physim.world.file", "find_world")


@pytest.fixture(scope="module")
def wild() -> Any:
    """Robots that cross, meet and touch walls now and then: 6.11 s, two thirds of a block over."""
    return road(
        [[20.0, -2.0, 1.2], [20.0, 2.0, -1.2], [30.0, 17.0, 0.8]],
        duration=6.11,
    )  # fmt: skip


def drift(o: Observation) -> Decision:
    return Decision(1.0, 0.1 * math.sin(3.0 * o.time), hold=0.07)


def test_extremes_are_over_all_steps_however_few_are_recorded(wild: Any) -> None:
    every = simulate(wild, controller=Says(drift))
    time = type(wild.time)(step=0.01, duration=6.11, record_every=7)
    seventh = simulate(wild.changed(time=time), controller=Says(drift))
    assert every.steps.tolist() == list(range(612))
    assert seventh.steps.tolist() == [*range(0, 612, 7), 611]
    assert np.array_equal(seventh.pose, every.pose[seventh.steps])
    assert np.array_equal(seventh.extremes, every.extremes)
    assert seventh.updates.tobytes() == every.updates.tobytes()
    assert seventh.contacts.tobytes() == every.contacts.tobytes()
    assert len(contact_episodes(every)) >= 2
    for name in ("clearance", "boundary_clearance"):
        full, thin = getattr(every, name), getattr(seventh, name)
        assert np.array_equal(thin[0], full[0])
        for k in range(1, len(thin)):
            window = full[seventh.steps[k - 1] + 1 : seventh.steps[k] + 1]
            assert np.array_equal(thin[k], window.min(axis=0))
        assert np.array_equal(every.extremes[name], full.min(axis=0))


def test_clearances_of_the_record_are_those_of_the_poses(wild: Any) -> None:
    record = simulate(wild, controller=Says(drift))
    corners = np.array([[-0.9, -0.5], [0.9, -0.5], [0.9, 0.5], [-0.9, 0.5]])
    for k in range(0, 612, 47):
        boxes = []
        for x, y, heading in record.pose[k]:
            c, s = math.cos(heading), math.sin(heading)
            boxes.append(shapely.Polygon(corners @ np.array([[c, s], [-s, c]]) + (x, y)))
        for i in range(3):
            apart = min(boxes[i].distance(boxes[j]) for j in range(3) if j != i)
            if apart > 0.0:
                assert record.clearance[k, i] == pytest.approx(apart, abs=1e-9)
            else:
                assert record.clearance[k, i] <= 1e-9


def test_file_and_memory_hold_the_same_run(wild: Any, tmp_path: Path) -> None:
    memory = simulate(wild, controller=Says(drift))
    with simulate(wild, controller=Says(drift), path=tmp_path / "r.h5") as file:
        assert file.digest() == memory.digest()
    with Record.load(tmp_path / "r.h5") as loaded:
        assert loaded.digest() == memory.digest()
        assert loaded.seed == 0
        assert loaded.world == wild
    slower = simulate(wild, controller=Says(lambda o: Decision(0.999, 0.0, hold=0.1)))
    assert slower.digest() != memory.digest()


def test_blocks_of_any_length_give_the_same_record(
    wild: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """How often a block goes to the record hangs on the wall clock; what is in it must not."""
    for every in (1, 4):
        time = type(wild.time)(step=0.01, duration=2.99, record_every=every)
        world = wild.changed(time=time)
        whole = simulate(world, controller=Says(drift))
        monkeypatch.setattr("physim.simulation.recorder.BLOCK_SECONDS", -1.0)  # every step
        assert simulate(world, controller=Says(drift)).digest() == whole.digest()
        monkeypatch.setattr("physim.simulation.recorder.BLOCK_SECONDS", 1e9)
        assert simulate(world, controller=Says(drift)).digest() == whole.digest()
        monkeypatch.setattr("physim.simulation.recorder.BLOCK_STEPS", 13)
        assert simulate(world, controller=Says(drift)).digest() == whole.digest()
        monkeypatch.undo()


@pytest.mark.parametrize("hash_seed", ["1", "2"])
def test_another_process_gives_the_same_digest(hash_seed: str) -> None:
    script = (
        "import physim\n"
        "from physim.world.file.files import find_world\n"
        "world = physim.load_world(find_world('three_robots'), overrides=['time.duration=8.0'])\n"
        "print(physim.simulate(world, seed=12).digest())"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True, text=True, env={**os.environ, "PYTHONHASHSEED": hash_seed},
    )  # fmt: skip
    world = load_world(find_world("three_robots"), overrides=["time.duration=8.0"])
    assert done.stdout.strip() == simulate(world, seed=12).digest(), done.stderr


def test_a_run_says_how_it_ended() -> None:
    """Robots drive 5 cm past their stop stations, or stand somewhere else."""

    def until(o: Observation) -> Decision:
        past = o.pose[0] >= 200.05
        return Decision(0.0 if past else 0.9, 0.0, hold=0.01)

    def ends(o: Observation) -> Decision:
        return Decision(0.0, 0.0, hold=0.01, mode="arrived")

    near = [[196.0 - 3.0 * (i == 1), y, 0.0] for i, y in enumerate((-10.0, 0.0, 10.0))]
    world = road(near, duration=20.0)
    stop = build_scene(world).stop_station
    assert stop.tolist() == [200.0, 200.0, 200.0]
    record = simulate(world, controller=Says(until))
    assert record.ended == "finished"
    since = record.arrived
    stood = [int(np.flatnonzero(record.pose[:, i, 0] >= 200.05)[0]) for i in range(3)]
    assert record.steps_run == since.max()
    # still: the last 0.5 s lie within 1 cm, which the last step of 9 mm does, too
    assert since.tolist() == [k + 49 for k in stood]
    record = simulate(road(near, duration=0.25), controller=Says(until))
    assert (record.ended, record.steps_run, record.steps_planned) == ("duration", 25, 25)
    assert record.arrived.tolist() == [-1, -1, -1]

    seen = []
    simulation = Simulation(world, controller=Says(until))
    record = record_run(
        simulation,
        progress=lambda now, factor: seen.append(now.step_number),
        stop=lambda: simulation.step_number == 17,
    )
    assert (record.ended, record.steps_run, record.samples) == ("interrupted", 17, 18)
    assert seen == list(range(1, 18))


class Boastful:
    modes = PAPER_MODES

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return Decision(0.0, 0.0, hold=0.1, mode="arrived")


def test_a_controller_that_says_it_has_arrived_has_not() -> None:
    record = simulate(road(THREE, duration=2.0), controller=Boastful())
    assert (record.ended, set(record.updates["mode"])) == ("duration", {3})
    assert (record.arrived == -1).all()


def test_a_run_driven_from_outside_finishes_and_is_recorded_with_its_commands() -> None:
    world = road([[199.0, 0.0, 0.0]], duration=5.0)
    simulation = Simulation(world)
    writer = RecordWriter(None, simulation.scene, world.to_yaml(), declared=simulation.declared)
    recorder = Recorder(writer, every=1)
    simulation.look_on(recorder)
    while not simulation.finished and simulation.step_number < 500:
        simulation.step(np.array([[1.0 if simulation.now.station[0] < 200.0 else 0.0, 0.0]]))
    assert simulation.finished
    recorder.close("finished")
    writer.close("finished", steps_run=simulation.step_number, rejected=0, wall_clock={})
    record = writer.record()
    assert len(record.updates) == 0
    moved = np.diff(record.pose[:, 0, 0])
    assert record.commands_over("applied", 0, record.steps_run)[:, 0, 0] * 0.01 == pytest.approx(
        moved, abs=1e-12
    )
    assert record.arrived.tolist() == [record.steps_run]


def test_when_a_robot_arrived_does_not_depend_on_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """It stands at its stop from the start on: arrived once it has stood for half a second."""
    world = road([[200.0, 0.0, 0.0], [100.0, 9.0, 0.0]], duration=0.7)
    for steps in (1, 10, 50, 1000):
        monkeypatch.setattr("physim.simulation.recorder.BLOCK_STEPS", steps)
        record = simulate(world, controller=Says(lambda o: Decision(0.0, 0.0, hold=0.1)))
        assert record.arrived.tolist() == [50, -1]


@pytest.mark.parametrize("every", [1, 7])
def test_what_is_recorded_is_a_value(wild: Any, every: int) -> None:
    whole = simulate(wild, controller=Says(drift))
    thin = simulate(wild, controller=Says(drift), save=SaveAt(every=every, tables=("contacts",)))
    assert thin.record_every == every
    assert thin.tables == ("contacts",)
    assert len(thin.updates) == len(thin.considered) == 0
    assert thin.contacts.tobytes() == whole.contacts.tobytes()
    assert np.array_equal(thin.pose, whole.pose[thin.steps])
    with pytest.raises(ValueError, match="'commands'; allowed: updates"):
        SaveAt(tables=("commands",))
    for odd in (1.5, 2.0, True, math.nan, "2", 0):
        with pytest.raises(ValueError, match=f"every = {odd!r}"):
            SaveAt(every=odd)
    assert type(SaveAt(every=np.int8(3)).every) is int


def test_a_run_that_touches_a_wall_tells_of_it() -> None:
    record = simulate(
        road([[198.004, 0.0, 0.0]], duration=5.0),
        controller=Says(lambda o: Decision(1.0, 0.0, hold=0.1)),
    )
    (episode,) = contact_episodes(record)
    assert episode.time == pytest.approx(4.1, abs=0.011)  # 203 m - 0.9 m - 198.004 m at 1 m/s
    assert record.boundary_clearance.min() < 0.0


@pytest.mark.parametrize("seconds", [1e9, -1.0], ids=["one block", "a block a step"])
def test_false_contacts_are_counted_over_the_whole_run(
    monkeypatch: pytest.MonkeyPatch, seconds: float
) -> None:
    """The engine is made to report one at every third sample."""
    monkeypatch.setattr("physim.simulation.recorder.BLOCK_SECONDS", seconds)
    simulation = Simulation(road(THREE))
    writer = RecordWriter(None, simulation.scene, "", name="", declared=simulation.declared)
    recorder = Recorder(writer, every=1)
    recorder.start(simulation)
    for step in range(1, 21):
        simulation.step()
        assert simulation.last is not None
        told = np.array([(step, 0, 1, 0.2)] if step % 3 == 0 else [], dtype=FALSE_CONTACT_ROW)
        recorder.after_step(simulation.last._replace(false_contacts=told))
    recorder.close("duration")
    writer.close("duration", steps_run=20, rejected=recorder.rejected, wall_clock={})
    with writer.record() as record:
        assert record.false_contacts["step"].tolist() == [3, 6, 9, 12, 15, 18]
        assert record.rejected_contacts == 6


def test_a_simulation_that_has_made_steps_is_not_recorded() -> None:
    simulation = Simulation(load_world("straight"))
    simulation.step()
    with pytest.raises(ValueError, match=facts("step 1", "step 0")):
        record_run(simulation)


class Meddles:
    """Does something to the simulation that it looks at, after a step."""

    def __init__(self, what: str, step: int) -> None:
        self.what, self.step = what, step

    def start(self, simulation: Simulation) -> None:
        self.simulation, self.state = simulation, simulation.state

    def after_step(self, step: Any) -> None:
        if step.truth.step == self.step:
            made = self.simulation
            if self.what == "reset":
                made.reset()
            elif self.what == "restore":
                made.restore(self.state)
            elif self.what == "decide":
                made.next_decision = made.next_decision + 5
            else:
                made.observers.clear()

    def close(self, ended: str) -> None:
        pass


@pytest.mark.parametrize("what", ["reset", "restore", "clear", "decide"])
def test_an_observer_that_moves_the_simulation_ends_the_run(
    wild: Any, what: str, tmp_path: Path
) -> None:
    """Its record holds what was taken down before, and says that the run broke off."""
    path = tmp_path / "record.h5"
    with pytest.raises(ControllerError, match="observer"):
        simulate(wild, controller=Says(drift), observers=[Meddles(what, 30)], path=path)
    with Record.load(path) as record:
        assert record.ended == "error"
        assert record.steps_run == 31
        assert record.samples == 32


class Steps:
    """Steps the simulation when the run is over."""

    def start(self, simulation: Simulation) -> None:
        self.simulation = simulation

    def after_step(self, step: Any) -> None:
        pass

    def close(self, ended: str) -> None:
        self.simulation.step()


def test_an_observer_that_steps_in_close_is_told_and_the_record_is_whole(
    wild: Any, tmp_path: Path
) -> None:
    path = tmp_path / "record.h5"
    simulate(wild, controller=Says(drift), path=tmp_path / "alone.h5")
    with pytest.raises(LateError, match=facts("observer Steps", "moved", "close")):
        simulate(wild, controller=Says(drift), observers=[Steps()], path=path)
    with Record.load(path) as record, Record.load(tmp_path / "alone.h5") as alone:
        assert (record.ended, record.steps_run) == (alone.ended, alone.steps_run)
        assert np.array_equal(record.pose, alone.pose)


class StepsOn(Steps):
    """Takes a step of its own after each."""

    def after_step(self, step: Any) -> None:
        if step.truth.step == 30:
            self.simulation.step(np.zeros((3, 2)))

    def close(self, ended: str) -> None:
        pass


def test_an_observer_that_takes_a_step_of_its_own_is_told(wild: Any, tmp_path: Path) -> None:
    """Its commands are nobody's decision: the record would be of another controller."""
    path = tmp_path / "record.h5"
    with pytest.raises(ControllerError, match=facts("observer StepsOn", "moved")):
        simulate(wild, controller=Says(drift), observers=[StepsOn()], path=path)
    with Record.load(path) as record:
        assert record.ended == "error"


def _arrays(value: Any) -> list[Any]:
    """All arrays of a step, in whatever they stand."""
    if isinstance(value, np.ndarray):
        return [value]
    return [one for part in value for one in _arrays(part)] if isinstance(value, tuple) else []


class Writes(Meddles):
    """Looks whether any array of a step could be written to."""

    def start(self, simulation: Simulation) -> None:
        self.writable: list[Any] = []

    def after_step(self, step: Any) -> None:
        self.writable += [one for one in _arrays(tuple(step)) if one.flags.writeable]


@pytest.mark.parametrize("plain", [True, False])
def test_no_array_of_a_step_can_be_written_to(plain: bool) -> None:
    """An observer that turns m/s into km/h in place would change the record."""
    looks = Writes("", 0)
    world = load_world("merging").changed(time={"duration": 1.0})
    given = {"controller": Says(drift)} if plain else {}
    simulate(world, observers=[looks], **given)
    assert looks.writable == []


class Added:
    """Takes down what it sees, and fails where it is asked to."""

    def __init__(self, fails: int | str) -> None:
        self.fails, self.told = fails, list[int | str]()

    def start(self, simulation: Simulation) -> None:
        self._note("start")

    def after_step(self, step: Any) -> None:
        self._note(step.truth.step)

    def close(self, ended: str) -> None:
        self._note(ended)

    def _note(self, what: int | str) -> None:
        self.told.append(what)
        if what == self.fails:
            raise ZeroDivisionError("out of patience")


class Adds:
    """Lets another look on, from the start or after a step."""

    def __init__(self, other: Added, step: int | None) -> None:
        self.other, self.step = other, step

    def start(self, simulation: Simulation) -> None:
        self.simulation = simulation
        if self.step is None:
            simulation.look_on(self.other)

    def after_step(self, step: Any) -> None:
        if step.truth.step == self.step:
            self.simulation.look_on(self.other)

    def close(self, ended: str) -> None:
        pass


@pytest.mark.parametrize("step", [None, 30])
@pytest.mark.parametrize("fails", [31, 40, "duration"])
def test_an_observer_that_another_let_look_on_is_named_and_closed(
    wild: Any, step: int | None, fails: int | str
) -> None:
    other = Added(fails)
    at = "6.11 s" if fails == "duration" else f"{(int(fails) + 1) * 0.01:g} s"
    with pytest.raises(ControllerError, match=facts("observer Added", at, "ZeroDivisionError")):
        simulate(wild, controller=Says(drift), observers=[Adds(other, step)])
    assert other.told[:2] == ["start", 0 if step is None else step + 1]
    assert other.told[-1] == ("duration" if fails == "duration" else "error")
