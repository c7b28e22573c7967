"""Sensing stages: what each does, within sampling error; and that nobody's look changes a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import physim
from physim import Sensed, Simulation, Snapshot
from tests.helpers import examples, road, said

SURE = 4.5
"""Standard errors: a sound estimate is farther off once in 150,000"""
TIMID = {"type": "noise", "position": 0.02, "heading": 0.01, "bias": [0.01, 0.0]}
ON: list[dict[str, Any]] = [
    {**TIMID, "correlation": 0.3},
    {"type": "delay", "seconds": 0.05},
    {"type": "field_of_view", "angle": 4.0},
    {"type": "occlusion"},
    {"type": "missed", "probability": 0.1, "burst": 3.0},
    {"type": "messages", "probability": 0.2, "burst": 4.0, "delay": 0.03},
]


def crowd(robots: int, *stages: object, **more: Any) -> Simulation:
    """Robots in a square grid, 4 m apart, that all see one another and are told of all."""
    side = int(np.ceil(np.sqrt(robots)))
    poses = [[40.0 + 4.0 * (k // side), 4.0 * (k % side) - 14.0, 0.1 * k] for k in range(robots)]
    more.setdefault("sensing", {"range": 200.0, "stages": stages})
    return Simulation(road(poses, formation=ALL, duration=500.0, **more), seed=3)


def looked(simulation: Simulation, steps: int, v: float = 0.0) -> Iterator[tuple[Snapshot, Sensed]]:
    """Truth and what all know of it, at so many samples."""
    for _ in range(steps):
        yield simulation.now, simulation.view.sensed
        simulation.step(np.full((simulation.scene.robots, 2), (v, 0.3 * v)))


def others(sensed: Sensed) -> Any:
    """Rows of others, as a mask, and their observers."""
    who = physim.observer_of_row(sensed)
    return who != sensed.robot, who


# Noise


@pytest.mark.parametrize(("of", "own"), [("others", 0.0), ("own", 1.0)])
def test_noise_has_its_mean_and_deviation(of: str, own: float) -> None:
    noise = {
        "type": "noise", "position": 0.3, "heading": 0.1, "bias": [0.05, -0.02],
        "heading_bias": 0.04, "of": of,
    }  # fmt: skip
    errors = []
    for truth, sensed in looked(crowd(12, noise), 200):
        other, who = others(sensed)
        rows = ~other if own else other
        error = sensed.pose - truth.pose[sensed.robot]
        assert (error[~rows] == 0.0).all()
        c, s = np.cos(truth.pose[who, 2]), np.sin(truth.pose[who, 2])
        x, y, turn = error.T
        errors.append(np.column_stack((c * x + s * y, c * y - s * x, turn))[rows])
    found = np.concatenate(errors)
    wanted = np.array([0.3, 0.3, 0.1])
    many = np.sqrt(len(found))
    assert (np.abs(found.mean(axis=0) - (0.05, -0.02, 0.04)) < SURE * wanted / many).all()
    assert (np.abs(found.std(axis=0) - wanted) < SURE * wanted / many / np.sqrt(2.0)).all()
    assert (np.abs(np.corrcoef(found.T) - np.eye(3)) < SURE / many).all()
    steps = found.reshape(200, -1)
    assert abs(np.corrcoef(steps[0], steps[1])[0, 1]) < SURE / np.sqrt(steps.shape[1])


def test_noise_is_correlated_as_told_and_of_one_deviation() -> None:
    noise = {"type": "noise", "position": 0.2, "correlation": 0.1, "of": "others"}
    errors = []
    for truth, sensed in looked(crowd(50, noise), 31):
        other, _ = others(sensed)
        errors.append((sensed.pose - truth.pose[sensed.robot])[other, :2].ravel())
    error = np.stack(errors)
    sure = SURE / np.sqrt(error.shape[1])
    assert (np.abs(error.std(axis=1) - 0.2) < 0.2 * sure).all()

    def weights(step: int) -> np.ndarray:
        knot, u = divmod(step, 10)
        one = np.zeros(6)
        one[knot], one[knot + 1] = 1.0 - u / 10, u / 10
        return one / np.hypot(*one[knot : knot + 2])

    for a in range(0, 31, 3):
        for b in range(a, 31, 4):
            wanted = weights(a) @ weights(b)
            assert abs(np.corrcoef(error[a], error[b])[0, 1] - wanted) < sure, (a, b)


def test_what_a_robot_believes_of_itself_is_what_it_tells() -> None:
    noise = {"type": "noise", "position": 0.2, "of": "own"}
    for truth, sensed in looked(crowd(4, noise), 20, 1.0):
        other, who = others(sensed)
        believed = dict(zip(who[~other], np.flatnonzero(~other), strict=True))
        for row in np.flatnonzero(other):
            mine = believed[sensed.robot[row]]
            assert sensed.reference_station[row] == sensed.reference_station[mine]
            assert (sensed.pose[row] == truth.pose[sensed.robot[row]]).all()
        for i, row in believed.items():  # the road is straight, along x
            off = sensed.pose[row, 0] - truth.pose[i, 0]
            assert sensed.station[i] - truth.station[i] == pytest.approx(off, abs=1e-9)


# Delay


@pytest.mark.parametrize(
    "late", [{"steps": 1}, {"steps": 7}, {"seconds": 0.07}, {"steps": 7, "own": True}]
)
def test_a_delay_of_n_steps_is_n(late: dict[str, Any]) -> None:
    steps, past = late.get("steps", 7), []
    for truth, sensed in looked(crowd(3, {"type": "delay", **late}), 40, 1.0):
        past.append(truth)
        then, rows = past[max(0, len(past) - 1 - steps)], others(sensed)[0]
        if late.get("own"):
            assert (sensed.station == then.station).all()
            assert (sensed.reference_station == then.reference_station[sensed.robot]).all()
            rows = np.full(len(rows), True)
        else:
            assert (sensed.pose[~rows] == truth.pose[sensed.robot[~rows]]).all()
            assert (sensed.reference_station == truth.reference_station[sensed.robot]).all()
        for name in ("pose", "velocity"):
            assert (getattr(sensed, name)[rows] == getattr(then, name)[sensed.robot[rows]]).all()
        assert sensed.age[rows] == pytest.approx((truth.step - then.step) * 0.01)


# Losses


@pytest.mark.parametrize(("p", "burst"), [(0.3, None), (0.2, 6.0), (0.7, 5.0)])
@pytest.mark.parametrize("kind", ["missed", "messages"])
def test_losses_have_their_rate_and_bursts(kind: str, p: float, burst: float | None) -> None:
    stage = {"type": kind, "probability": p, "interval": 0.0}
    stage |= {} if burst is None else {"burst": burst}
    lost = []
    for _, sensed in looked(crowd(6, stage), 1500):
        other, _ = others(sensed)
        gone = sensed.heard > 0.0 if kind == "messages" else np.isnan(sensed.pose[:, 0])
        lost.append(gone[other])
    series = np.stack(lost)[1:]  # all know the start
    mean = 1.0 / (1.0 - p) if burst is None else burst
    stays = 1.0 - 1.0 / mean - p / (1.0 - p) / mean
    spread = np.sqrt(p * (1.0 - p) / series.size * (1.0 + stays) / (1.0 - stays))
    assert abs(series.mean() - p) < SURE * spread
    was, now = series[:-1], series[1:]
    ended = (was & ~now).sum() / was.sum()
    begun = (~was & now).sum() / (~was).sum()
    for found, wanted, many in (
        (ended, 1.0 / mean, was.sum()),
        (begun, p / (1.0 - p) / mean, (~was).sum()),
    ):
        assert abs(found - wanted) < SURE * np.sqrt(wanted * (1.0 - wanted) / many)


@pytest.mark.parametrize("late", [0.0, 0.05])
def test_the_last_message_heard_is_known_with_its_age(late: float) -> None:
    stage = {"type": "messages", "probability": 0.4, "interval": 0.03, "delay": late}
    past, ages = [], set()
    for truth, sensed in looked(crowd(3, stage), 200, 1.0):
        past.append(truth)
        other, _ = others(sensed)
        assert (sensed.heard[~other] == 0.0).all()
        assert (sensed.pose == truth.pose[sensed.robot]).all()
        for row in np.flatnonzero(other):
            then = past[truth.step - round(sensed.heard[row] / 0.01)]
            ages.add(truth.step - then.step)
            assert then.step % 3 == 0
            assert sensed.reference_station[row] == then.reference_station[sensed.robot[row]]
            assert (sensed.command[row] == then.command[sensed.robot[row]]).all()
    assert min(ages - {0, 1, 2, 3, 4}) == 5 if late else min(ages) == 0
    assert max(ages) > 12


def test_what_was_not_heard_for_long_is_taken_from_what_is_seen_or_not_known() -> None:
    stages = (
        {"type": "messages", "probability": 1.0, "keep": 0.2, "interval": 0.1},
        {"type": "field_of_view", "angle": 3.0},
    )
    for order in (stages, stages[::-1]):
        for truth, sensed in looked(crowd(6, *order), 40, 1.0):
            other, who = others(sensed)
            is_seen = ~np.isnan(sensed.pose[:, 0])
            if truth.step <= 20:
                assert len(sensed.robot) == 36
                assert not is_seen.all()
                continue
            assert len(sensed.robot) < 36
            assert is_seen.all()
            assert np.isinf(sensed.heard[other]).all()
            at = sensed.robot[other]
            assert sensed.reference_station[other] == pytest.approx(truth.pose[at, 0], abs=1e-9)
            assert sensed.command[other] == pytest.approx(
                np.full((len(at), 2), (1.0, 0.3)), abs=1e-2
            )
            told = np.bincount(who, minlength=6)
            assert (told == sensed.end - sensed.first).all()


# Sight


def test_a_field_of_view_hides_what_lies_outside() -> None:
    for truth, sensed in looked(crowd(16, {"type": "field_of_view", "angle": 2.0}), 30, 1.0):
        for row, i in enumerate(physim.observer_of_row(sensed)):
            dx, dy = (truth.pose[sensed.robot[row]] - truth.pose[i])[:2]
            towards = np.exp(1j * (np.arctan2(dy, dx) - truth.pose[i, 2]))
            inside = i == sensed.robot[row] or abs(np.angle(towards)) <= 1.0
            assert np.isnan(sensed.pose[row, 0]) != inside
            assert sensed.reference_station[row] == truth.reference_station[sensed.robot[row]]


@examples(6, deep=60)
@given(st.integers(0, 10**6))
def test_occlusion_is_that_of_shapely(seed: int) -> None:
    rng = np.random.default_rng(seed)
    boxes = []
    for x, y in rng.uniform((50.0, 1.3), (70.0, 12.0), (4, 2)):
        y *= rng.choice((-1.0, 1.0))
        a = rng.uniform(0.0, 6.0)
        ends = np.array([[-1.0, -0.2], [1.0, -0.2], [1.0, 0.2], [-1.0, 0.2]]) @ [
            [np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)],
        ]  # fmt: skip
        boxes.append((ends + (x, y)).tolist())
    poses = [[*rng.uniform((45.0, -15.0), (75.0, 15.0)), rng.uniform(0.0, 6.0)] for _ in range(9)]
    shape = shapely.union_all([shapely.Polygon(box) for box in boxes])
    poses = [one for one in poses if shapely.Point(one[:2]).distance(shape) > 1.5]
    poses = [
        one for k, one in enumerate(poses)
        if all(np.hypot(one[0] - x, one[1] - y) > 2.5 for x, y, _ in poses[:k])
    ]  # fmt: skip
    assert_hidden_as_by_shapely(Simulation(road(poses, obstacles=boxes, **BEHIND)))


@pytest.mark.parametrize("name", ["crossing", "roundabout", "ten_robots"])
def test_walls_hide_as_by_shapely(name: str) -> None:
    simulation = Simulation(physim.load_world(name).changed(**BEHIND))
    assert assert_hidden_as_by_shapely(simulation) > 0


ALL = {"gain": 0.05, "speed": 1.0, "limits": [0.8, 1.2], "neighbours": "all"}
BEHIND = {"sensing": {"range": 500.0, "stages": [{"type": "occlusion"}]}, "formation": ALL}


def assert_hidden_as_by_shapely(simulation: Simulation) -> int:
    """Hold what is not seen against lines of shapely's; how many are not seen."""
    layout, truth, sensed = simulation.scene.layout, simulation.now, simulation.view.sensed
    corners = [
        outline @ [[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]] + (x, y)
        for outline, (x, y, a) in zip(layout.footprints, truth.pose, strict=True)
    ]
    bodies = [shapely.Polygon(one) for one in corners]
    lines, solids = [one for _, one in layout.walls], [one for _, one in layout.solids]
    hidden = 0
    for row, i in enumerate(physim.observer_of_row(sensed)):
        j = int(sensed.robot[row])
        between = [*solids, *(b for k, b in enumerate(bodies) if k not in (i, j))]
        is_free = False
        for aim in (truth.pose[j, :2], *corners[j]):
            line = shapely.LineString([truth.pose[i, :2], aim])
            is_free |= not any(line.intersects(one) for one in lines) and all(
                line.intersection(one).length < 1e-9 for one in between
            )
        assert np.isnan(sensed.pose[row, 0]) == (i != j and not is_free), (i, j)
        hidden += int(i != j and not is_free)
    return hidden


