"""Movers and obstacles to push are seen where they are, at every time, in every kind of picture."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim.analysis.summary import summarise
from physim.drawing.preview import save_preview
from physim.record import Record
from physim.world.file import parse_world
from tests.drawing import palette
from tests.drawing.browser.conftest import browser
from tests.drawing.browser.driver import Seen
from tests.drawing.video.looking import VIEW, around, pixels
from tests.helpers import inside
from tests.helpers.unpacking import unpack

__all__ = ["browser"]
MOVER, OBSTACLE = inside("physim.drawing", "MOVER", "OBSTACLE")
SceneModel, Timeline = inside("physim.drawing", "SceneModel", "Timeline")
closest, frame_at = inside("physim.drawing.video", "closest", "frame_at")
between, run_data = inside("physim.drawing.page", "between", "run_data")
lay_out = inside("physim.world.layout", "lay_out")
distances, styled, trajectories = inside(
    "physim.drawing.plots", "distances", "styled", "trajectories"
)

WORLD = """
name: yard
time: {step: 0.02, duration: 6}
boundaries: [[[0, 0], [16, 0], [16, 9], [0, 9], [0, 0]]]
reference_path: [[2, 4], [14, 4]]
robots:
  - {name: r1, footprint: {length: 1.0, width: 0.6}, pose: [2, 4, 0], path: {offset: 0}, mass: 60}
movers:
  - name: cart
    footprint: [[0.8, 0], [-0.6, 0.6], [-0.6, -0.6]]
    waypoints: [[9, 1.5, 0], [11, 3.5, 1.5], [11, 6.5, 1.5]]
    speed: 1.0
    repeat: to_and_fro
obstacles:
  - {corners: [[5, 3.6], [5.8, 3.6], [5.8, 4.4], [5, 4.4]], mass: 20}
  - [[1, 7], [2, 7], [2, 8]]
controller: {type: path_following}
"""
CART, BOX = 1, 2


@pytest.fixture(scope="module")
def record() -> Iterator[Record]:
    with physim.simulate(parse_world(WORLD)) as made:
        yield made


def test_a_frame_has_them_where_they_are(record: Record) -> None:
    """In their colours round their places, and not where they were; the box as it is pushed."""
    for time in (1.0, 3.0, 5.0):
        image, pose = frame_at(record, time, speed=1.0), record.pose_at(round(time / record.dt))
        for body, colour in ((CART, MOVER), (BOX, OBSTACLE)):
            place = pose[body, :2] + (
                0.0,
                0.25 if body == BOX else 0.0,
            )  # beside what it is joined to
            part = around(record, time, place, 2)
            assert pixels(image, colour, part) == 25
        gone = around(record, time, record.pose_at(0)[CART, :2] - (0.4, 0.0), 2)
        assert pixels(image, MOVER, gone) == 0
        assert pixels(image, MOVER, VIEW) > 500
    assert np.hypot(*(record.pose_at(250) - record.pose_at(0))[BOX, :2]) > 1.0


def test_the_closest_pair_may_be_a_robot_and_what_it_pushes(record: Record) -> None:
    pair = closest(timeline := Timeline(record), timeline.at(5.0))
    assert (pair.a, pair.b) == (0, BOX)
    assert pair.distance == pytest.approx(float(record.clearance[250, 0]))
    pair = closest(timeline, timeline.at(0.0))
    assert (pair.a, pair.b) == (0, BOX)
    assert pair.distance == pytest.approx(2.5)


def test_pages_have_their_poses_ways_and_pairs(record: Record) -> None:
    header, arrays = unpack(run_data(record, summarise(record)))
    assert len(arrays["knots"]) == record.moving == 3
    assert header["robots"] == 1
    assert [one["robots"] for one in header["scene"]["paths"]] == [[0], [CART]]
    first = int(arrays["knots"][:CART].sum())
    mine = slice(first, first + int(arrays["knots"][CART]))
    steps = arrays["knot_step"][mine]
    pose = np.column_stack([arrays[f"knot_{k}"][mine] for k in ("x", "y", "heading")])
    at = np.arange(int(steps[-1]))
    k = np.searchsorted(steps, at, side="right") - 1
    drawn = between(pose[k], pose[k + 1], (at - steps[k]) / (steps[k + 1] - steps[k]))
    assert np.abs(drawn - record.moving_pose[at, CART]).max() <= header["tolerance"]
    assert set(arrays["now_a"]) == {0}
    assert set(arrays["now_b"]) == {BOX}


def test_a_preview_and_a_record_show_the_same_ones(record: Record, tmp_path: Path) -> None:
    layout = lay_out(parse_world(WORLD))
    save_preview(layout, tmp_path / "yard.svg")
    drawn = (tmp_path / "yard.svg").read_text()
    assert "cart" in drawn
    assert "obstacle 1" in drawn  # that can be pushed
    assert "obstacle 2" not in drawn
    assert palette.hexed(MOVER) in drawn
    before, after = SceneModel.of_layout(layout), SceneModel.of_record(record)
    assert before.bodies == after.bodies
    assert np.allclose(np.concatenate(before.moved_starting), np.concatenate(after.moved_starting))
    (way,) = before.ways[0]
    assert np.array_equal(way, after.ways[0][0])
    where = record.moving_pose[:, CART, :2]
    off = np.hypot(*(where[:, None] - way[None]).transpose(2, 0, 1)).min(axis=1)[:100]
    assert off.max() < 0.06  # between places of the arc


def test_plots_draw_them_beside_the_robots(record: Record) -> None:
    with styled():
        axis = trajectories(record).axes[0]
        assert "r1 and obstacle 1" in distances(record).legends[0].get_texts()[0].get_text()
    drawn = {one.get_gid(): one for one in axis.collections}
    assert len(drawn["mover"].get_paths()) == len(drawn["obstacle"].get_paths()) > 3
    assert drawn["mover"].get_label() == "cart"


@pytest.mark.deep
def test_the_browser_draws_them(browser: Any, record: Record, tmp_path: Path) -> None:
    seen = Seen(browser, physim.page(record).write(tmp_path / "yard.html"))
    pose = np.reshape(seen.drawn_at(3.0)["pose"], (-1, 3))
    assert np.abs(pose - record.pose_at(150)).max() < 0.005
    colour = seen.ask(
        "(({lens, pose, ratio}, body) => [...physim.view.context.getImageData("
        "ratio * (pose[3 * body] * lens.scale + lens.x),"
        "ratio * (lens.y - pose[3 * body + 1] * lens.scale), 1, 1).data])"
        f"(physim.view.drawn, {CART})"
    )
    assert tuple(colour[:3]) == MOVER
    assert not seen.faults
    seen.close()
