"""What `physim.judge` finds in a log: held against runs, shapely, and motion known by formula."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import affinity

import physim
from physim import Kind, Phase, PhysimError, Record
from tests.cli.commands import physim as command
from tests.helpers import inside
from tests.helpers.words import facts

SceneModel = inside("physim.drawing.scene_model", "SceneModel")
Figures = inside("physim.analysis.metrics", "Figures")
report, warning_lines = inside("physim.analysis.validation", "report", "warning_lines")

WORLD = """\
name: hall
time: {step: 0.01, duration: 20.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 6.0}
robots:
  - {name: alpha, footprint: {length: 1.0, width: 0.6}, pose: [2, 1, 0], path: {offset: 1}}
  - {name: beta, footprint: {length: 1.0, width: 0.6}, pose: [2, -1, 0], path: {offset: -1}}
"""
HEAD = "time,robot,x,y,heading"


def hall(extra: str = "") -> physim.World:
    return physim.parse_world(WORLD + extra)


def written(path: Path, rows: list[list[object]], head: str = HEAD) -> Path:
    path.write_text("\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


def straight(count: int = 41, dt: float = 0.1) -> list[list[object]]:
    """Both drive beside each other at 0.5 m/s."""
    return [
        [round(k * dt, 6), name, 2.0 + 0.05 * k, y, 0.0]
        for k in range(count)
        for name, y in (("alpha", 1.0), ("beta", -1.0))
    ]


# A run of physim, written as a log


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("straight", []),
        ("jam", ["time.duration=19.0"]),
        ("crossing", []),
        pytest.param("three_robots", [], marks=pytest.mark.deep),
        pytest.param("ten_robots", [], marks=pytest.mark.deep),
    ],
)
def test_a_run_as_a_log_is_judged_as_it_was_recorded(
    tmp_path: Path, name: str, changes: list[str]
) -> None:
    world = physim.load_world(name, overrides=changes)
    run, log = physim.simulate(world), tmp_path / "log.csv"
    run.to_pandas().to_csv(log, index=False)
    judged = physim.judge(log, world)
    assert judged.dt == run.dt
    assert (judged.pose == run.pose).all()
    for table in ("extremes", "farthest", "arrived", "clearance", "boundary_clearance"):
        assert (getattr(judged, table) == getattr(run, table)).all()
    rows = [one.contacts[np.lexsort([one.contacts[key] for key in ("b", "a", "step")])]
            for one in (run, judged)]  # fmt: skip
    for column in set(rows[0].dtype.names) - {"impulse"}:
        assert (rows[0][column] == rows[1][column]).all()
    known = physim.metrics.measure(judged)
    of_decisions = {"impulse", "energy_lost", "closing_speed", "seen_collision_time"}
    for key in known.keys() - of_decisions:
        assert known[key] == physim.metrics.measure(run)[key]
    found = physim.validate(judged)
    assert found.comparison.disagreements == ()
    assert len(found.contacts) == len(Figures(run).episodes)
    assert len(found.grazes) == len(Figures(run).grazes)


# Against shapely, which knows nothing of physim


def shape(record: Record, body: int, pose: np.ndarray) -> shapely.Geometry:
    x, y, heading = pose[body]
    whole = shapely.Polygon(record.footprints[body][0])
    return affinity.translate(affinity.rotate(whole, math.degrees(heading), (0, 0)), x, y)


def random_log(path: Path, seed: int, count: int = 150) -> Path:
    """Two robots that go to and fro and turn about one place, a step of up to 0.2 m."""
    rng, rows, time = np.random.default_rng(seed), [], 0.1 * np.arange(count)
    for name, start in (("alpha", (5.0, 0.5, 0.0)), ("beta", (5.6, -0.5, 1.0))):
        wide, fast, phase = rng.uniform((0.5, 0.7, 0.0), (1.0, 1.7, 6.0), (3, 3)).T
        pose = start + wide * np.sin(fast * time[:, None] + phase)
        rows += [[round(0.1 * k, 6), name, *pose[k]] for k in range(count)]
    return written(path, rows)


@pytest.mark.parametrize("seed", [1, 2, *(pytest.param(k, marks=pytest.mark.deep) for k in (3, 4))])
def test_contacts_of_a_random_log_are_those_of_shapely(tmp_path: Path, seed: int) -> None:
    record = physim.judge(random_log(tmp_path / "log.csv", seed), hall(), jumps=True)
    rows = record.contacts
    touching = np.array(
        [shape(record, 0, pose).intersects(shape(record, 1, pose)) for pose in record.pose]
    )
    told = rows[(rows["kind"] == Kind.PHYSICAL) & (rows["phase"] != Phase.ENDED)]
    assert touching.any()
    assert set(np.flatnonzero(touching)) == set(told["step"].tolist())
    began, ended = (np.flatnonzero(np.diff(touching.astype(int)) == k) + 1 for k in (1, -1))
    for phase, steps in ((Phase.BEGAN, began), (Phase.ENDED, ended)):
        some = rows[(rows["phase"] == phase) & (rows["kind"] == Kind.PHYSICAL)]["step"].tolist()
        assert set(some) - {0} == set(steps.tolist())
    grazes = {row["step"]: row["depth"] for row in rows[rows["kind"] == Kind.SWEPT]}
    for step in range(1, record.samples):
        if touching[step - 1] or touching[step]:
            assert step not in grazes
            continue
        old, new = record.pose[step - 1], record.pose[step]
        between = (old + share * (new - old) for share in np.linspace(0.0, 1.0, 60))
        seen = any(shape(record, 0, pose).intersects(shape(record, 1, pose)) for pose in between)
        assert (step in grazes) or not seen
        assert seen or grazes.get(step, 0.0) < 2e-3  # shorter than what was looked at


# Motion that is known


def test_poses_between_samples_lie_on_the_arc(tmp_path: Path) -> None:
    """A robot on a circle, seen at times of no step: a centre 2 m to the left, 0.3 rad/s."""
    rng, rows = np.random.default_rng(3), []
    for name, (cx, cy) in (("alpha", (8.0, 0.0)), ("beta", (14.0, 0.0))):
        for time in (0.1 * np.arange(61) + np.append(0.0, rng.uniform(-0.04, 0.04, 60))).tolist():
            turn = 0.3 * time
            at = cx + 2.0 * math.sin(turn), cy - 2.0 * math.cos(turn)
            rows.append([time, name, *at, (turn + 3.0) % (2.0 * math.pi) - 3.0])
    log = written(tmp_path / "log.csv", rows)
    with pytest.raises(PhysimError, match=facts("log.csv", "steps off", "--every")):
        physim.judge(log, hall())
    record = physim.judge(log, hall(), every=0.02)
    turn = 0.3 * record.time
    exact = np.stack((8.0 + 2.0 * np.sin(turn), -2.0 * np.cos(turn), turn), axis=1)
    assert np.abs(record.pose[:, 0] - exact).max() < 1e-9
    assert record.judged is not None
    assert any("between two samples" in note for note in record.judged.notes)


def test_a_missed_sample_is_bridged_and_told(tmp_path: Path) -> None:
    whole = physim.judge(written(tmp_path / "whole.csv", straight()), hall())
    rows = [row for k, row in enumerate(straight()) if k not in (21, 40)]
    record = physim.judge(written(tmp_path / "log.csv", rows), hall())
    assert record.dt == 0.1
    assert np.abs(record.pose - whole.pose).max() < 1e-12
    assert "2.4%" in record.judged.notes[-1]


def test_collision_times_are_those_of_the_motion_seen(tmp_path: Path) -> None:
    """Alpha drives on, beta comes sideways from its left, 2 m away at 0.4 m/s: gap 1.4 m."""
    rows: list[list[object]] = []
    for k in range(11):
        rows.append([0.1 * k, "alpha", 6.0 + 0.05 * k, -1.0, 0.0])
        rows.append([0.1 * k, "beta", 6.0 + 0.05 * k, 1.0 - 0.04 * k, 0.0])
    record = physim.judge(written(tmp_path / "log.csv", rows), hall())
    time = physim.metrics.measure(record)["seen_collision_time"]
    assert time.value == pytest.approx(1.4 / 0.4 - 0.9, abs=1e-6)
    assert time.time == pytest.approx(0.9)
    degrees = [[*row[:4], 90.0] for row in rows]
    turned = physim.judge(written(tmp_path / "turned.csv", degrees), hall(), degrees=True)
    assert turned.pose[0, 0, 2] == math.pi / 2


def test_small_headings_that_may_be_degrees_are_doubted(tmp_path: Path, capsys) -> None:
    def log(heading: float, course: float, speed: float = 0.5) -> Path:
        c, s = speed * math.cos(course), speed * math.sin(course)
        rows: list[list[object]] = [
            [round(0.1 * k, 6), name, 2.0 + 0.1 * k * c, y + 0.1 * k * s, heading]
            for k in range(41)
            for name, y in (("alpha", 1.0), ("beta", -1.0))
        ]
        return written(tmp_path / "log.csv", rows)

    def doubts() -> list[str]:
        record = physim.judge(tmp_path / "log.csv", hall())
        return [note for note in record.judged.notes if "degrees" in note]

    for heading, course, speed in ((0.05, 0.05, 0.5), (1.57, 0.6, 0.5), (3.0, 0.05, 0.01)):
        log(heading, course, speed)
        assert not doubts()
    log(3.0, math.radians(5.0))
    hall().save(tmp_path / "hall.yaml")
    assert re.search(facts("beta", "167°", "2°", "--degrees"), doubts()[0])
    given = ("judge", tmp_path / "log.csv", "--world", tmp_path / "hall.yaml", "--quiet")
    done = command(*given, "-o", tmp_path / "out", capture=capsys)
    assert re.fullmatch(r"WARNING  headings may be degrees: .*\n", done.err)


def test_movers_and_boxes_are_in_the_log_like_robots(tmp_path: Path) -> None:
    world = hall(
        """\
