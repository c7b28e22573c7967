"""States that a record keeps: another run starts from one and goes on bit for bit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim import RecordError, SaveAt, Simulation, simulate, state_at
from tests.analysis.forgeries.parts import Ramp, Slip
from tests.helpers import facts, said

WORLD = physim.load_world("three_robots", overrides=["time.duration=3"])


class Counts:
    """Remembers how often it decided, and where it was, and turns by it."""

    def decide(self, observation: physim.Observation, memory: Any) -> physim.Decision:
        count, places = (memory["count"], memory["places"]) if memory else (0, ())
        here = np.array(observation.pose)
        told = {"count": count + 1, "places": (*places[-3:], here)}
        return physim.Decision(v=0.5, omega=0.01 * (count % 3), hold=0.1, memory=told)


@pytest.mark.parametrize(
    "parts", [{}, {"controller": Counts(), "filters": [Ramp()], "disturbances": [Slip()]}]
)
def test_a_run_goes_on_from_a_kept_state_bit_for_bit(tmp_path: Path, parts: dict[str, Any]) -> None:
    path = tmp_path / "r.h5"
    with simulate(WORLD, save=SaveAt(states=0.5), path=path, **parts) as record:
        digest = record.digest()
    with physim.Record.load(path) as record:
        kept = (record.states["step"] * record.dt).tolist()
        assert kept == pytest.approx(np.arange(0.5, record.time[-1] + 1e-9, 0.5).tolist())
        other = Simulation(WORLD, state=state_at(record, 1.5), **parts)
        assert other.time == 1.5
        while other.step_number < record.steps_run:
            other.step()
        np.testing.assert_array_equal(other.pose, record.pose[-1])
        with pytest.raises(RecordError, match=facts("no state at 1.2 s", "nearest: 1 s")):
            state_at(record, 1.2)
    with simulate(WORLD, **parts) as without:
        assert without.digest() == digest
        with pytest.raises(RecordError, match=facts("no states were kept", "--keep-states")):
            state_at(without, 1.0)


class Hides:
    """Remembers what no file can keep."""

    def decide(self, observation: physim.Observation, memory: Any) -> physim.Decision:
        return physim.Decision(v=0.5, omega=0.0, hold=0.1, memory=[object()])


def test_what_no_record_can_keep_is_named() -> None:
    with pytest.raises(physim.PhysimError, match=facts("state.memory", "object", "arrays")):
        simulate(WORLD, controller=Hides(), save=SaveAt(states=1.0))
    for wrong in (0.0, -1.0, float("inf")):
        with pytest.raises(ValueError, match="states = "):
            SaveAt(states=wrong)


def test_the_command_keeps_states(tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = said(
        "run", "three_robots", "--set", "time.duration=1", "--keep-states", "0.25", "--no-video",
        "-o", str(out),
    )  # fmt: skip
    assert done.code in (0, 1)
    with physim.Record.load(out / "record.h5") as record:
        assert record.states["step"].tolist() == [25, 50, 75, 100]
        state = state_at(record, 0.5)
        assert Simulation(record.world, state=state).time == 0.5


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
    with pytest.raises(physim.PhysimError, match=f"damaged: {name} "):
        simulation.restore(replace(state, **forge(state)))
    assert simulation.step_number == 1  # it stands where it stood
