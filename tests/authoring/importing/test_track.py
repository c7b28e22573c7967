"""Race tracks as tables: which are closed, the walls made of them, and what is told of them."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim import check_world
from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.authoring.importing.plans import check_says, only


def test_walls_that_cross_themselves_in_a_tight_bend_are_cut_clean(tmp_path: Path) -> None:
    """A right angle within a metre, in a road whose inner half is 3 m wide."""
    path = tmp_path / "bend.csv"
    sharp = np.array([(0.0, 0.0), (20.0, 0.0), (20.5, 0.1), (20.8, 0.4), (20.9, 0.9), (20.9, 20.0)])
    rows = [f"{x},{y},3.0,3.0" for x, y in sharp]
    path.write_text("x_m,y_m,w_tr_right_m,w_tr_left_m\n" + "\n".join(rows))
    imported = import_world(path)
    told = only(imported, "crossed itself in a tight bend")
    check_says(told, "left wall … tight bend … (17.91, 2.99) … loop")
    left = shapely.LineString((imported.world.boundaries or ())[0])
    assert left.is_simple
    line = shapely.LineString(sharp)
    near = line.offset_curve(3.0, join_style="mitre")
    assert left.hausdorff_distance(near) < 0.4


def aisles(
    folder: Path, half: float, noise: float = 0.0, apart: float = 6.0, turn: float = 0.0
) -> Path:
    """Three legs one beside another with square ends, a point a metre, to the millimetre."""
    corners = np.array([(0, 0), (40, 0), (40, apart), (0, apart), (0, 2 * apart), (40, 2 * apart)])
    points = shapely.get_coordinates(shapely.segmentize(shapely.LineString(corners), 1.0))
    points += np.random.default_rng(3).normal(0.0, 1.0, points.shape) * noise
    points = points @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    path = folder / "aisles.csv"
    path.write_text("".join(f"{x:.3f},{y:.3f},{half},{half}\n" for x, y in points))
    return path


@pytest.mark.parametrize(("half", "thick"), [(3.0, 0.004), (2.95, 0.1)])
def test_aisles_keep_the_wall_that_they_share(tmp_path: Path, half: float, thick: float) -> None:
    """It was cut off, 18 m at a time, as loops of a bend: the aisles became a hall."""
    imported = import_world(aisles(tmp_path, half))
    walls = shapely.union_all([shapely.LineString(one) for one in imported.world.boundaries or ()])
    for x, y in product((5.0, 20.0, 35.0), (0.0, 6.0, 12.0)):
        middle = shapely.Point(x, y)
        assert walls.distance(middle) == pytest.approx(3.0 - 0.5 * thick, abs=1e-3)
    for x, y in product((5.0, 20.0, 35.0), (3.0, 9.0)):
        across = shapely.LineString([(x, y - 1.0), (x, y + 1.0)]).intersection(walls)
        assert len(shapely.get_parts(across)) == 2
    assert (half == 3.0) == any("share a wall" in one for one in imported.changes)
    (tmp_path / "w.yaml").write_text(imported.text)
    assert not check_world(tmp_path / "w.yaml").warnings


@pytest.mark.parametrize(("noise", "apart"), [(0.02, 6.0), (0.0, 5.9)])
def test_aisles_that_run_into_each_other_are_refused(
    tmp_path: Path, noise: float, apart: float
) -> None:
    with pytest.raises(ImportSourceError) as caught:
        import_world(aisles(tmp_path, 3.0, noise, apart))
    check_says(str(caught.value), "edge crosses itself at … overlap … noisy")


def test_which_tracks_are_closed(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    for degrees, closed in ((360, True), (345, True), (240, False)):
        angle = np.radians(np.arange(0, degrees, 15))
        rows = [f"{20 * x},{20 * y},2,2" for x, y in zip(np.cos(angle), np.sin(angle), strict=True)]
        path.write_text("\n".join(rows))
        imported = import_world(path)
        assert any("cut open" in change for change in imported.changes) == closed
    path.write_text("0,0,2,2\n20,0,2,2\n20,20,2,2\n0,20,2,2")
    assert not any("cut open" in change for change in import_world(path).changes)
    only(import_world(path, Options(start=10.0)), "cut open at station 10 m, (10.00, 0.00)")
    path.write_text("0,0,2,2\n20,0,2,2\n40,0,2,2")
    with pytest.raises(ImportSourceError, match="this one is open"):
        import_world(path, Options(start=10.0))


def test_a_track_is_open_where_that_is_said(tmp_path: Path) -> None:
    """A hairpin of long legs: its ends are as near to each other as points are to the next."""
    path = tmp_path / "t.csv"
    path.write_text("0,0,2,2\n40,0,2,2\n50,4,2,2\n40,8,2,2\n0,8,2,2")
    assert any("cut open" in change for change in import_world(path).changes)
    imported = import_world(path, Options(open=True))
    assert not any("cut open" in change for change in imported.changes)
    assert any("open" in fact for fact in imported.facts)
    ends = np.array(imported.world.reference_path)[[0, -1]]
    assert np.allclose(ends, [(0, 0), (0, 8)], atol=3.1)  # [m] cut short before the walls there
    with pytest.raises(ImportSourceError, match="this one is open"):
        import_world(path, Options(open=True, gap=3.0))


def test_the_width_as_made_is_told_where_it_is_less_than_stated(tmp_path: Path) -> None:
    """At a right angle the walls keep 3 m along its bisector, 3 sin 45° = 2.12 m from a leg."""
    path = tmp_path / "corner.csv"
    path.write_text("0,0,3,3\n15,0,3,3\n30,0,3,3\n30,15,3,3\n30,30,3,3\n")
    facts = import_world(path).facts
    check_says(facts[0], "6.00 to 6.00 m … stated")
    assert facts[1].startswith("walls 4.")
    left, right = (
        shapely.LineString(line) for line in (import_world(path).world.boundaries or ())[:2]
    )
    along = shapely.points([(x, 0.0) for x in np.arange(3.0, 30.0, 0.01)])
    least = (left.distance(along) + right.distance(along)).min()
    assert float(facts[1].split()[1]) == pytest.approx(least, abs=0.02)
    path.write_text("0,0,3,3\n15,0,3,3\n30,0,3,3\n")
    assert not any(fact.startswith("walls") for fact in import_world(path).facts)


def test_repeated_points_and_further_columns_of_a_track(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text(
        "y_m;bank;x_m;w_tr_left_m;w_tr_right_m\n0;9;0;3;2\n0;9;0;3;2\n0;9;20;3;2\n0;9;40;3;2\n"
    )
    imported = import_world(path)
    check_says(only(imported, "line 3"), "repeats … dropped")
    check_says(only(imported, "columns"), "left out … bank")
    left, right = (imported.world.boundaries or ())[:2]
    assert {y for _, y in left} == {3.0}
    assert {y for _, y in right} == {-2.0}


COMMENTS = (
    "# a road by hand\n",
    "# Monza, smoothed, in metres of the local frame, by hand\n",
    "# 52c11ac8-1f\n# x_m,y_m,w_tr_right_m,w_tr_left_m\n",
    "# 2,3,4,5\n",
    "",
)


@pytest.mark.parametrize("comment", COMMENTS)
def test_a_comment_that_lists_no_names_stays_a_comment(comment: str, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text(comment + "0,0,2,3\n20,0,2,3\n40,0,2,3\n")
    left, right = (import_world(path).world.boundaries or ())[:2]
    assert ({y for _, y in left}, {y for _, y in right}) == ({3.0}, {-2.0})
