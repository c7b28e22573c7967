"""What a preview shows, worked out from the world alone: no kernel. Its words, and the fonts
that have signs for them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import floor, log10

import numpy as np
import shapely

from physim.drawing.labels import shortened, significant
from physim.drawing.scene_model import SceneModel, closed, pieces_of
from physim.errors import plural
from physim.geometry.corridor import SIDES, Widths, sampled_widths, width_spacing
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Mode
from physim.world.layout.scene_builder import is_random
from physim.world.layout.shape_checks import corners_of_line
from physim.world.scene import Layout

PLACES = 600
"""Stations at which the width is worked out at least, besides every waypoint: as close as in a
record."""


@dataclass(frozen=True)
class Route:
    """A path, and the robots that follow it."""

    robots: tuple[int, ...]
    """indices; robots with the same waypoints share one route"""
    safe: list[FloatArray]
    """pieces (n, 2) [m] in the safe area"""
    danger: list[FloatArray]
    """pieces (n, 2) [m] elsewhere"""


@dataclass(frozen=True)
class Contents:
    """Everything that a preview shows; world frame [m]."""

    scene: SceneModel
    description: str
    random: bool
    """whether the seed decides anything"""
    random_road: bool
    """whether it draws the road"""
    reference: FloatArray
    """(n, 2) without waypoints that are there twice"""
    length: float
    """[m] of the reference path"""
    course: FloatArray
    """(n, 2) path of the first robot, along which stations and widths are (Fig. 4), as of a run"""
    course_length: float
    """[m]"""
    routes: list[Route]
    widths: Widths
    """between boundaries and obstacles"""
    boundary_widths: Widths | None
    """between the boundaries alone, where there are obstacles too"""


def contents(layout: Layout, modes: Sequence[Mode] = (), safe_distance: float = 0.0) -> Contents:
    """Work out what to show of a world whose controller has these modes and this L [m]."""
    scene = SceneModel.of_layout(layout, modes, safe_distance)
    reference = corners_of_line(scene.reference)
    others, walls = _sides(layout)
    rings = _segments(map(closed, scene.obstacles))
    course = corners_of_line(scene.paths[0])
    length = float(shapely.LineString(course).length)
    places = max(PLACES, int(length / width_spacing(length)) + 2)
    widths = sampled_widths(course, np.concatenate((others, rings)), places, walls)
    alone = sampled_widths(course, others, places, walls) if len(rings) else None
    return Contents(
        scene=scene,
        description=layout.world.description,
        random=is_random(layout.world),
        random_road=layout.world.is_road_random,
        reference=reference,
        length=float(shapely.LineString(reference).length),
        course=course,
        course_length=length,
        routes=_routes(scene),
        widths=widths,
        boundary_widths=alone,
    )


def _sides(layout: Layout) -> tuple[FloatArray, tuple[FloatArray, FloatArray] | None]:
    """Segments of the boundaries between which a width is meant, and the two walls of a corridor.

    The caps of a corridor are in neither.
    """
    drawn = layout.boundaries
    if layout.world.corridor is None:
        return _segments(drawn.values()), None
    return _segments([]), (_segments([drawn[SIDES[0]]]), _segments([drawn[SIDES[1]]]))


def _segments(lines: Iterable[FloatArray]) -> FloatArray:
    """(S, 4) segments ax, ay, bx, by of polylines (n, 2)."""
    return pieces_of(lines).reshape(-1, 4)


def _routes(scene: SceneModel) -> list[Route]:
    """Paths of the robots, each once, in the order of the robots that come first on them."""
    shared: dict[bytes, list[int]] = {}
    for i, path in enumerate(scene.paths):
        shared.setdefault(path.tobytes(), []).append(i)
    return [Route(tuple(robots), *scene.path_pieces[robots[0]]) for robots in shared.values()]


FONT = "DejaVu Sans"
OTHER_FONTS = (
    "Noto Sans CJK SC", "Noto Sans CJK JP", "Noto Sans SC", "Noto Sans JP", "Noto Sans KR",
    "Source Han Sans SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei", "Droid Sans Fallback",
    "PingFang SC", "Hiragino Sans", "Apple SD Gothic Neo", "Microsoft YaHei", "Yu Gothic",
    "Malgun Gothic", "Arial Unicode MS", "Noto Sans", "Noto Sans Devanagari", "Noto Sans Bengali",
    "Noto Sans Thai", "Noto Sans Tamil", "Noto Sans Ethiopic", "Nirmala UI", "Leelawadee UI",
    "Segoe UI Symbol", "Noto Sans Symbols2", "Noto Emoji", "Unifont",
)  # fmt: skip
"""Fonts for scripts that the first lacks, on Linux, macOS and Windows."""


def counts(preview: Contents) -> str:
    """One line of figures about a world."""
    width = preview.widths.width[preview.widths.between]
    scene = preview.scene
    words = [plural(scene.robots, "robot"), plural(len(scene.boundaries), "boundary", "boundaries")]
    if scene.obstacles:
        words.append(plural(len(scene.obstacles), "obstacle"))
    words.append(f"reference path {significant(preview.length, 4)} m")
    if len(width):
        ends = dict.fromkeys((significant(width.min()), significant(width.max())))
        words.append(f"{' to '.join(ends)} m wide along the path of the first robot")
    if preview.random:
        what = "road and start" if preview.random_road else "start"
        words.append(f"{what} drawn with seed {scene.seed}")
    return "  ·  ".join(words)


def station_words(station: float, length: float) -> str:
    """A station [m] to a thousandth of the length of its path or finer."""
    decimals = max(0, 3 - floor(log10(length)))
    return f"{station:.{decimals}f}"


def drawable(name: str, index: int, signs: frozenset[int] | None) -> str:
    """The name of a robot, cut to 24 characters, or its number where ``signs`` lack some of it."""
    name = shortened(name, 24)
    known = signs is None or signs.issuperset(map(ord, name))
    return name if known else f"robot {index + 1}"


def families(preview: Contents) -> tuple[list[str], frozenset[int]]:
    """Fonts that together have the most signs for a world's texts, and the signs they have.

    Most worlds need the first alone; others are looked for among those installed.
    """
    from matplotlib.font_manager import findfont, fontManager, get_font

    wanted = set(map(ord, "".join((preview.scene.name, preview.description, *preview.scene.names))))
    chosen = [FONT]
    signs = set(get_font(findfont(FONT)).get_charmap())
    installed = {entry.name for entry in fontManager.ttflist} if wanted - signs else set()
    for family in OTHER_FONTS:
        if family in installed and (more := set(get_font(findfont(family)).get_charmap())) & (
            wanted - signs
        ):
            chosen.append(family)
            signs |= more
    return chosen, frozenset(signs)
