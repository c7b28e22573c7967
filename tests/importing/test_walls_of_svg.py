"""Walls of a drawing that has no layer for them: named by the user, or told which could be."""

from __future__ import annotations

from pathlib import Path

import pytest
import shapely

from physim.authoring.importing import Options, import_world
from physim.errors import PhysimError

PLAN = """\
<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">
  <g id="floor">
    <g id="outline"><path id="rim" fill="none" stroke="black" d="M 2,2 H 28 V 13 H 2 Z"/></g>
    <rect id="desk" x="10" y="6" width="2" height="1"/>
    <g><rect x="20" y="5" width="1" height="3"/></g>
  </g>
</svg>
"""


def drawing(folder: Path, text: str = PLAN) -> Path:
    path = folder / "plan.svg"
    path.write_text(text, encoding="utf-8")
    return path


def refusal(path: Path, *boundary: str) -> str:
    with pytest.raises(PhysimError) as caught:
        import_world(path, Options(scale=1.0, boundary=boundary))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_it_is_told_which_walls_are_not_seen(tmp_path: Path) -> None:
    """What has neither area nor line is shown by no program, though it was perhaps meant."""
    plan = PLAN.replace(' stroke="black"', "")
    told = refusal(drawing(tmp_path, plan))
    for part in ("no line is a boundary", "line 3: hidden <path> rim"):
        assert part in told
    asked = import_world(drawing(tmp_path, plan), Options(scale=1.0, boundary=("rim",)))
    assert asked.world.boundaries, "a shape that is asked for by its name"


def test_it_is_told_which_shapes_could_be_walls(tmp_path: Path) -> None:
    told = refusal(drawing(tmp_path))
    assert told.startswith(f"{tmp_path}/plan.svg: ")
    for part in (
        "--boundary ID",
        '"rim" (line 3, 26 x 11 m)',
        '"desk" (line 4, 2 x 1 m)',
        '"floor" (line 5, 1 x 3 m)',
    ):
        assert part in told
    assert told.index('"rim"') < told.index('"floor"') < told.index('"desk"')


@pytest.mark.parametrize("name", ["rim", "outline"])
def test_a_shape_or_its_group_is_taken_for_a_wall(tmp_path: Path, name: str) -> None:
    world = import_world(drawing(tmp_path), Options(scale=1.0, boundary=(name,))).world
    (wall,) = world.boundaries
    assert {tuple(point) for point in wall} == {(2, 2), (28, 2), (28, 13), (2, 13)}
    assert not world.obstacles


def test_several_may_be_walls(tmp_path: Path) -> None:
    path = drawing(tmp_path)
    world = import_world(path, Options(scale=1.0, boundary=("rim", "desk"))).world
    assert len(world.boundaries) + len(world.obstacles) == 2


def test_an_id_that_is_not_there_is_refused_with_the_nearest(tmp_path: Path) -> None:
    assert '"outline"' in refusal(drawing(tmp_path), "outlines")
    assert '"rim"' in refusal(drawing(tmp_path), "zzz")


def test_names_of_shapes_cannot_act_on_a_terminal(tmp_path: Path) -> None:
    told = refusal(drawing(tmp_path, PLAN.replace('id="rim"', 'id="r&#x202e;m"')))
    assert "\u202e" not in told
    assert "\\u202e" in told


def test_a_group_without_a_role_names_no_robot(tmp_path: Path) -> None:
    robot = '<g id="robot"><rect x="5" y="7" width="1.8" height="1"/></g></g>'
    text = PLAN.replace("  </g>\n</svg>", f"  {robot}\n</svg>")
    world = import_world(drawing(tmp_path, text), Options(scale=1.0, boundary=("rim",))).world
    assert [one.name for one in world.robots] == ["r1"]


ROOMS = """\
<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">
  <g id="boundary"><path d="M 2,2 H 28 V 13 H 2 Z"/><path id="wall-a" d="M 12,2 V 9"/></g>
  <g id="path"><path id="way" d="WAY"/></g>
</svg>
"""
"""Two rooms and a door of 4 m between them."""


def test_a_wall_between_two_rooms_is_kept_clear_of(tmp_path: Path) -> None:
    way = ROOMS.replace("WAY", "M 4,10.5 H 26")
    made = import_world(drawing(tmp_path, way), Options(scale=1.0))
    told = next(fact for fact in made.facts if "narrowest" in fact)
    assert 11.9 < float(told.split("narrowest at (")[1].split(",")[0]) < 12.1
    assert "1.50 m" in told


def test_a_path_is_found_through_the_door(tmp_path: Path) -> None:
    text = ROOMS.replace('<g id="path"><path id="way" d="WAY"/></g>', "")
    ends = Options(scale=1.0, origin=(5.0, 12.0), goal=(25.0, 12.0))
    world = import_world(drawing(tmp_path, text), ends).world
    wall = shapely.LineString([(12, 13), (12, 6)])
    assert shapely.LineString(world.reference_path).distance(wall) > 0.5


def test_a_path_through_a_wall_is_refused_where_it_does(tmp_path: Path) -> None:
    with pytest.raises(PhysimError) as caught:
        import_world(drawing(tmp_path, ROOMS.replace("WAY", "M 4,5 H 26")), Options(scale=1.0))
    assert "plan.svg:3: 'way'" in str(caught.value)
    assert abs(_x(caught) - 12.0) < 0.05


def test_the_place_that_is_told_is_the_one_without_room(tmp_path: Path) -> None:
    """Here near the end of the path, which is wide elsewhere."""
    pillar = 'V 4"/></g>\n<g id="obstacle"><path d="M 20,9 h 2 v 2 h -2 z"/></g>'
    text = ROOMS.replace('V 9"/></g>', pillar)
    with pytest.raises(PhysimError) as caught:
        import_world(drawing(tmp_path, text.replace("WAY", "M 4,10 H 26")), Options(scale=1.0))
    assert 20.0 <= _x(caught) <= 22.0


def _x(caught: pytest.ExceptionInfo[PhysimError]) -> float:
    """x [m] of the place that a message tells."""
    return float(str(caught.value).split(" at (")[1].split(",")[0])


@pytest.mark.parametrize(
    ("inner", "line"),
    [('<defs><path id="it" d="M 2,2 H 28 V 13 H 2 Z"/></defs>', 2), ("", 1)],
)
def test_what_is_named_but_not_drawn_is_told_with_its_line(
    tmp_path: Path, inner: str, line: int
) -> None:
    root = "<svg" if inner else '<svg id="it"'
    plan = PLAN.replace("<svg", root, 1).replace("\n  <g", f"\n  {inner}<g", 1)
    told = refusal(drawing(tmp_path, plan), "it")
    assert f"--boundary it: line {line}: " in told
    assert "not drawn where it stands" in told


def test_what_is_not_read_is_no_advice(tmp_path: Path) -> None:
    drawn = '<rect id="{}" width="30" height="20" {}/>'
    shapes = drawn.format("paper", 'style="y:3px"') + drawn.format("hall", "")
    said = refusal(drawing(tmp_path, f'<svg xmlns="http://www.w3.org/2000/svg">{shapes}</svg>'))
    assert "hall" in said
    assert "paper" not in said
