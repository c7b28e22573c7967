"""Branches: a run goes on from any sample, with a record that begins there.

Where nothing was changed, the record of the branch is the end of the original's, bit for bit.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim import Decision, Observation, PhysimError, Record, SaveAt, Simulation, record_run
from tests.analysis.forgeries.parts import Ramp, Slip
from tests.helpers import facts, inside, said
from tests.helpers.extending import of

judge, rerun = inside("physim.analysis", "judge", "rerun")

AGAINST = {"type": "path_following"}
WORLD = physim.load_world("three_robots", overrides=["time.duration=3"])
TOUCHING = WORLD.changed(controller=AGAINST)
"""Robots touch from 0.83 s to 1.42 s."""
K = 100


class Counts:
    """Decides at a step of its own, by what it remembers."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        count = (memory or 0) + 1
        hold = 0.07 * (1 + observation.index)
        return Decision(
            v=0.5 + 0.01 * (count % 7), omega=0.01 * (count % 3), hold=hold, memory=count
        )


class Hides:
    """Remembers what no file can keep."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return Decision(v=0.5, omega=0.0, hold=0.1, memory=[object()])


PARTS = {"controller": Counts(), "filters": [Ramp()], "disturbances": [Slip()]}


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
        physim.simulate(world, state=physim.state_at(whole, K * 0.01), **parts) as again,
    ):
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
        assert "Simulated again: the same run to the bit" in " ".join(done.out.split())
    assert "DISAGREEMENTS: none" in done.out
    assert ("CONTACTS: none" in done.out) == (world is WORLD)


def test_what_no_record_can_keep_is_not_simulated_again() -> None:
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
    ("changes", "key"),
    [
        ({"seed": 4}, "seed"),
        ({"physics": {"friction": 0.3}}, "physics.friction"),
        ({"time": {"step": 0.02}}, "time.step"),
        ({"robots": WORLD.robots[:2]}, "robots.2"),
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
    said(
        "run",
        "three_robots",
        "--set",
        "time.duration=2",
        "--keep-states",
        "1",
        "-o",
        str(kept),
        *few,
    )
    begin = "run", str(kept / "record.h5"), "-o", str(out), *few, "--force", "--from"
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


def test_the_page_s_branch_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = [one.text for one in of("py") if one.section == "A branch"]
    monkeypatch.chdir(tmp_path)
    code = code.replace('"ten_robots"', '"ten_robots", overrides=["time.duration=1"]')
    with pytest.warns(UserWarning, match="not used by"):
        exec(code.replace("60.0", "0.5"), {})
    commands = [
        line for one in of("console") for line in re.findall(r"^\$ physim (.*)", one.text, re.M)
    ]
    assert said(*commands[0].split()[:3], "--at", "0.8", "-o", "both.png").code == 0
    for name in ("as_it_was", "path_following"):
        with Record.load(f"{name}.h5") as record:
            assert record.begun == 0.5
