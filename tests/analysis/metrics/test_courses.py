"""Courses over time and along paths: speeds, deviations, modes, distances, width."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

import physim
from physim.analysis import metrics
from physim.record import Record, RecordWriter
from tests.analysis.metrics.histories import THERE, beside_paths, history, mean_squares
from tests.analysis.validation.runs import LANE, Drivers
from tests.helpers import inside
from tests.helpers.records import CENTRELINE, WIDTH, make_record, make_scene

sides_of = inside("physim.analysis.metrics", "sides_of")
pair_collision_times = inside("physim.analysis.metrics", "pair_collision_times")
shortest_pair_collision_time = inside("physim.analysis.metrics", "shortest_pair_collision_time")
FloatArray = inside("physim.geometry", "FloatArray")
offset_polyline = inside("physim.world.ground", "offset_polyline")
pack_parts, pack_polylines = inside("physim.geometry", "pack_parts", "pack_polylines")
Body = inside("physim.world", "Body")


def arcs(v: FloatArray, omega: FloatArray, samples: int, dt: float = 0.01) -> FloatArray:
    """Poses (K, N, 3) on exact arcs from the origin, (1)."""
    angle = omega * dt * np.arange(samples)[:, None]
    radius = v / omega
    return np.stack([radius * np.sin(angle), radius * (1 - np.cos(angle)), angle], axis=-1)


def test_averaged_speeds_of_arcs_are_their_own() -> None:
    v, omega = np.array([0.9, -0.4]), np.array([0.5, -1.5])
    record = history(pose=arcs(v, omega, 2001), steps_run=2000)
    found = metrics.averaged_speeds(record)
    assert found.time[[0, -1]] == pytest.approx([5.0, 15.0])
    assert np.allclose(found.forward, v, rtol=0, atol=1e-12)
    assert np.allclose(found.rotational, omega, rtol=0, atol=1e-12)


def test_a_window_reaches_neither_beyond_the_run_nor_beyond_arrival() -> None:
    pose = np.zeros((1501, 2, 3))
    pose[:, :, 0] = np.minimum(0.01 * np.arange(1501), 12.0)[:, None] * [1.0, 0.5]
    scene = make_scene(2)
    pose[:, :, 1] = scene.paths.points[scene.paths.start[:-1], 1]
    stops = np.array([12.1 - 5e-3, 50.0])  # less the tolerance
    found = metrics.averaged_speeds(history(pose=pose, steps_run=1500, stops=stops))
    assert found.time[-1] == pytest.approx(10.0)
    before = found.time <= 7.0 + 1e-9
    assert np.allclose(found.forward[before, 0], 1.0)
    assert np.isnan(found.forward[~before, 0]).all()
    assert found.forward[-1, 1] == pytest.approx(0.5 * 7.0 / 10.0)


def test_runs_shorter_than_the_window_and_samples_farther_apart_have_no_averaged_speed() -> None:
    record = history(pose=arcs(np.ones(2), np.ones(2), 900), steps_run=899)
    assert len(metrics.averaged_speeds(record).time) == 0
    assert "averaged_speed_max" not in metrics.measure(record)
    world = physim.parse_world(LANE, overrides=["time.duration=20.0", "time.record_every=1100"])
    with physim.simulate(world, controller=Drivers((1.0, 0.8), (0.5, -0.9))) as record:
        assert len(metrics.averaged_speeds(record).time) == 0


def test_deviations_and_their_root_mean_square() -> None:
    """Of all samples, though nobody decides after the first, and linear between them."""
    course = np.array([[1.0, 0.0], [1.0, 0.5], [-3.0, 0.5], [-1.0, 0.0], [2.0, 0.25]])
    rows = [{"robot": 0, "deviation": 7.0, "next_step": 4}]
    record = history(rows, steps_run=4, pose=beside_paths(course))
    time, values = metrics.deviations(record, every=0.005)
    assert np.allclose(values[::2], course, rtol=0.0, atol=1e-12)
    assert values[1, 1] == pytest.approx(0.25)
    assert time[-1] == pytest.approx(0.04)
    assert metrics.deviation_peak(record) == metrics.Moment(pytest.approx(-3.0), 2, 0.02, 0)
    rms = metrics.Figures(record).metric("deviation_rms")
    assert rms is not None
    exact = mean_squares(course)
    assert rms.robots == pytest.approx(np.sqrt(exact), rel=1e-6)
    assert rms.value == pytest.approx(np.sqrt(exact.mean()), rel=1e-6)


def test_a_robot_at_its_stop_no_longer_counts_for_the_root_mean_square_but_for_the_peak() -> None:
    course = np.array([[1.0], [1.0], [1.0], [4.0], [4.0], [4.0]])
    pose = beside_paths(course)
    pose[3:, :, 0] += 0.1
    record = history(robots=1, steps_run=5, pose=pose, stops=np.array([6.15]))
    rms, peak = metrics.Figures(record).metric("deviation_rms"), metrics.deviation_peak(record)
    assert rms is not None
    assert rms.value == pytest.approx(np.sqrt(mean_squares(course[:4]).item()), rel=1e-6)
    assert peak is not None
    assert peak.value == pytest.approx(4.0)


@pytest.mark.parametrize("every", [20, 500])
def test_figures_of_a_coarse_record_are_those_of_a_fine_one(every: int) -> None:
    """Samples stay away from standing at the stop, and from the curve between them."""
    world = physim.load_world("u_turn")
    coarse = world.changed(time={"record_every": every})
    with physim.simulate(world) as fine, physim.simulate(coarse) as few:
        ends = [metrics.Figures(one).active_steps for one in (few, fine)]
        assert np.abs(ends[0] - ends[1]).max() <= 1
        exact, found = (metrics.measure(record) for record in (fine, few))
        for name in ("mean_speed", "averaged_speed_min", "averaged_speed_max"):
            within = 1e-3 if every == 20 or name == "mean_speed" else 0.05
            assert found[name].value == pytest.approx(exact[name].value, abs=within), name
        one, other = (v["deviation_rms"].value for v in (exact, found))
        assert other == pytest.approx(one, rel=1e-3 if every == 20 else 0.3)


def test_modes_fill_the_run_and_switches_are_counted() -> None:
    told = [(0, 0, 0), (10, 0, 1), (20, 0, 2), (30, 0, 0), (60, 0, 3), (0, 1, 2)]
    rows = [{"step": s, "robot": r, "mode": m, "next_step": s + 10} for s, r, m in told]
    rows[3]["next_step"], rows[5]["next_step"] = 60, 100
    rows[4]["station"] = THERE
    record = history(rows, steps_run=100)
    spans = metrics.mode_spans(record)
    assert [tuple(span) for span in spans] == [
        (0, 0, 0.0, 0.1), (0, 1, 0.1, 0.2), (0, 2, 0.2, pytest.approx(0.3)),
        (0, 0, pytest.approx(0.3), 0.6), (0, 3, 0.6, 1.0), (1, 2, 0.0, 1.0),
    ]  # fmt: skip
    switches = metrics.Figures(record).metric("mode_switches")
    assert switches is not None
    assert switches.robots == (pytest.approx(2 / 0.01), 0.0)
    assert switches.value == pytest.approx(2 / (1.6 / 60))
    safe = metrics.Figures(record).metric("safe_share")
    assert safe is not None
    assert safe.robots == (pytest.approx(4 / 6), 0.0)


def test_updates_per_second_is_of_active_robots() -> None:
    told = [(0, 0, 0, 10), (10, 0, 0, 20), (20, 0, 3, 30), (0, 1, 0, 20)]
    rows = [{"step": s, "robot": r, "mode": m, "next_step": n} for s, r, m, n in told]
    rows[2]["station"] = THERE
    rate = metrics.Figures(history(rows, robots=3, steps_run=40)).metric("updates_per_second")
    assert rate is not None
    assert rate.value == pytest.approx(7.5)
    assert rate.robots == (pytest.approx(10.0), pytest.approx(5.0), None)


def test_collision_times_are_the_least_of_each_step() -> None:
    nan, inf = np.nan, np.inf
    told = [(0, 0, 3.0), (0, 1, 2.0), (10, 0, inf), (20, 0, nan), (20, 1, 5.0)]
    rows = [{"step": s, "robot": r, "collision_time": t} for s, r, t in told]
    time, values = metrics.collision_times(history(rows)) or (None, None)
    assert time == pytest.approx([0.0, 0.1, 0.2])
    assert list(values) == [2.0, inf, 5.0]


@pytest.mark.parametrize("robots", [2, 3])
def test_pair_distances_hold_every_nearest_one(robots: int) -> None:
    with make_record(robots=robots, contacts=False, seconds=3.0) as record:
        (time, values), pairs = metrics.pair_distances(record)
        for i in range(robots):
            mine = values[:, (pairs == i).any(axis=1)]
            assert np.allclose(mine.min(axis=1), record.clearance[:, i], rtol=0, atol=1e-9)
        few, _ = metrics.pair_distances(record, most=10 * len(pairs))
        assert len(few.time) == 10
        assert few.time[[0, -1]] == pytest.approx(time[[0, -1]])
        assert values.max() == pytest.approx(record.farthest["farthest"])


def test_width_is_from_wall_to_wall() -> None:
    """Against shapely: distances to the walls on either side of a straight stretch."""
    with make_record(seconds=1.0) as record:
        found = metrics.corridor_width(record, robot=1)
        walls = shapely.linestrings(sides_of(record)[1].reshape(-1, 2, 2))
    assert np.allclose(np.diff(found.station), 0.1)
    early = found.station < 8.0
    assert np.allclose(found.width[early], WIDTH)
    for feet in (found.left, found.right):
        assert shapely.distance(shapely.points(feet)[:, None], walls).min(axis=1).max() < 1e-9
    least = shapely.distance(shapely.points(found.points)[:, None], walls).min(axis=1)
    gaps = [np.hypot(*(feet - found.points).T) for feet in (found.left, found.right)]
    assert np.allclose(np.minimum(*gaps), least)


def recorded(world: str, path: FloatArray, bodies: dict[str, list[FloatArray]]) -> Record:
    """One robot on a path beside bodies by name: obstacles are called box."""
    scene = make_scene(1)
    scene.walls = pack_parts(list(bodies.values()))
    kinds = ["obstacle" if name == "box" else "boundary" for name in bodies]
    others = (Body(1 + k, *of) for k, of in enumerate(zip(kinds, bodies, strict=True)))
    scene.bodies = (scene.bodies[0], *others)
    scene.paths = pack_polylines([path])
    out = RecordWriter(None, scene, world, name="room")
    out.close("duration", steps_run=0, rejected=0, wall_clock={})
    return out.record()


def test_a_wall_across_the_path_has_no_width() -> None:
    """A room of 30 m by 16 m; the nearest points on both sides lie on the end wall until 8 m."""
    walls = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 16.0], [0.0, 16.0], [0.0, 0.0]])
    path = np.array([[1.0, 8.0], [29.0, 8.0]])
    record = recorded("boundaries: []", path, {"boundary 1": list(pairwise(walls))})
    found = metrics.corridor_width(record)
    x = found.points[:, 0]
    between = (x > 8.0 + 1e-9) & (x < 22.0 - 1e-9)
    assert np.isnan(found.width[(x < 8.0 - 1e-9) | (x > 22.0 + 1e-9)]).all()
    assert found.width[between] == pytest.approx(16.0)
    assert metrics.Figures(record).value("width_min") == pytest.approx(16.0)


def corridor(path_offset: float, obstacle: bool = False) -> Record:
    """One robot on a path beside the centreline of a bent corridor with caps."""
    left, right = (offset_polyline(CENTRELINE, np.full(4, s * WIDTH / 2)) for s in (1, -1))
    caps = {f"{end} cap": np.array([left[k], right[k]]) for end, k in (("start", 0), ("end", -1))}
    lines = {"left wall": left, "right wall": right, **caps}
    bodies = {name: list(pairwise(line)) for name, line in lines.items()}
    if obstacle:
        bodies["box"] = [np.array([[5.0, -3.0], [6.0, -3.0], [6.0, -2.0], [5.0, -2.0]])]
    path = offset_polyline(CENTRELINE, np.full(4, path_offset))
    return recorded("corridor: {width: 8.0}", path, bodies)


@pytest.mark.parametrize("offset", [0.0, 3.9, -3.9])
def test_caps_of_a_corridor_do_not_narrow_it_and_a_path_along_a_wall_sees_both(
    offset: float,
) -> None:
    found = metrics.corridor_width(corridor(offset))
    assert found.width.min() == pytest.approx(WIDTH, abs=1e-9)
    assert found.width[0] == pytest.approx(WIDTH)
    assert found.width.max() < 1.2 * WIDTH


def test_an_obstacle_narrows_a_corridor_on_its_side() -> None:
    found = metrics.corridor_width(corridor(0.0, obstacle=True))
    k = int(np.argmin(abs(found.station - 5.5)))
    assert found.width[k] == pytest.approx(4.0 + 2.0)
    assert found.right[k] == pytest.approx([5.5, -2.0])


# Collision times of all pairs under their present commands, against their closed form

LENGTH = 1.8
"""[m] of a robot"""
AT = np.array([0.0, 6.0, 20.0])
"""[m] where the robots stand, one behind the other"""


def row(*commands: tuple[int, int, float]) -> Record:
    """Three robots in a row; ``commands`` are (step, robot, v)."""
    pose = np.zeros((101, 3, 3))
    pose[:, :, 0] = AT
    rows = [{"step": s, "robot": i, "nominal_v": v} for s, i, v in commands]
    return history(rows, robots=3, pose=pose)


def test_commands_are_those_given_at_that_step() -> None:
    """A robot that has decided nothing stands; a decision counts from its own step on."""
    record = row((0, 0, 1.0), (30, 1, 0.5), (60, 0, 2.0), (60, 1, -1.0))
    (time, least), who = pair_collision_times(record)
    assert time == pytest.approx([0.0, 0.3, 0.6])
    gap = 6.0 - LENGTH
    assert least == pytest.approx([gap / 1.0, gap / 0.5, gap / 3.0])
    assert who.tolist() == [[0, 1]] * 3


def test_least_over_all_pairs() -> None:
    """The third robot comes fast from far away; what parts never meets."""
    record = row((0, 0, 1.0), (0, 2, -8.0), (50, 0, -1.0), (50, 1, 0.0), (50, 2, 0.0))
    (_, least), who = pair_collision_times(record)
    gaps = 6.0 - LENGTH, 14.0 - LENGTH
    assert least[0] == pytest.approx(min(gaps[0] / 1.0, gaps[1] / 8.0))
    assert who[0].tolist() == [1, 2]
    assert least[1] == np.inf
    found = shortest_pair_collision_time(record)
    assert found is not None
    assert (found.value, found.step, found.a, found.b) == (least[0], 0, 1, 2)


def test_later_than_the_horizon_is_never() -> None:
    (_, least), _ = pair_collision_times(row((0, 0, 1.0)), horizon=4.0)
    assert least.tolist() == [np.inf]
    assert shortest_pair_collision_time(row((0, 0, 1.0)), horizon=4.0) is None
