"""Race tracks as tables: which are closed, and the road made of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim import check_world
from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from tests.authoring.importing.plans import check_says, only, refusal

FIT = Options(robot="fit")


def road(imported: Imported) -> Any:
    (outline,) = imported.world.boundaries or ()
    return shapely.Polygon(outline)


def track(folder: Path, points: Any, half: float) -> Path:
    path = folder / "t.csv"
    path.write_text("".join(f"{x:.3f},{y:.3f},{half},{half}\n" for x, y in points))
    return path


def test_a_bend_tighter_than_the_road_is_a_corner_of_it(tmp_path: Path) -> None:
    """A right angle within a metre, in a road whose inner half is 3 m wide: no loop is left."""
    sharp = [(0, 0), (20, 0), (20.5, 0.1), (20.8, 0.4), (20.9, 0.9), (20.9, 20)]
    found = road(import_world(track(tmp_path, sharp, 3.0)))
    near = shapely.LineString(sharp).buffer(3.0, cap_style="flat", join_style="mitre")
    assert found.is_valid
    assert found.symmetric_difference(near).area < 8.0
    corner = shapely.Point(17.9, 3.0)
    assert found.exterior.distance(corner) < 0.1


def aisles(folder: Path, half: float, noise: float = 0.0) -> Path:
    """Three legs one beside another with square ends, 6 m apart, a point a metre."""
    corners = np.array([(0, 0), (40, 0), (40, 6), (0, 6), (0, 12), (40, 12)])
    points = shapely.get_coordinates(shapely.segmentize(shapely.LineString(corners), 1.0))
    points += np.random.default_rng(3).normal(0.0, 1.0, points.shape) * noise
    return track(folder, points, half)


def test_aisles_keep_the_walls_between_them(tmp_path: Path) -> None:
    imported = import_world(aisles(tmp_path, 2.9))
    for y in (3.0, 9.0):
        across = shapely.LineString([(20, y - 1), (20, y + 1)])
        assert road(imported).intersection(across).length == pytest.approx(1.8, abs=1e-3)
    (tmp_path / "w.yaml").write_text(imported.text)
    assert not check_world(tmp_path / "w.yaml").errors


@pytest.mark.parametrize(("half", "noise"), [(3.0, 0.0), (3.5, 0.0), (2.95, 0.05)])
def test_stretches_that_meet_are_refused(tmp_path: Path, half: float, noise: float) -> None:
    check_says(refusal(aisles(tmp_path, half, noise)), "meets itself at … overlap … noisy")


def test_which_tracks_are_closed(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    for degrees, closed in ((360, True), (345, True), (240, False)):
        angle = np.radians(np.arange(0, degrees, 15))
        ring = 20.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        imported = import_world(track(tmp_path, ring, 2.0))
        assert any("cut open" in change for change in imported.changes) == closed
    square = track(tmp_path, [(0, 0), (20, 0), (20, 20), (0, 20)], 2.0)
    assert not any("cut open" in change for change in import_world(square, FIT).changes)
    only(
        import_world(path, Options(start=10.0, robot="fit")),
        "cut open at station 10 m, (10.00, 0.00)",
    )
    hairpin = track(tmp_path, [(0, 0), (40, 0), (50, 4), (40, 8), (0, 8)], 2.0)
    assert any("cut open" in change for change in import_world(hairpin, FIT).changes)
    said = import_world(hairpin, Options(open=True, robot="fit"))
    assert not any("cut open" in change for change in said.changes)
    ends = np.array(said.world.reference_path)[[0, -1]]
    assert np.allclose(ends, [(3, 0), (3, 8)], atol=1e-3)
    with pytest.raises(ImportSourceError, match="this one is open"):
        import_world(hairpin, Options(open=True, gap=3.0))


def test_repeated_points_and_further_columns_of_a_track(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text(
        "y_m;bank;x_m;w_tr_left_m;w_tr_right_m\n0;9;0;3;2\n0;9;0;3;2\n0;9;20;3;2\n0;9;40;3;2\n"
    )
    imported = import_world(path)
    check_says(only(imported, "line 3"), "repeats … dropped")
    check_says(only(imported, "columns"), "left out … bank")
    assert road(imported).bounds == (0.0, -2.0, 40.0, 3.0)


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
    assert road(import_world(path)).bounds == (0.0, -2.0, 40.0, 3.0)
