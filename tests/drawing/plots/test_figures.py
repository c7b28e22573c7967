"""The figures of the paper: what they show is what the metrics say; odd records are no trouble."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text

from physim import PAPER_MODES, Column, Mode
from physim.analysis import metrics
from physim.drawing.plots import NAMES, draw
from physim.record import Record, RecordWriter
from physim.units import amount, true_minus
from tests.analysis.metrics.histories import along_reference, beside_paths, history
from tests.helpers import facts, inside
from tests.helpers.records import DECLARED, make_record, make_scene, poses, update_rows

MOST_LINES, QUANTILES, Timeline = inside("physim.drawing", "MOST_LINES", "QUANTILES", "Timeline")
significant = inside("physim.drawing", "significant")
MOST_SINGLE, PICTURES = inside("physim.drawing.plots", "MOST_SINGLE", "PICTURES")
STRETCHES, collision_times = inside("physim.drawing.plots", "STRETCHES", "collision_times")
deviation, distances = inside("physim.drawing.plots", "deviation", "distances")
formation, least_of_stretches = inside("physim.drawing.plots", "formation", "least_of_stretches")
mark, mode_counts = inside("physim.drawing.plots", "mark", "mode_counts")
settle_marks = inside("physim.drawing.plots", "settle_marks")
modes, speeds, trajectories = inside("physim.drawing.plots", "modes", "speeds", "trajectories")
width = inside("physim.drawing.plots", "width")
Declared = inside("physim.parts", "Declared")
Body = inside("physim.world", "Body")


@pytest.fixture(scope="module")
def record() -> Iterator[Record]:
    with make_record(seconds=14.0) as made:
        yield made


def crowd(robots: int = 60) -> Record:
    """Many robots with names that matplotlib or a file system could stumble over."""
    scene = make_scene(robots, seconds=12.0, dt=0.05)
    odd = (
        "$x$",
        "_hidden",
        "a/b",
        "<b>&amp;",
        "二",
        "a long, long name of a robot",
        '"',
        "%s",
    )
    names = [Body(i, "robot", odd[i] if i < len(odd) else f"r{i}") for i in range(robots)]
    scene.bodies = (*names, *scene.bodies[robots:])
    out = RecordWriter(None, scene, "formation: {range: 5}", name="$x_{$ crowd",
                       safe_distance=0.0, declared=DECLARED)  # fmt: skip
    pose = poses(scene)
    gaps = 0.5 + 0.1 * np.broadcast_to(np.arange(robots), pose.shape[:2])
    out.append_steps(np.arange(len(pose)), pose, gaps, gaps + 1.0)
    out.append("updates", update_rows(scene, pose))
    out.close("duration", steps_run=scene.steps, rejected=0, wall_clock={})
    return out.record()


ODD = {
    "nothing recorded": lambda: history(steps_run=0),
    "one sample, no decision": lambda: history(pose=np.zeros((1, 2, 3)), steps_run=0),
    "one robot": lambda: make_record(robots=1, seconds=1.0),
    "no formation": lambda: make_record(seconds=1.0, world_text="name: x\n"),
    "no contact": lambda: make_record(robots=2, seconds=1.0, contacts=False),
    "no collision times": lambda: history([{"robot": 1, "collision_time": np.nan}]),
    "killed": lambda: make_record(seconds=1.0, ended="running"),
    "no columns": lambda: history([{"robot": 1, "mode": -1}], declared=Declared()),
    "modes of its own": lambda: moods([0, 1, 4]),
    "driven from outside": lambda: history(pose=np.zeros((50, 2, 3)), arrived=[40, -1]),
    "without tables": lambda: history(pose=np.zeros((50, 2, 3)), tables=()),
    "a crowd": crowd,
}


FEW = ("nothing recorded", "driven from outside", "a crowd")
"""Drawn in the fast tier"""


@pytest.mark.parametrize(
    "kind", [k if k in FEW else pytest.param(k, marks=pytest.mark.deep) for k in ODD]
)
def test_every_figure_of_every_record_is_drawn(kind: str, tmp_path: Path) -> None:
    with ODD[kind]() as made, warnings.catch_warnings():
        warnings.simplefilter("error")
        files = draw(made, tmp_path, only=NAMES)
    assert [file.stem for file in files] == list(NAMES)
    assert all(file.stat().st_size > 5000 for file in files)


def test_every_axis_has_its_unit_and_the_run_its_name(record: Record) -> None:
    for name in NAMES:
        figure = PICTURES[name](record)
        for axis in figure.axes:
            for label in (axis.get_xlabel(), axis.get_ylabel()):
                shared = label == "" and axis is not figure.axes[-1]
                assert "[" in label or label == "robot" or shared, label
        (source,) = (text.get_text() for text in figure.texts if text.get_gid() == "source")
        assert source.startswith("made up, seed 3")
        assert ("of the paper" in source) == (name != "prediction")


def marks(axis: Any) -> list[tuple[float, float]]:
    """Points that are marked."""
    dots = [line for line in axis.lines if line.get_marker() == "o" and line.get_zorder() == 5]
    return [(float(dot.get_xdata()[0]), float(dot.get_ydata()[0])) for dot in dots]


def texts(figure: Any, kind: str) -> list[str]:
    return [t.get_text() for axis in figure.axes for t in axis.texts if t.get_gid() == kind]


@pytest.mark.parametrize(
    ("name", "kind", "why"),
    [
        ("deviation", "nothing recorded", "no sample"),
        ("speeds", "nothing recorded", "10 s"),
        ("formation", "one robot", "robot alone"),
        ("formation", "no formation", "world"),
        ("distances", "one robot", "one robot"),
        ("collision_times", "nothing recorded", "no decision foresaw"),
        ("collision_times", "no collision times", "controller"),
        ("modes", "nothing recorded", "no decision"),
        ("trajectories", "nothing recorded", "no sample"),
        ("prediction", "no contact", "no contact"),
    ],
)
def test_where_there_is_nothing_the_figure_says_none(name: str, kind: str, why: str) -> None:
    with ODD[kind]() as made:
        said = texts(PICTURES[name](made), "none")[0]
    assert said.startswith("none: ")
    assert re.search(facts(why), said)


def test_curves_are_the_metrics(record: Record) -> None:
    def curve(axis: Any, name: str) -> Any:
        return next(line for line in axis.lines if line.get_label() == name).get_ydata()

    for k, name in enumerate(record.names):
        _, values = metrics.deviations(record)
        assert np.array_equal(curve(deviation(record).axes[0], name), values[:, k])
    turning, forward = speeds(record).axes
    found = metrics.averaged_speeds(record)
    assert np.array_equal(curve(turning, "r2"), found.rotational[:, 1], equal_nan=True)
    assert np.array_equal(curve(forward, "r2"), found.forward[:, 1], equal_nan=True)
    energy = metrics.formation_energy(record)
    assert energy is not None
    assert np.array_equal(formation(record).axes[1].lines[0].get_ydata(), energy.values)
    course = metrics.corridor_width(record)
    drawn = width(record).axes[1].lines[0].get_ydata()
    assert np.array_equal(drawn, course.width, equal_nan=True)


def test_marks_tell_the_extremes_that_the_metrics_have(record: Record) -> None:
    found = {name: one.value for name, one in metrics.measure(record).items()}
    peak = metrics.deviation_peak(record)
    assert peak is not None
    assert marks(deviation(record).axes[0]) == [(peak.time, peak.value)]
    told = {
        deviation: [f"{true_minus(f'{peak.value:+.2f}')} m (r1)"],
        formation: [f"{found['formation_error_peak']:.2f} m (r1)"],
        distances: [f"farthest {amount(found['farthest_distance'], 'm')} (r1 and r3)"],
    }
    legend = " ".join(str(text.get_text()) for text in distances(record).legends[0].get_texts())
    for name in ("shortest_distance", "shortest_boundary_distance"):
        assert true_minus(f"least {amount(found[name], 'm')}") in legend
    for picture, words in told.items():
        assert texts(picture(record), "mark") == words
    ends = zip(texts(width(record), "mark"), ("width_min", "width_max"), strict=True)
    assert all(f" {significant(found[name])} m at " in words for words, name in ends)
    title = formation(record).axes[0].get_title("right")
    assert title == f"within {found['formation_error_final']:.2f} m of zero at the end"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_peaks_are_marked_on_their_side(sign: float) -> None:
    step = np.arange(91)
    pose = beside_paths(sign * (0.01 * step[:, None] - 0.5 * np.arange(2)))
    axis = deviation(history(pose=pose, steps_run=90)).axes[0]
    assert marks(axis) == [(0.9, pytest.approx(0.9 * sign))]
    assert texts(axis.figure, "mark") == [f"{true_minus(f'{0.9 * sign:+.2f}')} m (r1)"]
    errors = sign * np.array([[0.0, 0.0, 0.0], [0.9, -0.5, -0.4]])
    pose = along_reference(np.array([0, 90]), np.array([7.5, 5.0, 2.5]) - errors)
    figure = formation(history(robots=3, pose=pose, steps_run=90))
    assert marks(figure.axes[0]) == [(0.9, pytest.approx(0.9 * sign))]
    assert texts(figure, "mark") == [f"{true_minus(f'{0.9 * sign:.2f}')} m (r1)"]


def test_when_a_formation_is_in_parts_is_shaded() -> None:
    """Gaps of 4, 6, 6 and 4 m: apart from 0.5 to 2.5 s, and in one part beside that."""
    step, gap = np.array([0, 100, 200, 300]), np.array([4.0, 6.0, 6.0, 4.0])
    pose = along_reference(step, np.stack([20.0 + gap, np.full(4, 20.0)], axis=1))

    def shades(reach: float) -> list[tuple[float, float]]:
        world = f"formation: {{range: {reach}}}"
        figure = formation(history(robots=2, pose=pose, steps_run=300, world=world))
        found = [patch for axis in figure.axes for patch in axis.patches if patch.get_gid()]
        legend = [text for shown in figure.legends for text in shown.get_texts()]
        assert len([one for one in legend if "connected" in one.get_text()]) == bool(found)
        return [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in found]

    for begin, end in (both := shades(5.0)):
        assert (begin, end) == (pytest.approx(0.5, abs=0.11), pytest.approx(2.5, abs=0.11))
    assert len(both) == 2, "in the errors and in the energy"
    assert shades(7.0) == []
    assert [one == pytest.approx((0.0, 3.0)) for one in shades(3.0)] == [True, True]


def test_collision_times_show_every_decision_and_mark_the_shortest(record: Record) -> None:
    axis = collision_times(record).axes[0]
    rows = record.updates[np.isfinite(record.updates["collision_time"])]
    for i, name in enumerate(record.names):
        mine = rows[rows["robot"] == i]
        for line in axis.lines:
            if line.get_label() == name:
                assert np.array_equal(line.get_ydata(), mine["collision_time"])
    assert texts(axis.figure, "mark") == [f"{rows['collision_time'].min():.3g} s (r1)"]


def test_a_decision_holds_until_the_next_however_short_the_stretches_are() -> None:
    """A robot that decides every tenth step foresees a collision all the time, not now and then."""
    rows = [
        {"step": step, "robot": 0, "collision_time": 2.0 + step, "next_step": step + 10}
        for step in range(0, 50, 10)
    ]
    with history(rows, steps_run=100) as made:
        _edges, least = least_of_stretches(made, made.updates, 100)
    assert list(least[0, :50]) == [2.0 + 10 * (k // 10) for k in range(50)]
    assert np.isnan(least[0, 50:]).all()
    assert np.isnan(least[1]).all()


@pytest.mark.parametrize("robots", [2, 5])
def test_collision_times_below_the_axis_lie_on_its_end_which_says_so(robots: int) -> None:
    """A contact is 0 s, which no logarithmic axis holds."""
    rows = [
        {"step": step, "robot": 0, "collision_time": 2.0 if step < 10 else 0.0}
        for step in range(20)
    ]
    with history(rows, robots=robots) as made:
        axis = collision_times(made).axes[0]
    low, high = axis.get_ylim()
    assert 0.009 < low < 0.01 < high
    assert axis.get_yticks()[0] == 0.01
    assert axis.get_yticklabels()[0].get_text() == "≤ 0.01"
    with history(rows[:10], robots=robots) as made:
        labels = collision_times(made).axes[0].get_yticklabels()
    assert all("≤" not in one.get_text() for one in labels)


def test_collision_times_of_many_robots_are_a_row_each_below_those_of_all() -> None:
    with crowd(MOST_SINGLE + 1) as made:
        figure = collision_times(made)
        rows = made.updates[np.isfinite(made.updates["collision_time"])]
        above, below = figure.axes
        edges, least = least_of_stretches(made, rows, STRETCHES)
        for robot in (0, 1):
            mine = rows["collision_time"][rows["robot"] == robot]
            assert np.array_equal(above.lines[robot].get_ydata(), mine)
        assert sorted(set(rows["robot"])) == [0, 1]
        told = texts(figure, "least")
        assert len(told) == 2
        for robot in (0, 1):
            mine = rows[rows["robot"] == robot]
            assert told[robot] == f"{mine['collision_time'].min():.2f} s"
            at = np.searchsorted(edges, mine["step"], side="right") - 1
            assert (least[robot, np.minimum(at, STRETCHES - 1)] <= mine["collision_time"]).all()
        assert below.collections[0].get_array().shape == (made.robots, STRETCHES)
        assert texts(figure, "mark")[0].startswith(f"{rows['collision_time'].min():.3g} s (")


FIVE = Declared(
    tuple(Mode(name, f"#0000{k}0", f"{name} now") for k, name in enumerate("abcde")),
    columns=(Column("mood"),),
)


def moods(modes: Sequence[int], robots: int = 2) -> Record:
    """Record of a controller of one's own, with five modes, each 1 s long, and no usual column."""
    rows = [
        {"step": 100 * k, "robot": i, "mode": mode, "next_step": 100 * k + 100}
        for k, mode in enumerate(modes)
        for i in range(robots)
    ]
    pose = np.zeros((100 * len(modes) + 1, robots, 3))
    pose[:, :, 0] += np.linspace(0.0, 60.0, robots)
    return history(rows, robots=robots, steps_run=100 * len(modes), pose=pose, declared=FIVE)


