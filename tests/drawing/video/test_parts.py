"""Parts of a frame: texts in their room, labels apart, the camera, closest pairs, legends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from tests.drawing import palette
from tests.helpers import examples, inside
from tests.helpers.records import BOX, ELL

Label, Labels, Timeline, clean = inside("physim.drawing", "Label", "Labels", "Timeline", "clean")
number = inside("physim.drawing", "number")
significant, spread, ticks = inside("physim.drawing", "significant", "spread", "ticks")
Background, Camera, closest = inside("physim.drawing.video", "Background", "Camera", "closest")
Canvas, Fleet, Ground = inside("physim.drawing.video", "Canvas", "Fleet", "Ground")
LONGEST, Lens, SMALL = inside("physim.drawing.video", "LONGEST", "Lens", "SMALL")
VIEW = inside("physim.drawing.video", "VIEW")
Item, Level, shape = inside("physim.drawing", "Item", "Level", "shape")
draw_ground, draw_scale = inside("physim.drawing.video", "draw_ground", "draw_scale")
draw_robots = inside("physim.drawing.video", "draw_robots")
ground, shorten, signs = inside("physim.drawing.video", "ground", "shorten", "signs")
sprite, width, wrapped = inside("physim.drawing.video", "sprite", "width", "wrapped")
FloatArray = inside("physim.geometry", "FloatArray")

numbers = st.floats(-300.0, 300.0, allow_nan=False)


@examples(25, deep=200)
@given(st.lists(numbers, max_size=9))
def test_names_are_spread_within_the_plot(values: list[float]) -> None:
    places = spread(np.sort(np.array(values, dtype=float)), 13.0, 20.0, 140.0)
    assert len(places) == len(values)
    assert (np.diff(places) >= 13.0 - 1e-9).all()
    assert ((places >= 20.0 - 1e-9) & (places <= 140.0 + 1e-9)).all()


@examples(25, deep=200)
@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(1, 10))
def test_ticks_are_few_and_inside(low: float, span: float, most: int) -> None:
    found = ticks(low, low + span, most)
    assert len(found) <= most + 1
    assert all(low - 1e-6 * span <= t <= low + span * (1 + 1e-6) for t, _ in found)


def test_numbers_have_as_many_digits_as_a_reader_needs() -> None:
    assert [number(v, 0.5) for v in (-0.0, 1.5, -2.0)] == ["0.0", "1.5", "−2.0"]
    assert number(50.0, 50.0) == "50"
    assert [significant(v) for v in (1e-5, 0.25, 2.0, 5.3, 13.4, 100.0, 3000.0)] == [
        "0.00001", "0.25", "2.00", "5.30", "13.4", "100", "3,000",
    ]  # fmt: skip


def test_words_of_a_scale_bar_are_its_length(written: list[str]) -> None:
    for pixels in (1e-5, 0.3, 50.0, 51.0, 480.0, 4_800.0, 1e5):
        canvas = Canvas((200, 20))
        written.clear()
        draw_scale(canvas, 10, 10, pixels)
        row = (canvas.pixels[10, 9:, :3] == palette.INK).all(axis=1)  # from where the bar begins
        drawn = int(np.argmin(row)) - 2  # the ends
        assert 0.4 * LONGEST - 1 <= drawn <= LONGEST
        words, unit = written[0].split()
        assert unit == "m"
        assert float(words) * pixels == pytest.approx(drawn, abs=1.0)


@examples(25, deep=200)
@given(st.text(max_size=40), st.integers(10, 200))
@example("M0", 19)
@example("sweeper_17", 50)
@example("17", 10)
def test_text_is_cut_to_its_room(text: str, room: int) -> None:
    whole, cut = clean(text), shorten(text, 14, room)
    assert "\n" not in cut
    if cut != whole:
        start, end = cut.rsplit("…", 1)
        assert whole.startswith(start)
        assert whole.endswith(end)
        assert not end or end.isdigit(), "only a name's number stays behind the ellipsis"
    assert width(cut, 14) <= max(room, width("…", 14))


def test_other_scripts_are_written_not_boxes() -> None:
    pictures = [sprite(text, 14, palette.INK)[1] for text in ("ก", "é", "e", "Ж", "λ", "س")]
    shapes = {picture.tobytes() for picture in pictures}
    assert len(shapes) == 6


def test_tiles_show_no_seams(made: Callable[..., Any]) -> None:
    world = ground(Timeline(made(3)))
    lens = Lens(31.7, 40.0, 611.0)
    cut, whole = Canvas((1280, 720)), Canvas((1280 + 64, 720 + 64), palette.OUTSIDE)
    Background(world, lens.scale).paint(cut.pixels, lens)
    draw_ground(whole, world, Lens(lens.scale, lens.x + 32, lens.y + 32))
    difference = np.abs(cut.pixels.astype(int) - whole.pixels[32:-32, 32:-32]).max(axis=2)
    assert (difference > 40).sum() < 60, "long lines may differ by rounding only"
    assert len(np.unique(cut.pixels.reshape(-1, 4), axis=0)) > 10


def test_a_small_world_is_shown_whole_and_a_long_one_followed(made: Callable[..., Any]) -> None:
    timeline, box = Timeline(made(3)), VIEW
    small = (np.array([-2.0, -5.0]), np.array([22.0, 8.0]))
    assert Camera(timeline, small, box, 1.0).whole
    large = (np.array([-2.0, -5.0]), np.array([200.0, 80.0]))
    camera = Camera(timeline, large, box, 1.0)
    assert not camera.whole
    assert camera.scale * 1.8 >= 35.0
    for time in (0.0, 1.3, 4.0):
        places = camera.lens(time).pixels(timeline.pose(time)[:, :2])
        assert (places > 20.0).all()
        assert (places < np.array([box.width, box.height]) - 20.0).all()


def test_one_camera_movement_however_asked(made: Callable[..., Any]) -> None:
    timeline, box = Timeline(made(3)), VIEW
    large = (np.array([-2.0, -5.0]), np.array([200.0, 80.0]))
    one, two = Camera(timeline, large, box, 1.0), Camera(timeline, large, box, 1.0)
    one.lens(3.0)
    assert one.lens(1.0) == two.lens(1.0)
    steps = np.diff([two.centre(t) for t in np.arange(0.0, 4.0, 0.04)], axis=0)
    assert np.hypot(*steps.T).max() < 0.1, "no jump: the robots go at 1 m/s"


poses = st.lists(
    st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-4, 4)), min_size=2, max_size=6
)


def test_the_closest_pair_is_the_closest(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    """Against every pair, of a record that has no distances: some overlap, some stand far away."""
    random = np.random.default_rng(5)
    for count, span in ((3, 9.0), (61, 30.0), (61, 300.0)):
        record = made(count)
        pose = np.column_stack(
            (random.uniform(0.0, span, (count, 2)), random.uniform(-3, 3, count))
        )
        pose[-1, :2] += 1e4
        poses = np.repeat(pose[None], len(record.pose), axis=0)
        timeline = Timeline(changed(record, pose=poses, record_every=2))
        pair = closest(timeline, timeline.at(0.0))
        assert pair is not None
        shapes = np.array(
            [
                shapely.MultiPolygon([turned(part, row) for part in parts])
                for parts, row in zip(record.footprints, pose, strict=True)
            ]
        )
        a, b = np.triu_indices(count, 1)
        distance = shapely.distance(shapes[a], shapes[b])
        assert max(pair.distance, 0.0) == pytest.approx(distance.min(), abs=1e-9)
        apart = shapes[pair.a].distance(shapes[pair.b])
        assert apart == pytest.approx(distance.min(), abs=1e-9)


def turned(part: FloatArray, pose: FloatArray) -> shapely.Polygon:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return shapely.Polygon([(c * x - s * y + pose[0], s * x + c * y + pose[1]) for x, y in part])


@examples(25, deep=200)
@given(poses)
def test_robots_are_drawn_at_their_poses(rows: list[tuple[float, float, float]]) -> None:
    """Their outlines; and of the last one, which is over the others, the pixels."""
    fleet = Fleet([shape(ELL if i % 2 else (BOX,)) for i in range(len(rows))])
    pose, lens, canvas = np.array(rows), Lens(40.0, 250.0, 250.0), Canvas((500, 500))
    vertices = lens.pixels(fleet.placed(pose))
    for robot, row in enumerate(pose):
        (ring,) = fleet.shapes[robot].rings
        expected = lens.pixels(shapely.get_coordinates(turned(ring, row))[:-1])
        assert np.abs(fleet.outline(vertices, robot) - expected).max() < 1e-9
    colours = np.zeros((len(rows), 3))
    colours[-1] = 20, 200, 60
    draw_robots(canvas, fleet, lens, pose, colours, np.zeros(len(rows), bool))
    last = shapely.Polygon(fleet.outline(vertices, len(rows) - 1))
    y, x = np.nonzero((canvas.pixels[..., :3] == colours[-1]).all(axis=2))
    assert shapely.contains_xy(last.buffer(1.0), x, y).all()
    assert len(x) > 0.5 * last.area, "all but its edge and its mark"


def test_a_dashed_line_beyond_the_picture_takes_no_more_dashes_than_are_seen():
    corner = np.zeros(2)
    lines = np.array([[[-1.0e12, 40.0], [1.0e12, 40.0]], [[-9.0e11, 1.0e3], [9.0e11, 1.0e3]]])
    canvas = Canvas((100, 80), palette.OUTSIDE)
    world = Ground(
        [Item("path", list(lines), "band", 1.0, Level.PATH, (5.0, 5.0))], (corner, corner)
    )
    draw_ground(canvas, world, Lens(1.0, 0.0, 80.0))
    drawn = (canvas.pixels[40, :, :3] != palette.OUTSIDE).any(axis=1)
    assert 50 <= drawn.sum() <= 80  # five of ten pixels, and their soft ends
    assert drawn[:11].any()
    assert drawn[-11:].any()


def test_settings_go_on_in_further_lines_and_none_is_lost_while_there_is_room():
    settings = "horizon 4, beta 0.3, time_low 1.2, time_high 2.5, look_ahead 2.5"
    lines = wrapped(settings, SMALL, 200, 3)
    assert " ".join(lines) == settings
    assert 1 < len(lines) <= 3
    assert max(width(line, SMALL) for line in lines) <= 200
    assert wrapped(settings, SMALL, 200, 1)[0].endswith("…")
    assert wrapped("", SMALL, 200, 3) == []


def test_the_legend_lists_what_can_appear(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    def listed(**changes: Any) -> set[str]:
        record = changed(made(3), **changes)
        return set(signs(Timeline(record), ground(Timeline(record))))

    low = np.array([[0.0, -4.0], [80.0, -4.0], [80.0, 3.0], [0.0, 3.0]])  # the path bends out of it
    wide = 100.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    updates = made(3).updates.copy()
    updates["target_x"] = np.nan
    dashed, areas = "path, dashed in danger area", {"safe area", "danger area"}
    common = {"contact", "a contact begins", "closest pair", "target", "trail, last 10 s",
              "reference path", "boundary"}  # fmt: skip
    assert listed(safe=[low]) == common | areas | {dashed}
    assert listed(safe=[wide]) >= areas | {"path"}
    assert listed(safe=()) == common | {dashed, "danger area"}
    assert listed(safe_distance=0.0) == common | {"path", "accessible area"}
    assert "target" not in listed(updates=updates)
    assert "closest pair" not in signs(Timeline(made(1)), ground(Timeline(made(1))))


@examples(25, deep=200)
@given(
    st.lists(st.tuples(st.integers(0, 11), st.integers(1, 7)), min_size=1, max_size=8, unique=True),
    st.integers(20, 60),
)
def test_labels_overlap_no_other_and_no_robot_and_stay_in_the_view(
    cells: list[tuple[int, int]], wide: int
) -> None:
    places = np.array(cells, dtype=float) * (50.0, 50.0) + (25.0, 0.0)
    bodies = np.column_stack((places - (15.0, 8.0), places + (15.0, 8.0)))
    labels = {k: Label(tuple(at), 17.0, (float(wide), 20.0)) for k, at in enumerate(places)}
    nowhere = np.zeros((0, 2, 2))
    middles = Labels().place(labels, bodies, (600, 400), np.arange(len(bodies)), nowhere)
    half = np.array([wide / 2.0, 10.0])
    corners = np.column_stack((np.array(middles) - half, np.array(middles) + half))
    assert (corners >= 0.0).all()
    assert (corners[:, 2:] <= (600.0, 400.0)).all()
    rects = [shapely.box(*box) for box in (*corners, *bodies)]
    for k, one in enumerate(rects[: len(cells)]):
        assert all(one.intersection(b).area < 1.0 for j, b in enumerate(rects) if j != k)