movers:
  - {name: cart, footprint: {length: 0.5, width: 0.5}, waypoints: [[4, 0], [12, 0]], speed: 0.5}
obstacles:
  - {corners: [[9, 0.5], [10, 0.5], [10, 1.5], [9, 1.5]], mass: 20.0}
"""
    )
    rows = [*straight(), *([0.1 * k, "cart", 4.0, 3.0 - 0.1 * k, 0.0] for k in range(41))]
    with pytest.raises(PhysimError, match=facts("obstacle 1", "no samples")):
        physim.judge(written(tmp_path / "some.csv", rows), world)
    rows += [[0.1 * k, "obstacle 1", 6.0, 1.0, 0.0] for k in range(41)]
    record = physim.judge(written(tmp_path / "log.csv", rows), world)
    met = {(record.bodies[row["a"]].name, record.bodies[row["b"]].name) for row in record.contacts}
    assert met == {("alpha", "cart"), ("beta", "cart")}  # the cart passes through the wall untold
    assert (record.extremes["clearance"] < 1e-9).all()
    shortest = physim.metrics.measure(record)["seen_collision_time"]
    assert "cart" in {record.bodies[k].name for k in shortest.bodies}
    assert SceneModel.of_record(record).ways == ()  # of the world's cart, which the log's is not


# What readers say


@pytest.fixture
def touching(tmp_path: Path) -> Iterator[Record]:
    """Alpha runs into beta's side and passes through it."""
    rows: list[list[object]] = []
    for k in range(41):
        rows.append([0.1 * k, "alpha", 6.0, 2.0 - 0.1 * k, 0.0])
        rows.append([0.1 * k, "1", 6.0, -1.0, 0.0])
    with physim.judge(written(tmp_path / "log.csv", rows), hall()) as record:
        record.save(tmp_path / "record.h5")
        yield record


