from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from physim.drawing import palette
from physim.drawing.video import frame_at, scale
from tests.helpers import inside
from tests.helpers.records import BOX, ELL

Label, clean, leader, metres = inside("physim.drawing", "Label", "clean", "leader", "metres")
number, plain, shortened = inside("physim.drawing", "number", "plain", "shortened")
significant, spread, ticks = inside("physim.drawing", "significant", "spread", "ticks")
Timeline = inside("physim.drawing", "Timeline")
Closest, pairs_within = inside("physim.drawing.video", "Closest", "pairs_within")
Background, Ground, Stroke = inside("physim.drawing.video", "Background", "Ground", "Stroke")
draw_ground, ground, ONE = inside("physim.drawing.video", "draw_ground", "ground", "ONE")
SMALL, arrange, signs, Fleet = inside("physim.drawing.video", "SMALL", "arrange", "signs", "Fleet")
draw_reference_point, Labels = inside("physim.drawing.video", "draw_reference_point", "Labels")
LONGEST, draw_scale, shorten = inside("physim.drawing.video", "LONGEST", "draw_scale", "shorten")
sprite, stamp, width = inside("physim.drawing.video", "sprite", "stamp", "width")
wrapped, Camera, Lens = inside("physim.drawing.video", "wrapped", "Camera", "Lens")
FloatArray = inside("physim.geometry", "FloatArray")

numbers = st.floats(-300.0, 300.0, allow_nan=False)


@given(st.lists(numbers, max_size=9))
def test_names_are_spread_within_the_plot(values: list[float]) -> None:
    places = spread(np.sort(np.array(values, dtype=float)), 13.0, 20.0, 140.0)
    assert len(places) == len(values)
    assert (np.diff(places) >= 13.0 - 1e-9).all()
    assert ((places >= 20.0 - 1e-9) & (places <= 140.0 + 1e-9)).all()


def test_names_with_room_stay() -> None:
    assert spread(np.array([30.0, 50.0, 90.0]), 13.0, 0.0, 100.0).tolist() == [30.0, 50.0, 90.0]
    assert spread(np.array([50.0, 50.0]), 10.0, 0.0, 100.0).tolist() == [45.0, 55.0]


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(1, 10))
def test_ticks_are_few_and_inside(low: float, span: float, most: int) -> None:
    found = ticks(low, low + span, most)
    assert len(found) <= most + 1
    assert all(low - 1e-6 * span <= t <= low + span * (1 + 1e-6) for t, _ in found)


def test_numbers() -> None:
    assert [number(v, 0.5) for v in (-0.0, 1.5, -2.0)] == ["0.0", "1.5", "−2.0"]
    assert number(50.0, 50.0) == "50"
    assert [metres(v) for v in (1.234, 0.0999, -0.0123, 0.0)] == [
        "1.23 m", "0.10 m", "−0.012 m", "0.000 m",
    ]  # fmt: skip


def test_small_lengths_are_written_without_an_exponent() -> None:
    assert [plain(v) for v in (1.234e-5, -2e-7, 0.0, 0.5, 12.34, 1234.0)] == [
        "0.0000123", "-0.0000002", "0", "0.5", "12.3", "1230",
    ]  # fmt: skip
    assert [significant(v) for v in (1e-5, 0.25, 2.0)] == ["0.00001", "0.25", "2.00"]


@given(st.floats(1e-5, 1e5))
@example(50.0)
@example(480.0)
@example(4_800.0)
def test_words_of_a_scale_bar_are_its_length(pixels: float) -> None:
    image = np.full((20, 200, 3), 255, np.uint8)
    with pytest.MonkeyPatch.context() as patch:
        said: list[str] = []
        patch.setattr(scale, "write", lambda _image, text, *_place: said.append(text))
        draw_scale(image, 10, 10, pixels)
    drawn = int((image[10] == palette.INK).all(axis=1).sum()) - 3  # two ends of lines of 2 px
    assert 0.4 * LONGEST - 1 <= drawn <= LONGEST
    words, unit = said[0].split()
    assert unit == "m"
    assert float(words) * pixels == pytest.approx(drawn, abs=1.0)


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
    pictures = [sprite(text, 14, palette.INK)[1] for text in ("日", "本", "é", "e", "Ж")]
    shapes = {picture.tobytes() for picture in pictures}
    assert len(shapes) == 5