# Together


OFF = (
    {"type": "noise", "correlation": 1.0},
    {"type": "delay", "own": True},
    {"type": "field_of_view"},
    {"type": "missed", "burst": 3.0},
    {"type": "messages", "interval": 0.5},
)


def small(stages: Sequence[object], **more: Any) -> physim.World:
    world = physim.load_world("three_robots")
    more = {"time": {"duration": 4.0}, "expect": None, **more}
    return world.changed(sensing={"stages": list(stages)}, **more)


@pytest.mark.parametrize("off", [*([one] for one in OFF), list(OFF)], ids=str)
def test_of_no_strength_they_are_off_to_the_bit(off: list[object]) -> None:
    plain, one = physim.simulate(small([])), physim.simulate(small(off))
    for name in ("pose", "updates", "commands", "others"):
        assert getattr(one, name).tobytes() == getattr(plain, name).tobytes(), name


class Looks:
    """Somebody who looks at what all robots know, at every third sample."""

    def start(self, simulation: Simulation) -> None:
        self.simulation = simulation

    def after_step(self, step: physim.Step) -> None:
        if step.truth.step % 3 == 0:
            _ = self.simulation.observe(1).others

    def close(self, ended: str) -> None: ...


@pytest.mark.parametrize("stages", [*([one] for one in ON), ON, ON[::-1]], ids=str)
def test_who_looks_changes_nothing(stages: list[object]) -> None:
    world = small(stages)
    alone = physim.simulate(world)
    seen = physim.simulate(world, observers=[Looks()])
    assert alone.digest() == seen.digest()

    class Passes:
        """A filter, which sees what all robots know at every step."""

        def start(self, scene: Any) -> None: ...

        def filter(self, scene: Any, sensed: Sensed, nominal: Any, state: Any) -> Any:
            assert (sensed.end > sensed.first).all()
            return nominal, state

    assert physim.simulate(world, filters=[Passes()]).pose.tobytes() == alone.pose.tobytes()


