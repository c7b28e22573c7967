"""What is too small or too crooked to become a world: one message, never a traceback."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.importing.plans import SAMPLES, check_says, svg

ROOM = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
INSIDE = '<rect id="obstacle" x="5" y="5" width="1" height="1"/>'
SQUARE = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]


def feature(role: str, ring: Any) -> dict[str, Any]:
    shape = {"type": "Polygon", "coordinates": [ring]}
    return {"type": "Feature", "properties": {"role": role}, "geometry": shape}


def geojson(role: str, ring: Any) -> str:
    both = [feature("boundary", SQUARE), feature(role, ring)]
    return json.dumps({"type": "FeatureCollection", "features": both})


SCALES = (1e-9, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", ["track.csv", "office.yaml", "drawn.svg", "office.geojson"])
def test_a_forgotten_scale_is_told(name: str, scale: float, tmp_path: Path) -> None:
    path = SAMPLES / name
    if name == "drawn.svg":
        path = tmp_path / name
        path.write_text(svg(ROOM + INSIDE))
    with pytest.raises(ImportSourceError, match=r"scale|a centreline needs at least 2"):
        import_world(path, Options(scale=scale))


def test_the_size_of_a_small_place_is_told(tmp_path: Path) -> None:
    """Though its obstacle vanishes when it is rounded to the millimetre."""
    path = tmp_path / "d.svg"
    path.write_text(svg(ROOM + INSIDE))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=3e-4))
    check_says(str(caught.value), f"{path}: … 0.007 x 0.004 m … --scale")


CROOKED = {
    "line.svg": (
        svg(ROOM + '<path id="obstacle" d="M 5,5 7,7"/>'),
        "obstacle at (5.00, 9.00) … no area",
    ),
    "flat.svg": (svg(ROOM + '<path id="obstacle" d="M 5,5 7,7 9,9 Z"/>'), "obstacle … no area"),
    "bow.svg": (
        svg(ROOM + '<path id="obstacle" d="M 5,5 7,7 7,5 5,7 Z"/>'),
        "obstacle at (5.00, 9.00) … itself … Self-intersection[6 8]",
    ),
    "cover.svg": (
        svg(ROOM + '<rect id="obstacle" x="-1" y="-1" width="30" height="20"/>'),
        "obstacles … no place",
    ),
    "robot.svg": (
        svg(ROOM + '<path id="robot" d="M 5,5 7,7 7,5 5,7 Z"/>'),
        "robot at (5.00, 9.00) … itself",
    ),
    "bow.geojson": (geojson("obstacle", [[5, 5], [7, 7], [7, 5], [5, 7], [5, 5]]), "crosses"),
    "flat.geojson": (
        geojson("robot", [[5, 5], [7, 7], [9, 9], [5, 5]]),
        "robot at (5.00, 5.00) … no area",
    ),
    "grain.geojson": (geojson("robot", [[5, 5], [5.0002, 5], [5, 5.0002], [5, 5]]), "no area"),
    "point.csv": ("0,0,3,3\n0.0003,0,3,3\n", "path at (0.00, 0.00) … millimetre … --scale"),
    "thin.csv": ("0,0,1e-4,1e-4\n20,0,1e-4,1e-4\n", "boundaries … no area"),
}


@pytest.mark.parametrize("name", CROOKED)
def test_what_makes_no_shape_is_refused(name: str, tmp_path: Path) -> None:
    text, message = CROOKED[name]
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", ["svg", "geojson"])
def test_a_grain_is_left_out_and_told(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"g.{kind}"
    grain = '<rect id="obstacle" x="5" y="5" width="0.0002" height="0.0002"/>'
    ring = [[5, 5], [5.0002, 5], [5.0002, 5.0002], [5, 5]]
    path.write_text(svg(ROOM + grain) if kind == "svg" else geojson("obstacle", ring))
    imported = import_world(path, Options(scale=1.0))
    assert not imported.world.obstacles
    if kind == "geojson":
        check_says(imported.changes[0], "obstacle at (5.00, 5.00) … millimetre … left out")