def test_a_sprite_is_clipped_at_every_edge() -> None:
    image = np.full((20, 20, 3), 255, np.uint8)
    for left, top in ((-500, 5), (5, -500), (15, 15), (-5, -5), (500, 500)):
        stamp(image, sprite("name", 14, palette.INK), left, top)
    assert image.shape == (20, 20, 3)


def test_tiles_show_no_seams(made: Callable[..., Any]) -> None:
    world = ground(Timeline(made(3)))
    lens = Lens(31.7, 40.0, 611.0)
    cut = np.zeros((720, 1280, 3), np.uint8)
    Background(world, lens.scale).paint(cut, lens)
    whole = np.zeros((720 + 64, 1280 + 64, 3), np.uint8)
    draw_ground(whole, world, Lens(lens.scale, lens.x + 32, lens.y + 32))
    difference = np.abs(cut.astype(int) - whole[32:-32, 32:-32]).max(axis=2)
    assert (difference > 40).sum() < 60, "long lines may differ by rounding only"
    assert len(np.unique(cut.reshape(-1, 3), axis=0)) > 10


def test_a_small_world_is_shown_whole_and_a_long_one_followed(made: Callable[..., Any]) -> None:
    timeline, box = Timeline(made(3)), arrange()[0]
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


def test_the_camera_goes_with_the_robot(made: Callable[..., Any]) -> None:
    timeline, box = Timeline(made(1, 20.0)), arrange()[0]
    camera = Camera(timeline, (np.array([-2.0, -5.0]), np.array([200.0, 80.0])), box, 1.0)
    for time in (0.0, 5.0, 12.0, 20.0):
        place = camera.lens(time).pixels(timeline.pose(time)[0, :2])
        assert (place > 20.0).all()
        assert (place < np.array([box.width, box.height]) - 20.0).all()


def test_one_camera_movement_however_asked(made: Callable[..., Any]) -> None:
    timeline, box = Timeline(made(3)), arrange()[0]
    large = (np.array([-2.0, -5.0]), np.array([200.0, 80.0]))
    one, two = Camera(timeline, large, box, 1.0), Camera(timeline, large, box, 1.0)
    one.lens(3.0)
    assert one.lens(1.0) == two.lens(1.0)
    steps = np.diff([two.centre(t) for t in np.arange(0.0, 4.0, 0.04)], axis=0)
    assert np.hypot(*steps.T).max() < 0.1, "no jump: the robots go at 1 m/s"


poses = st.lists(
    st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-4, 4)), min_size=2, max_size=6
)


@given(poses)
@example([(0.0, 0.0, 0.0), (0.0, 1.7, 0.0), (2.45, 0.0, 0.0)])
def test_the_closest_pair_is_the_closest(rows: list[tuple[float, float, float]]) -> None:
    pose = np.array(rows)
    footprints: list[tuple[FloatArray, ...]] = [
        ELL if i % 4 == 3 else (BOX,) for i in range(len(pose))
    ]
    reach = np.array([np.hypot(*np.concatenate(parts).T).max() for parts in footprints])
    pair = Closest(footprints, reach).pair(pose)
    assert pair is not None
    shapes = [
        shapely.union_all([turned(part, row) for part in parts])
        for parts, row in zip(footprints, pose, strict=True)
    ]
    a, b = np.triu_indices(len(pose), 1)
    least = min(shapes[i].distance(shapes[j]) for i, j in zip(a, b, strict=True))
    assert pair.distance == pytest.approx(least, abs=1e-9)
    assert shapes[pair.a].distance(shapes[pair.b]) == pytest.approx(least, abs=1e-9)
    assert np.hypot(*(pair.points[1] - pair.points[0])) == pytest.approx(least, abs=1e-9)


def test_of_a_crowd_the_closest_pair_is_the_closest() -> None:
    """Against every pair; some robots overlap, some stand at one place, some are far away."""
    random = np.random.default_rng(5)
    for count, span in ((65, 30.0), (150, 12.0), (200, 300.0), (70, 0.0)):
        pose = np.column_stack(
            (random.uniform(0.0, span, (count, 2)), random.uniform(-3, 3, count))
        )
        pose[-1, :2] += 1e4
        footprints = [ELL if i % 4 == 3 else (BOX,) for i in range(count)]
        reach = np.array([np.hypot(*np.concatenate(parts).T).max() for parts in footprints])
        pair = Closest(footprints, reach).pair(pose)
        assert pair is not None
        shapes = np.array(
            [
                shapely.MultiPolygon([turned(part, row) for part in parts])
                for parts, row in zip(footprints, pose, strict=True)
            ]
        )
        a, b = np.triu_indices(count, 1)
        distance = shapely.distance(shapes[a], shapes[b])
        assert pair.distance == pytest.approx(distance.min(), abs=1e-9)
        assert shapes[pair.a].distance(shapes[pair.b]) == pytest.approx(pair.distance, abs=1e-9)