def test_modes_of_one_s_own_have_their_names_and_colours() -> None:
    with moods([0, 1, 2, 3, 4]) as made:
        figure = modes(made)
    legend = figure.legends[0]
    words = [text.get_text() for text in legend.get_texts()]
    faces = [to_hex(patch.get_facecolor()) for patch in legend.get_patches()]
    assert dict(zip(words, faces, strict=True)) == {str(m): m.colour for m in FIVE.modes}
    drawn = {to_hex(bars.get_facecolor()[0]) for bars in figure.axes[0].collections}
    assert drawn == {mode.colour for mode in FIVE.modes}
    assert texts(figure, "share") == []


def test_modes_tell_each_share(record: Record) -> None:
    figure = modes(record)
    safe = metrics.Figures(record).metric("safe_share")
    assert safe is not None
    assert texts(figure, "share") == [
        f"{100.0 * share:.0f} %" for share in safe.robots if share is not None
    ]
    assert 0.55 < safe.value < 1.0
    title = figure.axes[0].get_title("right")
    assert re.search(facts("out of danger", f"{100.0 * safe.value:.1f} %"), title)
    area = 0.0
    for bars in figure.axes[0].collections:
        corners = [path.vertices for path in bars.get_paths()]
        area += sum(float(np.ptp(c[:, 0])) for c in corners)
    assert area == pytest.approx(3 * record.steps_run * record.dt)


