"""Branches and kept states: a run goes on from any sample, with a record that begins there.

Where nothing was changed, the record of the branch is the end of the original's, bit for bit.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim import (
    Decision,
    Observation,
    PhysimError,
    Record,
    RecordError,
    SaveAt,
    Simulation,
    record_run,
    state_at,
)
from tests.analysis.forgeries.parts import Ramp, Slip
from tests.helpers import facts, inside, said

judge, rerun = inside("physim.analysis", "judge", "rerun")
DISTURBANCE, FILTER = inside("physim.parts", "DISTURBANCE", "FILTER")

AGAINST = {"type": "path_following"}
WORLD = physim.load_world("three_robots", overrides=["time.duration=3"])
TOUCHING = WORLD.changed(controller=AGAINST)
"""Robots touch from 0.83 s to 1.42 s."""
K = 100


class Counts:
    """Remembers how often it decided, and where it was; decides at a step of its own by it."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        count, places = (memory["count"], memory["places"]) if memory else (0, ())
        told = {"count": count + 1, "places": (*places[-3:], np.array(observation.pose))}
        v, hold = 0.5 + 0.01 * (count % 7), 0.07 * (1 + observation.index)
        return Decision(v=v, omega=0.01 * (count % 3), hold=hold, memory=told)


class Hides:
    """Remembers what no file can keep."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return Decision(v=0.5, omega=0.0, hold=0.1, memory=[object()])


PARTS = {"controller": Counts(), "filters": [Ramp()], "disturbances": [Slip()]}


def robots_with(*controllers: dict[str, Any] | None) -> list[dict[str, Any]]:
    """Robots of `WORLD`, each with a controller of its own, or the world's."""
    robots = [one.model_dump(exclude_unset=True) for one in WORLD.robots]
    return [
        robot if own is None else {**robot, "controller": own}
        for robot, own in zip(robots, controllers, strict=True)
    ]


def at(step: int, world: physim.World = WORLD, **parts: Any) -> Simulation:
    simulation = Simulation(world, **parts)
    while simulation.step_number < step:
        simulation.step()
    return simulation


@pytest.mark.parametrize(("world", "parts"), [(TOUCHING, {}), (WORLD, {}), (WORLD, PARTS)])
def test_without_changes_its_record_is_the_end_of_the_original_s(
    world: physim.World, parts: dict[str, Any]
) -> None:
    with (
        physim.simulate(world, save=SaveAt(states=K * 0.01), **parts) as whole,
        record_run(at(K, world, **parts).branch()) as branch,
        physim.simulate(world, state=state_at(whole, K * 0.01), **parts) as again,
        physim.simulate(world, **parts) as plain,
    ):
        assert plain.digest() == whole.digest()
        assert whole.states["step"].tolist() == list(range(K, whole.steps_run + 1, K))
        assert branch.digest() == again.digest()
        assert (branch.begun_at, branch.begun, branch.steps_run) == (K, K * 0.01, whole.steps_run)
        assert branch.time[0] == whole.time[K]
        for name in ("steps", "pose", "clearance", "boundary_clearance", "course"):
            np.testing.assert_array_equal(getattr(branch, name), getattr(whole, name)[K:])
        for name in ("updates", "considered", "contacts", "false_contacts"):
            rows = getattr(whole, name)
            rows = rows[rows["step"] >= K]
            if name == "contacts":  # what ended in the step before is not of the branch
                rows = rows[(rows["step"] > K) | (rows["phase"] != physim.Phase.ENDED)]
            assert getattr(branch, name).tobytes() == rows.tobytes()
        for stage in ("nominal", "filtered", "applied"):
            both = (one.commands_over(stage, K, whole.steps_run) for one in (branch, whole))
            np.testing.assert_array_equal(*both)


@pytest.mark.parametrize(("world", "every"), [(TOUCHING, 1), (WORLD, 3)])
def test_its_record_is_simulated_again_from_the_state_that_it_keeps(
    tmp_path: Path, world: physim.World, every: int
) -> None:
    path = tmp_path / "branch.h5"
    record_run(at(K, world), path=path, save=SaveAt(every=every)).close()
    with Record.load(path) as record:
        assert record.steps[:3].tolist() == ([K, 101, 102] if every == 1 else [K, 102, 105])
        assert record.states["step"].tolist() == [K]
    done = said("validate", str(path))
    if every == 1:
        assert "Simulated again: the same run, bit for bit" in " ".join(done.out.split())
    assert "DISAGREEMENTS: none" in done.out
    assert ("CONTACTS: none" in done.out) == (world is WORLD)