@pytest.mark.parametrize("stages", [ON, ON[::-1]], ids=["in order", "reversed"])
def test_a_branch_of_nothing_and_a_kept_state_go_on_alike(stages: list[object]) -> None:
    simulation = Simulation(small(stages))
    simulation.step(steps=137)
    other, third = simulation.branch(), Simulation(small(stages), state=simulation.state)
    for one in (simulation, other, third):
        one.step(steps=150)
    assert simulation.pose.tobytes() == other.pose.tobytes() == third.pose.tobytes()


@pytest.mark.parametrize("stage", ON, ids=lambda one: str(one["type"]))
def test_one_more_robot_or_stage_changes_no_draw(stage: dict[str, Any]) -> None:
    def found(robots: int, *more: object) -> list[np.ndarray]:
        rows = []
        for _, sensed in looked(crowd(robots, *more, stage), 60):
            who = physim.observer_of_row(sensed)
            kept = (who < 5) & (sensed.robot < 5)
            rows.append(np.column_stack((sensed.pose, sensed.heard, sensed.age))[kept])
        return rows

    alone = found(5)
    if stage["type"] != "occlusion":  # the sixth stands in the way
        assert all(
            np.array_equal(a, b, equal_nan=True) for a, b in zip(alone, found(6), strict=True)
        )
    after = found(5, {"type": "missed", "probability": 1e-9, "stream": 9})
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(alone, after, strict=True))