@given(
    st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=1, max_size=40),
    st.floats(0.1, 30.0),
)
def test_no_pair_within_a_distance_is_missed(rows: list[tuple[float, float]], far: float) -> None:
    places = np.array(rows)
    a, b = pairs_within(places, far)
    found = set(zip(a.tolist(), b.tolist(), strict=True))
    assert len(found) == len(a)
    assert all(one < other for one, other in found)
    one, other = np.triu_indices(len(places), 1)
    near = np.hypot(*(places[one] - places[other]).T) <= far
    assert set(zip(one[near].tolist(), other[near].tolist(), strict=True)) <= found


def turned(part: FloatArray, pose: FloatArray) -> shapely.Polygon:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return shapely.Polygon([(c * x - s * y + pose[0], s * x + c * y + pose[1]) for x, y in part])


@given(poses)
def test_robots_are_drawn_at_their_poses(rows: list[tuple[float, float, float]]) -> None:
    fleet, pose = Fleet([ELL if i % 2 else (BOX,) for i in range(len(rows))]), np.array(rows)
    lens = Lens(100.0, 0.0, 0.0)
    for figure, outline, row in zip(
        fleet.figures, fleet.split(lens.fixed(fleet.placed(pose))), pose, strict=True
    ):
        for own, drawn in zip((*figure.rings, figure.mark), (*outline.rings, outline.mark),
                              strict=True):  # fmt: skip
            expected = lens.pixels(shapely.get_coordinates(turned(own, row))[:-1])
            assert np.abs(drawn / ONE - expected).max() <= 0.5 / ONE + 1e-6


def test_a_robot_of_several_parts_has_one_outline_and_a_mark_inside() -> None:
    shape = Fleet([ELL]).figures[0]
    assert len(shape.rings) == 1
    area = sum(shapely.Polygon(part).area for part in ELL)
    assert shapely.Polygon(shape.rings[0]).area == pytest.approx(area, rel=1e-4)
    assert shapely.Polygon(shape.rings[0]).contains(shapely.Polygon(shape.mark))
    assert shape.mark[0, 0] > shape.mark[1:, 0].max(), "it points forward"


def test_the_legend_lists_what_can_appear(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    def listed(record: Any) -> list[str]:
        return signs(Timeline(record), ground(Timeline(record)))

    low = np.array([[0.0, -4.0], [80.0, -4.0], [80.0, 3.0], [0.0, 3.0]])  # it bends out of it
    record = changed(made(3), safe=[low])
    full = ["contact", "a contact begins", "closest pair", "target", "trail, last 10 s"]
    areas = ["safe area", "danger area"]
    assert listed(record) == [*full, "path, dashed in danger area", "reference path", "boundary",
                              *areas]  # fmt: skip
    found = listed(changed(record, safe_distance=0.0))
    assert found == [*full, "path", "reference path", "boundary", "accessible area"]
    nowhere_safe = listed(changed(record, safe=()))
    assert nowhere_safe == [*full, "path, dashed in danger area", "reference path", "boundary",
                            "danger area"]  # fmt: skip
    assert "closest pair" not in listed(made(1))
    updates = record.updates.copy()
    updates["target_x"] = np.nan
    assert "target" not in listed(changed(record, updates=updates))
    wide = [100.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])]
    found = listed(changed(record, safe=wide))
    assert "path" in found
    assert "path, dashed in danger area" not in found
    assert set(areas) < set(found)