def test_a_crowd_is_drawn_as_bands() -> None:
    with crowd() as made:
        axis = deviation(made).axes[0]
        _, values = metrics.deviations(made)
    assert values.shape[1] > MOST_LINES
    labels = [line.get_label() for line in axis.lines]
    assert len(labels) < 8
    median = next(line for line in axis.lines if line.get_label().startswith("median"))
    assert np.allclose(median.get_ydata(), np.median(values, axis=1))
    assert QUANTILES[3] == 0.5


def test_of_a_crowd_the_robots_in_each_mode_are_counted() -> None:
    with crowd() as made:
        figure = modes(made)
        spans = metrics.mode_spans(made)
        times, counts = mode_counts(made, spans)
    for k in (0, 200, 300, 620):
        now = spans[(spans["begin"] <= times[k]) & (spans["end"] > times[k] + 1e-9)]
        assert counts[:, k].tolist() == np.bincount(now["mode"], minlength=len(counts)).tolist()
    assert (counts[:, :-1].sum(axis=0) == made.robots).all()
    above = figure.axes[0]
    assert above.get_ylim() == (0.0, made.robots)
    colours = [to_hex(layer.get_facecolor()[0]) for layer in above.collections]
    stacked = [mode.colour for mode in sorted(made.modes, key=lambda mode: not mode.danger)]
    assert colours == stacked