def test_what_no_record_can_keep_is_named_and_not_simulated_again() -> None:
    with pytest.raises(PhysimError, match=facts("state.memory", "object", "arrays")):
        physim.simulate(WORLD, controller=Hides(), save=SaveAt(states=1.0))
    with record_run(at(K, controller=Hides())) as record:
        assert not len(record.states)
        with pytest.raises(PhysimError, match=facts("cannot be simulated again", "no states")):
            rerun(record, controller=Hides())
        assert not judge(record, None, "it was not kept").unexplained


def test_another_controller_takes_over_and_the_rest_is_kept() -> None:
    simulation = at(K, **PARTS)
    with pytest.warns(UserWarning, match="not used by"):
        branch = simulation.branch(controller="path_following")
    assert branch.step_number == K
    assert branch.next_decision.tolist() == [K] * 3
    for name in ("pose", "command", "velocity"):
        np.testing.assert_array_equal(getattr(branch, name), getattr(simulation, name))
    np.testing.assert_array_equal(branch.state.stages[1][0], simulation.state.stages[1][0])
    with record_run(branch) as record:
        assert record.setup.controller.name == "path_following"
        assert np.unique(record.updates["robot"][record.updates["step"] == K]).tolist() == [0, 1, 2]
    assert simulation.step_number == K  # the original stays where it is
    same = simulation.branch(time={"duration": 9})
    assert same.scene.steps == 900
    assert same.memory["memory"].tolist() == simulation.memory["memory"].tolist()
    new = at(K).branch(controller={"time_low": 1.0, "time_high": 2.0})
    assert new.next_decision.tolist() == [K] * 3


@pytest.mark.parametrize(
    ("before", "after", "anew"),
    [
        ((None, None, None), (None, None, AGAINST), [2]),
        ((None, None, AGAINST), (None, None, None), [2]),
        ((None, AGAINST, AGAINST), (AGAINST, None, AGAINST), [0, 1]),
        ((None, AGAINST, {"type": "constant", "v": 0.2}), (None, AGAINST, AGAINST), [2]),
        (
            ({"type": "constant", "v": 0.2}, AGAINST, None),
            ({"type": "constant"}, AGAINST, None),
            [0],
        ),
    ],
)
def test_robots_whose_controller_is_changed_begin_anew_alone(
    before: Any, after: Any, anew: list[int]
) -> None:
    """Others remember; with the old controllers again they go on as if nothing had been."""
    step = 103  # where not everybody is due
    simulation = at(step, WORLD.changed(robots=robots_with(*before)))
    branch = simulation.branch(robots=robots_with(*after))
    due, modes = simulation.next_decision.copy(), [one.name for one in branch.declared.modes]
    due[anew] = step
    assert branch.next_decision.tolist() == due.tolist()
    for i in range(3):
        if i in anew:
            assert branch.mode[i] == -1
        elif simulation.mode[i] >= 0:
            assert modes[branch.mode[i]] == simulation.declared.modes[simulation.mode[i]].name
    record_run(branch).close()
    twin = simulation.branch()
    for _ in range(40):
        simulation.step()
        twin.step()
        assert np.array_equal(simulation.pose, twin.pose)


def test_a_member_goes_on_bit_for_bit_beside_one_that_is_changed() -> None:
    """Far apart, and each for itself: what one robot does hangs on its own controller alone."""
    robots = robots_with(AGAINST, AGAINST, {"type": "constant", "v": 0.2})
    simulation = at(K, WORLD.changed(robots=robots))
    robots[2]["controller"] = {"type": "constant", "v": 0.1}
    branch = simulation.branch(robots=robots)
    for _ in range(60):
        simulation.step()
        branch.step()
    assert np.array_equal(simulation.command[:2], branch.command[:2])
    assert simulation.command[2, 0] == 2.0 * branch.command[2, 0]


