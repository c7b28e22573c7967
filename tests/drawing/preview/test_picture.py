"""The picture shows every thing at its place, and stays whole for any world."""

from __future__ import annotations

import itertools
import subprocess
import sys
import warnings
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import shapely
from matplotlib.colors import to_rgba
from matplotlib.text import Text

from physim.drawing.preview import make_figure, preview_of, save_preview
from physim.errors import PhysimError
from physim.world.file import load_world, parse_world
from tests.drawing.preview.worlds import (
    HOSTILE,
    HOSTILE_NAMES,
    HUNDRED,
    MANY,
    NARROW,
    ONE,
    WORLDS,
    shown,
)
from tests.helpers import inside

BAND, ROBOTS, hexed = inside("physim.drawing", "BAND", "ROBOTS", "hexed")
FEW_NAMED, styled = inside("physim.drawing.plots", "FEW_NAMED", "styled")
shipped_worlds = inside("physim.world.file", "shipped_worlds")
lay_out = inside("physim.world.layout", "lay_out")


@pytest.fixture
def style() -> Iterator[None]:
    with styled(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        yield


def collection(axis: Any, name: str) -> Any:
    (found,) = [c for c in (*axis.collections, *axis.patches, *axis.lines) if c.get_gid() == name]
    return found


def boxes(axis: Any) -> list[tuple[str, Any]]:
    return [(text.get_text(), Text.get_window_extent(text)) for text in axis.texts]


def test_everything_is_at_its_place(style: None) -> None:
    seen = shown(NARROW)
    plan, profile = make_figure(seen).axes
    bodies = [one.get_path().vertices[:-1] for one in plan.patches if one.get_gid() == "robot"]
    for body, outline in zip(bodies, seen.scene.starting, strict=True):
        assert shapely.Polygon(body).equals_exact(shapely.Polygon(outline), 1e-9, normalize=True)
    stops = [one.get_xydata()[0] for one in plan.lines if one.get_gid() == "stop"]
    assert np.allclose(stops, seen.scene.stops)
    headings = collection(plan, "headings").get_segments()
    for line, pose, reach in zip(headings, seen.scene.start, seen.scene.reach, strict=True):
        assert np.allclose(line[0], pose[:2])
        way = line[1] - line[0]
        assert np.arctan2(way[1], way[0]) == pytest.approx(pose[2])
        assert np.hypot(*way) > reach
    walls = collection(plan, "boundary").get_segments()
    assert all(np.allclose(a, b) for a, b in zip(walls, seen.scene.boundaries, strict=True))
    (solid,) = [one for one in plan.patches if one.get_gid() == "obstacle"]
    drawn = shapely.Polygon(solid.get_path().vertices)
    assert drawn.equals(shapely.Polygon(seen.scene.obstacles[0]))
    bar = collection(plan, "narrowest").get_xydata()
    assert np.hypot(*(bar[0] - bar[-1])) == pytest.approx(1.5)
    assert "1.50 m" in [text.get_text() for text in plan.texts]
    (curve,) = [line for line in profile.lines if line.get_gid() == "width"]
    assert np.nanmin(curve.get_ydata()) == pytest.approx(1.5)
    level_lines = [line for line in profile.lines if line.get_gid() != "leader"]
    levels = [line.get_ydata()[0] for line in level_lines if len(line.get_ydata()) == 2]
    reach = seen.scene.reach.max()
    assert sorted(levels) == pytest.approx(
        sorted([0.6, 2.0 * reach, 2.0 * seen.scene.safe_distance])
    )


@pytest.mark.parametrize("name", WORLDS)
def test_any_world_has_the_same_layout_in_which_no_labels_overlap(name: str, style: None) -> None:
    seen = shown(WORLDS[name])
    figure, first = make_figure(seen), make_figure(shown(ONE))
    for axis, other in zip(figure.axes, first.axes, strict=True):
        assert np.allclose(axis.get_position().bounds, other.get_position().bounds)
    plan = figure.axes[0]
    (x0, x1), (y0, y1) = plan.get_xlim(), plan.get_ylim()
    low, high = seen.scene.extent
    assert x0 < low[0] < high[0] < x1
    assert y0 < low[1] < high[1] < y1
    wide, high_inches = figure.get_size_inches() * plan.get_position().size
    assert (x1 - x0) / wide == pytest.approx((y1 - y0) / high_inches, rel=1e-6)
    for axis in figure.axes[:2]:
        found = boxes(axis)
        for (one, a), (another, b) in itertools.combinations(found, 2):
            shared = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
            assert min(shared) <= 0.5, (one, another)
        for text, box in found:
            assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width, text


def test_names_that_the_font_lacks_are_numbers_and_long_ones_are_cut(style: None) -> None:
    figure = make_figure(shown(HOSTILE))
    texts = [text.get_text() for text in figure.axes[0].texts]
    if matplotlib.rcParams["font.family"] == ["DejaVu Sans"]:
        assert "robot 5" in texts  # five Chinese signs
        assert "机器人" not in texts
    assert HOSTILE_NAMES[2] in texts
    assert "x" * 23 + "…" in texts
    assert figure.texts[1].get_text().endswith("…")


def test_each_name_stands_beside_its_own_robot_in_its_colour(style: None) -> None:
    """Nearer to it than to any other, or with a line to it."""
    seen = preview_of(lay_out(load_world("ten_robots")))
    figure = make_figure(seen)
    plan, places = figure.axes[0], seen.scene.start[:, :2]
    found = boxes(plan)
    for robot, name in enumerate(seen.scene.names):
        (k,) = [k for k, (words, _) in enumerate(found) if words == name]
        assert plan.texts[k].get_color() == hexed(seen.scene.colours[robot])
        box = shapely.box(*plan.transData.inverted().transform(found[k][1].get_points()).ravel())
        away = shapely.distance(shapely.points(places), box)
        joined = plan.texts[k].arrow_patch.get_visible() and np.allclose(
            plan.texts[k].xy, places[robot]
        )
        assert int(np.argmin(away)) == robot or joined, name


def test_a_crowd_has_one_colour_and_few_names(style: None) -> None:
    """Colours that come again tell nobody apart, and names and rings hide what they are of."""
    figure = make_figure(shown(HUNDRED))
    plan = figure.axes[0]
    (robots,) = [one for one in plan.patches if one.get_gid() == "robot"]
    assert robots.get_facecolor() == to_rgba(hexed(BAND))
    named = sum(text.get_text().startswith("robot") for text in plan.texts)
    assert 5 < named <= FEW_NAMED
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert [text for text in words if "100 robots" in text]
    forty = make_figure(shown(MANY))
    robots = [one for one in forty.axes[0].patches if one.get_gid() == "robot"]
    faces = np.array([one.get_facecolor() for one in robots])
    assert np.allclose(faces[:10, :3] * 255.0, ROBOTS)


SOME = ("three_robots", "doorway", "warehouse")
"""Drawn in the fast tier"""


@pytest.mark.parametrize(
    "name",
    [k if k in SOME else pytest.param(k, marks=pytest.mark.deep) for k in sorted(shipped_worlds())],
)
def test_every_shipped_world_is_drawn_with_its_least_width_clear_of_the_lines(
    name: str, tmp_path: Path
) -> None:
    with styled():
        figure = make_figure(preview_of(lay_out(load_world(name))))
        axis = figure.axes[1]
        (text,) = [t for t in axis.texts if t.get_text().startswith("narrowest")]
        box = Text.get_window_extent(text)
        (curve,) = [line for line in axis.lines if line.get_gid() == "width"]
        x, y = curve.get_transform().transform(curve.get_xydata()).T
        frame = axis.get_window_extent()
    assert not ((x > box.x0) & (x < box.x1) & (y > box.y0) & (y < box.y1)).any()
    assert frame.x0 <= box.x0 < box.x1 <= frame.x1
    assert frame.y0 <= box.y0 < box.y1 <= frame.y1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        save_preview(lay_out(load_world(name)), tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    assert [file.name for file in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_the_same_world_gives_the_same_file(ending: str, tmp_path: Path) -> None:
    for name in "ab":
        save_preview(lay_out(parse_world(HOSTILE)), tmp_path / f"{name}.{ending}")
    assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


def test_an_svg_is_valid_and_its_text_is_text(tmp_path: Path) -> None:
    save_preview(lay_out(parse_world(HOSTILE)), tmp_path / "a.svg")
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    texts = ["".join(e.itertext()) for e in root.iter("{http://www.w3.org/2000/svg}text")]
    for name in HOSTILE_NAMES:
        assert (name if len(name) <= 24 else name[:23] + "…") in texts
    tags = {element.tag.rpartition("}")[2] for element in root.iter()}
    assert not tags & {"script", "b", "img", "image", "foreignObject"}
    assert not [k for e in root.iter() for k in e.attrib if k.startswith("on")]
    assert not any("date" in e.tag.lower() for e in root.iter())


@pytest.mark.parametrize("name", ["a.pdf", "a", "a.png/b.svg"])
def test_what_cannot_be_written_is_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "a.png").write_text("a file")
    with pytest.raises(PhysimError):
        save_preview(lay_out(parse_world(ONE)), tmp_path / name)
    assert [file.name for file in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.deep
def test_no_engine_record_or_video_is_loaded(tmp_path: Path) -> None:
    script = (
        "import sys; from physim.cli import main\n"
        f"main(['preview', 'ten_robots', '-o', {str(tmp_path / 'a.png')!r}])\n"
        "heavy = 'pymunk', 'h5py', 'imageio_ffmpeg', 'scipy'\n"
        "print([module for module in heavy if module in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]", done.stderr