def test_nothing_is_said_that_poses_do_not_tell(touching: Record, tmp_path: Path) -> None:
    summary = physim.summarise(touching)
    told = str(summary._repr_html_())
    for words in ("log.csv", "not known", "the log ends", "NOT SOLID"):
        assert words in told
    for words in ("N s", "mode_switching", "decisions</", "real-time", "NOT PHYSICAL"):
        assert words not in told
    known = physim.metrics.measure(touching)
    assert {"contacts", "closing_speed", "deepest_contact"} < set(known)
    assert not {"impulse", "energy_lost", "decisions", "mean_speed", "safe_share"} & set(known)
    found = physim.validate(touching)
    assert found.code == 1
    assert found.run.controller == "log log.csv"
    (contact,) = found.contacts
    assert contact.impulse is contact.severity.energy is None
    assert contact.responsible == ()
    assert contact.severity.closing == pytest.approx(1.0)
    assert any("NOT CHECKED" in line for line in warning_lines(found))
    physim.page(touching).write(tmp_path / "page.html")
    assert "log log.csv" in (tmp_path / "page.html").read_text()


def test_a_graze_counts_in_distances_and_is_shown_at_its_moment(tmp_path: Path) -> None:
    """Corners pass each other half way between the samples at 3 and 4 s, 2 cm too near."""
    rows: list[list[object]] = []
    for k in range(8):
        rows.append([k, "alpha", 5.0 + 0.4 * k, 0.5556, math.pi / 4])
        rows.append([k, "beta", 7.5172 - 0.4 * k, -0.5557, math.pi / 4])
    world = hall("expect: {min_distance: 0.05}\n")
    record = physim.judge(written(tmp_path / "log.csv", rows), world, jumps=True)
    (graze,) = Figures(record).grazes
    assert graze.time == pytest.approx(3.5, abs=0.01)
    nearest = physim.metrics.measure(record)["shortest_distance"]
    assert (nearest.value, nearest.time) == (-graze.depth, graze.time)
    assert nearest.value == pytest.approx(-0.02 * math.sqrt(0.5), abs=1e-3)
    found = physim.validate(record)
    assert [one.key for one in found.missed] == ["min_distance"]
    assert f"deep, at {graze.time:.2f} s" in " ".join(report(found).split())
    assert f"#t={graze.time:.3f}" in physim.page(record).html