def test_a_mover_that_is_not_seen_has_no_row() -> None:
    cart = {
        "name": "cart", "footprint": {"length": 1.0, "width": 1.0}, "speed": 0.5,
        "waypoints": [[40.0, 10.0], [60.0, 10.0]], "repeat": "to_and_fro",
    }  # fmt: skip
    stages = [
        {"type": "noise", "position": 0.3, "of": "others"},
        {"type": "missed", "probability": 0.5, "interval": 0.0},
        {"type": "messages", "probability": 1.0},
    ]
    simulation = crowd(4, movers=[cart], sensing={"range": 200.0, "stages": stages})
    seen = []
    for truth, sensed in looked(simulation, 60):
        rows = sensed.robot == 4
        seen.append(rows.sum())
        assert np.isfinite(sensed.pose[rows]).all()
        assert (np.abs(sensed.pose[rows] - truth.moving_pose[4])[:, 0] > 0.0).all()
        assert sensed.reference_station[rows] == pytest.approx(sensed.pose[rows, 0], abs=1e-9)
        assert (sensed.command[rows] == 0.0).all()
    assert 80 < np.sum(seen) < 160


# Bad input


def test_faults_and_doubts_stand_at_their_keys(tmp_path: Path) -> None:
    text = physim.load_world("straight").to_yaml()
    for stage, line, told in (
        ("{type: delay, seconds: 90.0}", "seconds", "not shorter than the run"),
        ("{type: delay, seconds: 0.1, steps: 3}", "", "write one of them"),
        ("{type: messages, delay: 40.0, keep: 99.0}", "delay", "not shorter than the run"),
        ("{type: messages, delay: 9.0}", "", "forgotten"),
        ("{type: noise, position: -0.1}", "position", "at least 0"),
        ("{type: missed, probability: 0.9, burst: 2.0}", "", "10"),
        ("{type: noise, position: 0.2, of: others}", "position", "mode_switching.distance_low"),
        ("{type: noise, position: 0.06, of: own}", "position", "mode_switching.boundary_low"),
        ("{type: noise, position: 0.03, of: own}", "position", "0.1 m of arrival.tolerance"),
    ):
        file = tmp_path / "world.yaml"
        file.write_text(f"{text}\nsensing:\n  stages:\n    - {stage}\n")
        row = file.read_text().splitlines().index(f"    - {stage}") + 1
        column = 7 + (stage.index(line) + len(line) + 2 if line else 0)
        found = said("check", str(file))
        is_doubt = "mode_switching" in told or "arrival" in told
        assert found.code == (0 if is_doubt else 2)
        (message,) = [one for one in (found.out + found.err).splitlines() if told in one]
        assert f"world.yaml:{row}:{column}" in message, message