def test_on_the_map_of_a_crowd_robots_in_danger_are_over_the_others() -> None:
    with crowd() as made:
        axis = trajectories(made, 4.0).axes[0]
        assert (Timeline(made).at(4.0).modes == 1).sum() == 2
    bodies = next(c for c in axis.collections if len(c.get_paths()) == 4 * made.robots)
    faces = [to_hex(face) for face in bodies.get_facecolors()]
    assert faces.count(PAPER_MODES[1].colour) == 2
    ranked = [face == PAPER_MODES[0].colour for face in faces]
    assert ranked == sorted(ranked, reverse=True)


def test_words_of_marks_are_nearest_to_their_own_or_have_a_line_to_it_and_are_off_the_curves() -> (
    None
):
    """Two minima side by side at the right end of the axis, as of a run that ends in contact."""
    figure = Figure(figsize=(3.4, 2.4))
    axis = figure.subplots()
    curves = (
        [[0.0, 1.6], [30.0, 0.33], [35.0, 0.7], [36.5, 0.6], [37.2, 0.0], [42.0, -0.02]],
        [[0.0, 3.0], [30.0, 2.8], [35.0, 2.5], [35.6, 2.05], [37.0, 2.0], [41.9, 0.222]],
    )
    for curve in curves:
        axis.plot(*np.array(curve).T)
    axis.set(xlim=(0.0, 41.95), ylim=(-1.2, 3.6))
    mark(axis, 40.7, -0.0243, "-0.0243 m", below=True)
    mark(axis, 41.9, 0.222, "0.222 m", below=True)
    settle_marks(figure)
    points = axis.transData.transform([text.xy for text in axis.texts])
    lines = [shapely.LineString(axis.transData.transform(curve)) for curve in curves]
    for k, text in enumerate(axis.texts):
        words = shapely.box(*Text.get_window_extent(text).extents)
        away = [words.distance(shapely.Point(point)) for point in points]
        assert away[k] == min(away) or text.arrow_patch.get_visible()
        assert not any(line.intersects(words) for line in lines)