def test_no_run_goes_on_from_a_log(touching: Record, tmp_path: Path) -> None:
    with pytest.raises(PhysimError, match=facts("poses of a log")):
        physim.state_at(touching, 0.0)
    rerun = inside("physim.analysis.validation", "rerun")
    with pytest.raises(PhysimError, match=facts("cannot be simulated again", "log.csv")):
        rerun(touching)


def test_a_judged_record_that_was_altered_is_found_out(touching: Record, tmp_path: Path) -> None:
    import h5py

    for path, change in (
        ("/steps/pose", lambda rows: rows.__setitem__((20, 0, 1), 1.7)),
        ("/contacts", lambda rows: rows.__setitem__(3, rows[4])),
    ):  # fmt: skip
        touching.save(tmp_path / "other.h5")
        with h5py.File(tmp_path / "other.h5", "r+") as file:
            change(file[path])
        with Record.load(tmp_path / "other.h5") as other:
            assert other.digest() != touching.digest()
            assert physim.validate(other).code == 3


# Bad input


def row(k: int, column: int, value: object) -> Callable[[list[list[object]]], None]:
    return lambda rows: rows[k].__setitem__(column, value)


def without(name: str, first: float, last: float) -> Callable[[list[list[object]]], None]:
    def drop(rows: list[list[object]]) -> None:
        rows[:] = [one for one in rows if one[1] != name or not first < float(str(one[0])) < last]

    return drop


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (row(10, 1, "alhpa"), ("log.csv:12:5", "'alhpa'", "alpha, beta", '"alpha"')),
        (row(10, 1, 2), ("log.csv:12:5", "'2'", "0 to 1")),
        (row(20, 0, 0.5), ("log.csv:22:1", "0.5 s", "0.9 s", "sort")),
        (row(20, 0, 0.9), ("log.csv:22:1", "second sample", "0.9 s")),
        (row(6, 3, "nan"), ("log.csv:8:16", "nan", "finite")),
        (row(6, 2, "1e9"), ("log.csv:8:11", "1e+09", "1e+06 m")),
        (row(6, 2, "=now()"), ("log.csv:8:11", "'=now()'", "number")),
        (row(6, 1, '"alpha'), ("log.csv:7:1", "no CSV")),
        (row(31, 2, 9.0), ("log.csv:33:10", "beta", "6.3 m", "3 times", "1.5 m/s", "--jumps")),
        (row(31, 4, 2.0), ("log.csv:33:20", "2 rad", "--degrees", "--jumps")),
        (row(0, 4, 90.0), ("log.csv:2:19", "90", "--degrees")),
        (row(40, 4, 359.0), ("log.csv:42:19", "359", "after 0", "--degrees")),
        (without("beta", 1.0, 3.0), ("log.csv:44:1", "beta", "2 s", "0.5 s", "--gaps 2")),
        (without("beta", -1.0, 2.95), ("beta", "3 s", "from 0 s", "--gaps 3")),
        (without("beta", -1.0, 99.0), ("log.csv:1:1", "beta", "no samples")),
        (without("beta", -1.0, 3.95), ("log.csv:1:1", "beta", "1 sample")),
        (lambda rows: rows.append([9.0, "alpha"]), ("log.csv:84:1", "2 values", "5 columns")),
        (lambda rows: rows.clear(), ("log.csv:1:1", "alpha", "no samples")),
        (lambda rows: [one.__setitem__(0, int(1e9 * float(one[0]))) for one in rows],
         ("log.csv:2:1", "seconds", "1e+08 s")),
        (lambda rows: [one.__setitem__(0, 30.0 * float(one[0])) for one in rows],
         ("log.csv:2:1", "step of 3 s", "--every")),
        (lambda rows: [one.__setitem__(0, float(one[0]) + 0.03) for one in rows[1::2]],
         ("log.csv:", "steps off", "--every")),
    ],
)  # fmt: skip
def test_a_log_that_cannot_be_judged(
    tmp_path: Path, change: Callable[[list[list[object]]], None], told: tuple[str, ...]
) -> None:
    rows = straight()
    if "step of 3 s" in told:
        rows = [[one[0], one[1], 2.0 + 25.0 * (float(one[2]) - 2.0), *one[3:]] for one in rows][:40]
    change(rows)
    with pytest.raises(PhysimError, match=facts(*told)) as caught:
        physim.judge(written(tmp_path / "log.csv", rows), hall())
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (b"time,robot,x,y,yaw\n", ("column heading", "yaw")),
        (b"time,robot,x,y,headng\n", ("heading", '"headng"')),
        (b"time;robot;x;y;heading\n", ("commas",)),
        (b"time,robot,x,x,heading\n", ("x twice",)),
        (b"", ("column time", "none")),
        (bytes(range(256)), ("no CSV",)),
        (b"time,robot,x,y,heading\n" + b"1" * 100_000, ("no CSV", "65536")),
    ],
)
def test_what_is_no_log(tmp_path: Path, text: bytes, told: tuple[str, ...]) -> None:
    (tmp_path / "log.csv").write_bytes(text)
    with pytest.raises(PhysimError, match=facts("log.csv:1:1", *told)):
        physim.judge(tmp_path / "log.csv", hall())


def test_a_pipe_and_a_huge_file_are_refused_at_once(tmp_path: Path) -> None:
    for path, told in (("/dev/zero", "is no file"), (tmp_path / "none.csv", "no such file")):
        with pytest.raises(PhysimError, match=facts(told)):
            physim.judge(path, hall())
    with (tmp_path / "huge.csv").open("wb") as file:
        file.truncate(1 << 30)
    with pytest.raises(PhysimError, match=facts("huge.csv", "1074 MB", "at most 537 MB")):
        physim.judge(tmp_path / "huge.csv", hall())
