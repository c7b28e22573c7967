"""Walls of a drawing that has no layer for them: named by the user, or told which could be."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.authoring.importing import Options, import_world
from physim.errors import PhysimError
from tests.facts import facts

PLAN = """\
<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">
  <g id="floor">
    <g id="outline"><path id="rim" fill="none" d="M 2,2 L 28,2 L 28,13 L 2,13 Z"/></g>
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


def test_it_is_for_drawings_only(tmp_path: Path) -> None:
    path = tmp_path / "w.wkt"
    path.write_text("POLYGON ((0 0, 30 0, 30 8, 0 8, 0 0))")
    with pytest.raises(PhysimError, match=facts("--boundary", "wkt")):
        import_world(path, Options(boundary=("a",)))


def test_names_of_shapes_cannot_act_on_a_terminal(tmp_path: Path) -> None:
    told = refusal(drawing(tmp_path, PLAN.replace('id="rim"', 'id="r&#x202e;m"')))
    assert "\u202e" not in told
    assert "\\u202e" in told


def test_a_group_without_a_role_names_no_robot(tmp_path: Path) -> None:
    robot = '<g id="robot"><rect x="5" y="7" width="1.8" height="1"/></g></g>'
    text = PLAN.replace("  </g>\n</svg>", f"  {robot}\n</svg>")
    world = import_world(drawing(tmp_path, text), Options(scale=1.0, boundary=("rim",))).world
    assert [one.name for one in world.robots] == ["r1"]