def test_without_safe_areas_nothing_is_drawn_as_danger(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    picture = frame_at(changed(made(1), safe_distance=0.0), 2.0)
    for colour in (palette.DANGER_AREA, palette.SAFE_AREA):
        assert (picture == colour).all(axis=2).sum() < 10, "single pixels of trails may be alike"
    assert (picture == palette.FLOOR).all(axis=2).sum() > 100_000


def test_a_reference_point_far_from_the_centroid_is_shown() -> None:
    aside = ELL[0] + np.array([0.9, 0.5])
    assert [f.eccentric for f in Fleet([[BOX], [aside]]).figures] == [False, True]
    view = np.zeros((21, 21, 3), np.uint8)
    draw_reference_point(view, Lens(10.0, 0.0, 0.0), np.array([1.0, -1.0]))
    assert tuple(view[10, 10]) == palette.INK
    assert tuple(view[0, 0]) == (0, 0, 0)


def test_labels_of_robots_side_by_side_do_not_overlap() -> None:
    boxes = np.array([[x, 200.0, x + 40.0, 230.0] for x in (100.0, 145.0, 190.0, 235.0)])
    labels = {i: Label((b[0] + 20.0, 215.0), 21.0, (60.0, 24.0)) for i, b in enumerate(boxes)}
    middles = Labels().place(labels, boxes, (600, 400))
    rects = [shapely.box(x - 30, y - 12, x + 30, y + 12) for x, y in middles]
    rects += [shapely.box(*box) for box in boxes]
    overlaps = [a.intersection(b).area for k, a in enumerate(rects) for b in rects[:k]]
    assert max(overlaps) == 0.0


def test_a_label_is_near_its_own_robot_and_on_no_wall() -> None:
    shape = np.array([[-30.0, -12.0], [30.0, -12.0], [30.0, 12.0], [-30.0, 12.0]])
    robot = {0: Label((300.0, 200.0), 30.0, (40.0, 20.0), shape)}
    boxes = np.array([[270.0, 188.0, 330.0, 212.0], [280.0, 130.0, 320.0, 165.0]])
    (x, y) = Labels().place(robot, boxes[:1], (600, 400))[0]
    assert (x, y) == pytest.approx((300.0, 176.0)), "2 px above the body, not above a disc"
    (x, y) = Labels().place(robot, boxes, (600, 400))[0]
    label = shapely.box(x - 20, y - 10, x + 20, y + 10)
    own, other = (label.distance(shapely.box(*box)) for box in boxes)
    assert own < 15.0
    assert other > own + 5.0
    wall = np.array([[[0.0, 176.0], [600.0, 176.0]]])
    (x, y) = Labels().place(robot, boxes[:1], (600, 400), None, wall)[0]
    assert not shapely.box(x - 20, y - 10, x + 20, y + 10).intersects(shapely.LineString(wall[0]))


def test_a_label_far_from_its_robot_has_a_leader() -> None:
    shape = np.array([[-9.0, -5.0], [9.0, -5.0], [9.0, 5.0], [-9.0, 5.0]])
    label = Label((100.0, 100.0), 10.0, (40.0, 20.0), shape)
    assert leader(label, np.array([100.0, 82.0]), 20.0) is None
    line = leader(label, np.array([100.0, 50.0]), 20.0)
    assert line is not None
    assert line.tolist() == [[100.0, 95.0], [100.0, 60.0]]


def test_a_label_stays_in_the_view() -> None:
    label = Label((10.0, 8.0), 20.0, (60.0, 20.0))
    (x, y) = Labels().place({0: label}, np.zeros((0, 4)), (600, 400))[0]
    assert x >= 30.0
    assert y >= 10.0


@pytest.mark.parametrize(
    ("text", "fits", "expected"),
    [
        ("boat_12", 7, "boat_12"),
        ("boat_12", 6, "boa…12"),
        ("boat_12", 3, "…12"),
        ("boat_12", 2, "b…"),
        ("boat-7", 4, "bo…7"),
        ("starboard", 5, "star…"),
        ("speed=1.25, strength=12", 9, "speed=1.…"),
        ("20261123", 4, "202…"),
    ],
)
def test_a_name_that_is_cut_keeps_its_number_and_a_sentence_does_not(text, fits, expected):
    assert shortened(text, fits) == expected


def test_a_dashed_line_beyond_the_picture_takes_no_more_dashes_than_are_seen():
    colour, corner = (10, 200, 30), np.zeros(2)
    lines = np.array([[[-1.0e12, 40.0], [1.0e12, 40.0]], [[-9.0e11, 1.0e3], [9.0e11, 1.0e3]]])
    image = np.zeros((80, 100, 3), np.uint8)
    world = Ground((), (Stroke(lines, colour, 1, (5.0, 5.0)),), (corner, corner))
    draw_ground(image, world, Lens(1.0, 0.0, 80.0))
    drawn = (image[40] != palette.OUTSIDE).any(axis=1)
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
