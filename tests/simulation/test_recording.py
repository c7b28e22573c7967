"""The record of a run: the same however it is written, and it says how the run ended."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import (
    Decision,
    Observation,
    SaveAt,
    Simulation,
    build_scene,
    for_each,
    observer_of_row,
    simulate,
    with_poses,
)
from physim.analysis.metrics import Figures
from physim.errors import ControllerError, RecordError
from physim.record import Record
from physim.world.file import load_world
from tests.helpers import THREE, Says, facts, inside, road
from tests.helpers.stages import Changes

LateError, record_run = inside("physim.simulation", "LateError", "record_run")
RECORDER = sys.modules[inside("physim.simulation", "Recorder").__module__]


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
    assert len(Figures(every).episodes) >= 2
    for name in ("clearance", "boundary_clearance"):
        full, thin = getattr(every, name), getattr(seventh, name)
        assert np.array_equal(thin[0], full[0])
        for k in range(1, len(thin)):
            window = full[seventh.steps[k - 1] + 1 : seventh.steps[k] + 1]
            assert np.array_equal(thin[k], window.min(axis=0))
        assert np.array_equal(every.extremes[name], full.min(axis=0))


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
        monkeypatch.setattr(RECORDER, "BLOCK_SECONDS", -1.0)  # every step
        assert simulate(world, controller=Says(drift)).digest() == whole.digest()
        monkeypatch.setattr(RECORDER, "BLOCK_SECONDS", 1e9)
        assert simulate(world, controller=Says(drift)).digest() == whole.digest()
        monkeypatch.setattr(RECORDER, "BLOCK_STEPS", 13)
        assert simulate(world, controller=Says(drift)).digest() == whole.digest()
        monkeypatch.undo()


@pytest.mark.parametrize("hash_seed", ["1", pytest.param("2", marks=pytest.mark.deep)])
def test_another_process_gives_the_same_digest(hash_seed: str) -> None:
    script = (
        "import physim\n"
        "world = physim.load_world('three_robots', overrides=['time.duration=2.0'])\n"
        "print(physim.simulate(world, seed=12).digest())"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True, text=True, env={**os.environ, "PYTHONHASHSEED": hash_seed},
    )  # fmt: skip
    world = load_world("three_robots", overrides=["time.duration=2.0"])
    assert done.stdout.strip() == simulate(world, seed=12).digest(), done.stderr


def test_a_run_says_how_it_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """Robots drive 5 cm past their stop stations, or stand somewhere else."""

    def until(o: Observation) -> Decision:
        past = o.pose[0] >= 200.05
        return Decision(0.0 if past else 0.9, 0.0, hold=0.01)

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
    for steps in (1, 10, 1000):  # whatever the blocks in which it is recorded
        monkeypatch.setattr(RECORDER, "BLOCK_STEPS", steps)
        assert simulate(world, controller=Says(until)).arrived.tolist() == since.tolist()
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


# Observers


class Watches:
    """Takes down what it is told, and does something to the simulation after a step or at the end.

    ``does`` is called with the simulation when it is told ``when``.
    """

    def __init__(self, when: int | str = "", does: Callable[[Simulation], object] = id) -> None:
        self.when, self.does, self.told = when, does, list[int | str]()

    def start(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.note("start")

    def after_step(self, step: Any) -> None:
        self.note(step.truth.step)

    def close(self, ended: str) -> None:
        self.note(ended)

    def note(self, what: int | str) -> None:
        self.told.append(what)
        if what == self.when:
            self.does(self.simulation)


def fails(simulation: Simulation) -> None:
    raise ZeroDivisionError("out of patience")


@pytest.mark.parametrize(
    "does",
    [
        lambda simulation: simulation.reset(),
        lambda simulation: simulation.restore(Simulation(simulation.scene).state),
        lambda simulation: simulation.step(np.zeros((3, 2))),
        lambda simulation: simulation.observers.clear(),
        lambda simulation: setattr(simulation, "next_decision", simulation.next_decision + 5),
    ],
)
def test_an_observer_that_moves_the_simulation_ends_the_run(
    wild: Any, does: Callable[[Simulation], object], tmp_path: Path
) -> None:
    """Its record holds what was taken down before, and says that the run broke off."""
    path = tmp_path / "record.h5"
    with pytest.raises(ControllerError, match="observer"):
        simulate(wild, controller=Says(drift), observers=[Watches(30, does)], path=path)
    with Record.load(path) as record:
        assert record.ended == "error"
        assert record.samples >= 32


def test_an_observer_that_steps_in_close_is_told_and_the_record_is_whole(
    wild: Any, tmp_path: Path
) -> None:
    alone = simulate(wild, controller=Says(drift))
    steps = Watches("duration", lambda simulation: simulation.step())
    with pytest.raises(LateError, match=facts("observer Watches", "moved", "close")):
        simulate(wild, controller=Says(drift), observers=[steps], path=tmp_path / "record.h5")
    with Record.load(tmp_path / "record.h5") as record:
        assert (record.ended, record.steps_run) == (alone.ended, alone.steps_run)
        assert np.array_equal(record.pose, alone.pose)


@pytest.mark.parametrize(
    ("when", "at", "ended", "steps"),
    [
        ("start", "0 s", "error", 0),
        (4, "0.05 s", "error", 5),
        ("duration", "0.1 s", "duration", 10),
    ],
)
def test_an_observer_that_fails_ends_the_run_and_the_record_is_kept(
    tmp_path: Path, when: int | str, at: str, ended: str, steps: int
) -> None:
    first, bad, last = Watches(), Watches(when, fails), Watches()
    simulation = Simulation(road(THREE, duration=0.1))
    with pytest.raises(ControllerError, match=facts("observer Watches", at, "ZeroDivisionError")):
        record_run(simulation, observers=[first, bad, last], path=tmp_path / "record.h5")
    with Record.load(tmp_path / "record.h5") as record:
        assert (record.ended, len(record.pose)) == (ended, steps + 1)
    assert (bad.told == ["start"]) is (when == "start")
    assert first.told[-1] == ended
    assert last.told[-1:] == ([] if when == "start" else [ended])
    assert simulation.observers == []
    with pytest.raises(ControllerError, match=facts("observer object", "start")):
        record_run(Simulation(road(THREE)), observers=[object()])  # type: ignore[list-item]


@pytest.mark.parametrize("step", ["start", 30])
@pytest.mark.parametrize("when", [31, "duration"])
def test_an_observer_that_another_let_look_on_is_named_and_closed(
    wild: Any, step: int | str, when: int | str
) -> None:
    other = Watches(when, fails)
    adds = Watches(step, lambda simulation: simulation.look_on(other))
    at = "6.11 s" if when == "duration" else "0.32 s"
    with pytest.raises(ControllerError, match=facts("observer Watches", at, "ZeroDivisionError")):
        simulate(wild, controller=Says(drift), observers=[adds])
    assert other.told[:2] == ["start", 0 if step == "start" else 31]
    assert other.told[-1] == ("duration" if when == "duration" else "error")


def arrays_of(value: Any) -> list[Any]:
    """All arrays of a step, in whatever they stand."""
    if isinstance(value, np.ndarray):
        return [value]
    return [one for part in value for one in arrays_of(part)] if isinstance(value, tuple) else []


@pytest.mark.parametrize("plain", [True, False])
def test_no_array_of_a_step_can_be_written_to(plain: bool) -> None:
    """An observer that turns m/s into km/h in place would change the record."""
    writable: list[Any] = []

    class Looks(Watches):
        def after_step(self, step: Any) -> None:
            writable.extend(one for one in arrays_of(tuple(step)) if one.flags.writeable)

    world = load_world("merging").changed(time={"duration": 0.3})
    given = {"controller": Says(drift)} if plain else {}
    simulate(world, observers=[Looks()], **given)
    assert writable == []


class Noting:
    """Goes straight on, and notes what it observes."""

    def __init__(self) -> None:
        self.seen: dict[tuple[int, int, int], list[float]] = {}

    def decide(self, observation: Any, memory: None) -> Decision:
        step = round(observation.time / observation.dt)
        for one in (observation, *observation.others):
            values = [*one.pose, *one.velocity]
            self.seen[step, observation.index, one.index] = values
        return Decision(1.0, 0.0, hold=0.1 * (1 + observation.index))


def test_the_record_holds_what_each_robot_sensed_where_asked() -> None:
    def shifted(sensed: Any) -> Any:
        rows = for_each(sensed)
        far = rows.pose + 0.1 * (observer_of_row(rows) + 1.0)[:, None]
        return with_poses(rows_scene, rows, far)._replace(age=np.full(len(far), 0.25))

    world = load_world("three_robots").changed(time={"duration": 2.0}, sensing={"range": 4.0})
    rows_scene, controller = build_scene(world), Noting()
    save = SaveAt(sensed=True)
    record = simulate(world, controller=controller, sensing=[Changes(shifted)], save=save)
    rows = record.sensed
    found = {row[:3]: [*row[3:9]] for row in rows.tolist()}
    near = {key: found[key] for key in controller.seen}
    assert near == controller.seen
    beyond = found.keys() - near.keys()  # formation neighbours, of which stations are known
    assert beyond
    assert len(found) == len(rows)
    assert (rows["age"] == 0.25).all()
    assert (rows["heard"] == 0.0).all()
    with pytest.raises(RecordError, match="--keep-sensed"):
        simulate(world, controller=Noting()).sensed  # noqa: B018
