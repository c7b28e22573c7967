"""Disturbances in a run: of no strength they are off; bad settings are told with their place."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import physim
from tests.helpers import said

OFF = (
    {"type": "actuation"},
    {"type": "actuation", "v": {"gain": 1.0, "noise": 0.0}, "correlation": 2.0, "delay": 0},
    {"type": "breakdown", "rate": 0.0},
    {"type": "breakdown", "at": 1.0, "probability": 0.0},
    {"type": "breakdown", "at": [1.0, 2.0], "lasts": 0.0, "then": "runs_on"},
)
EVERY = {"gain_spread": 0.1, "bias_spread": 0.02, "noise": 0.05}
ON = (
    {"type": "actuation", "v": EVERY, "omega": EVERY, "slip": 0.1, "delay": 3},
    {"type": "breakdown", "rate": 0.2, "lasts": 0.5, "then": "runs_on"},
)


def world(*disturbances: object, seconds: float = 6.0) -> physim.World:
    small = physim.load_world("three_robots")
    return small.changed(disturbances=disturbances, time={"duration": seconds})


@pytest.mark.parametrize("off", OFF, ids=repr)
def test_of_no_strength_it_is_off_to_the_bit(off: dict[str, object]) -> None:
    plain, one = physim.simulate(world()), physim.simulate(world(off))
    for name in ("pose", "updates", "commands", "others"):
        assert getattr(one, name).tobytes() == getattr(plain, name).tobytes(), name


def test_more_of_them_change_no_draw_of_the_first() -> None:
    def applied(*which: object) -> np.ndarray:
        simulation = physim.Simulation(world(*which))
        found = []
        for _ in range(100):
            simulation.step(np.full((3, 2), 0.5))
            found.append(simulation.last.applied)
        return np.stack(found)

    alone, after = applied(ON[0]), applied(ON[0], {"type": "breakdown", "at": 0.5})
    assert (alone[:50] == after[:50]).all()
    assert (after[50:] == 0.0).all()


def test_a_copy_and_a_kept_state_go_on_alike() -> None:
    whole = physim.simulate(world(*ON), save=physim.SaveAt(states=1.0))
    state = physim.state_at(whole, 2.0)
    rest = physim.record_run(physim.Simulation(whole.world, state=state))
    simulation = physim.Simulation(world(*ON))
    simulation.step(steps=200)
    copied = physim.record_run(pickle.loads(pickle.dumps(simulation)))
    for one in (rest, copied):
        assert one.pose.tobytes() == whole.pose[200:].tobytes()


BAD = {
    "{type: actuation, v: {noise: -0.1}}": ("noise: -0.1", "v.noise", "at least 0", "-0.1"),
    "{type: actuation, delay: 600}": ("600", "delay", "600 steps", "at most 599"),
    "{type: actuation, robots: [r1, r9]}": ("r9", "robots[1]", '"r9"', "r1, r2, r3"),
    "{type: breakdown, at: [4, 2]}": ("2]", "at[1]", "2 s", "after", "4 s"),
    "{type: breakdown, at: 60}": ("60", "disturbances[0].at: ", "60 s", "6 s"),
    "{type: breakdown}": ("{", "disturbances[0]", "neither at nor rate"),
    "{type: breakdown, at: 1, then: stand}": ("stand}", "then", "stands or runs_on", '"stand"'),
}


@pytest.mark.parametrize("entry", BAD)
def test_bad_settings_are_told_with_their_place(entry: str, tmp_path: Path) -> None:
    mark, *words = BAD[entry]
    line, file = f"disturbances: [{entry}]", tmp_path / "bad.yaml"
    lines = [one for one in world().to_yaml().splitlines() if "disturbances" not in one]
    file.write_text("\n".join([*lines, line]))
    column = line.index(mark if mark[0] in "{" else mark.removeprefix("noise: ")) + 1
    done = said("check", str(file))
    assert done.code == 2
    (told,) = [one for one in done.out.splitlines() if "disturbances[0]" in one]
    assert f"{file}:{len(lines) + 1}:{column}: " in told
    for word in words:
        assert word in told