def test_stages_of_a_branch_may_be_objects() -> None:
    ramp, slip = Ramp(), Slip()
    simulation = at(K, filters=[ramp], disturbances=[slip])
    other = Ramp(0.03)
    branch = simulation.branch(filters=[other, ramp])
    assert branch.parts.of(FILTER) == (other, ramp)
    known = simulation.state.stages[1][0]
    new, kept = branch.state.stages[1]
    assert np.array_equal(kept, known)
    assert not np.array_equal(new, known)
    assert branch.parts.of(DISTURBANCE) == (slip,)
    assert simulation.branch(filters=[]).parts.of(FILTER) == ()
    assert branch.branch(sensing={"range": 9.0}).parts.of(FILTER) == (other, ramp)
    with pytest.raises(PhysimError, match=facts("filter", "int", "method")):
        simulation.branch(filters=[3])


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"seed": 4}, "seed"),
        ({"physics": {"friction": 0.3}}, "physics"),
        ({"corridor": {"width": 6.0}}, "corridor"),
        ({"time": {"step": 0.02}}, "time.step"),
        ({"robots": WORLD.robots[:2]}, "robots.2"),
        (
            {"robots": [{**robot, "mass": 99.0} for robot in robots_with(*[AGAINST] * 3)]},
            "robots.0",
        ),
    ],
)
def test_what_moves_or_reshapes_bodies_is_refused(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(PhysimError, match=facts(f"branch: {key}", "mid-run", "allowed", "filters")):
        at(3).branch(**changes)


def test_a_state_of_another_controller_or_other_settings_is_refused() -> None:
    state = at(3).state
    for other in (TOUCHING, WORLD.changed(controller={"horizon": 5.0})):
        with pytest.raises(PhysimError, match="the state is of a run"):
            physim.simulate(other, state=state)


def test_films_and_plots_begin_where_the_record_does(tmp_path: Path) -> None:
    path = tmp_path / "branch.h5"
    with record_run(at(K), path=path) as record:
        figures = physim.summarise(record).run
        assert figures.formation_errors is None or len(figures.formation_errors) == record.samples
        made = physim.plots.draw(record, tmp_path, only=["modes", "speeds", "distances"])
        assert len(made) == 3
        assert physim.render(record, tmp_path / "film.mp4", fps=10.0, speed=1.0) == 20 + 1 + 15
        with pytest.raises(PhysimError, match=facts("0.5 s is outside the run", "from 1 to 3 s")):
            physim.video.still(record, tmp_path / "still.png", 0.5)


def test_the_command_goes_on_from_a_kept_state(tmp_path: Path) -> None:
    kept, out = tmp_path / "kept", tmp_path / "out"
    few = ("--no-video", "--quiet")
    begun = "run", "three_robots", "--set", "time.duration=2", "--keep-states", "1"
    assert said(*begun, "-o", str(kept), *few).code in (0, 1)
    with Record.load(kept / "record.h5") as record:
        assert record.states["step"].tolist() == [100, 200]
        with pytest.raises(RecordError, match=facts("no state at 1.2 s", "nearest: 1 s")):
            state_at(record, 1.2)
    begin = "run", str(kept / "record.h5"), "-o", str(out), *few, "--force", "--from"
    assert said(*begin, "1", "--set", "robots.1.controller.type=path_following").code in (0, 1)
    assert said(*begin, "1", "--controller", "path_following").code in (0, 1)
    with Record.load(out / "record.h5") as record:
        assert (record.begun, record.setup.controller.name) == (1.0, "path_following")
    for wrong, told in (
        (("1", "--seed", "4"), "seed is"), (("1", "--set", "physics.friction=1"), "friction"),
        (("1.5",), "nearest: "),
    ):  # fmt: skip
        done = said(*begin, *wrong)
        assert (done.code, told in done.err) == (2, True)
    assert "three_robots: no such file" in said("run", "three_robots", "--from", "1").err


def test_states_are_kept_only_where_asked_for() -> None:
    with (
        physim.simulate(WORLD.changed(time={"duration": 0.1})) as record,
        pytest.raises(RecordError, match=facts("no states were kept", "--keep-states")),
    ):
        state_at(record, 0.05)
    for wrong in (0.0, -1.0, float("inf")):
        with pytest.raises(ValueError, match="states = "):
            SaveAt(states=wrong)


@pytest.mark.parametrize(
    ("name", "forge"),
    [
        ("now", lambda s: {"now": None}),
        ("now.pose", lambda s: {"now": s.now._replace(pose=s.now.pose[:2])}),
        ("now.pose", lambda s: {"now": s.now._replace(pose=np.nan * s.now.pose)}),
        ("mode", lambda s: {"mode": s.mode.astype(float)}),
        ("memory", lambda s: {"memory": {}}),
        ("memory.plan", lambda s: {"memory": {**s.memory, "plan": s.memory["plan"][:1]}}),
        ("stages", lambda s: {"stages": (1, 2, 3)}),
        ("trail", lambda s: {"trail": s.trail[:1]}),
        ("physics", lambda s: {"physics": 3}),
    ],
)
def test_a_state_of_another_form_is_refused(name: str, forge: Any) -> None:
    simulation = Simulation(WORLD)
    simulation.step()
    state = simulation.state
    simulation.restore(replace(state))
    with pytest.raises(PhysimError, match=f"damaged: {name} "):
        simulation.restore(replace(state, **forge(state)))
    assert simulation.step_number == 1  # it stands where it stood
