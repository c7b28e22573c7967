"""Paths as drawn: one a name, its pieces joined where their ends are the same."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from physim.authoring.importing.area import joint_text, joints
from physim.authoring.importing.drawing import Drawing, Shape, listed, place, rounded
from physim.errors import nearest
from physim.geometry.shapes import FloatArray


def drawn_paths(
    drawing: Drawing, names: Sequence[str], close: float | None
) -> dict[str, FloatArray]:
    """Paths (n, 2) [m] of a drawing with robots of these names, each by that of its robot.

    The reference path has none, and "" here.

    Without robots the only path is the reference path, whatever its name. Raises
    ImportSourceError for pieces of one path that do not meet, and for a name of no robot.
    """
    pieces: dict[str, list[Shape]] = {}
    for shape in drawing.of("path"):
        pieces.setdefault(shape.name, []).append(shape)
    if not names and len(pieces) == 1:
        pieces = {"": next(iter(pieces.values()))}
    paths: dict[str, FloatArray] = {}
    for name, some in pieces.items():
        if name and name not in names:
            near = nearest(name[:80], sorted(names)) or (
                f'; draw a robot and name it "robot {name[:80]}", or take the name off the '
                "reference path"
            )
            raise drawing.refusal(
                f'path "{name[:80]}": there is no robot "{name[:80]}"{near}', some[0]
            )
        line = _joined(drawing, some, some[0].name, close)
        if len(line) < 2:
            raise drawing.refusal("the path is shorter than a millimetre; check --scale", some[0])
        paths[name] = line
    return paths


def _joined(drawing: Drawing, pieces: list[Shape], name: str, close: float | None) -> FloatArray:
    """One line of all pieces, in the direction of the first."""
    lines = [piece.points for piece in pieces]
    bridges = joints(lines, close, only_ends=True) if close is not None else []
    drawing.changes += listed(bridges, lambda one: f"path: {joint_text(one)}")
    lines += bridges
    merged = shapely.line_merge(
        shapely.multilinestrings([shapely.LineString(one) for one in lines])
    )
    if merged.geom_type != "LineString":
        called = f'"{name}"' if name else "without a name"
        ends = [
            " to ".join(place(one.coords[k]) for k in (0, -1))
            for one in shapely.get_parts(merged)[:2]
        ]
        raise drawing.refusal(
            f"the pieces of the path {called} do not meet in one line: {', '.join(ends)}; draw it "
            "as one line, name each path after its robot, or --close M joins ends",
            pieces[1] if len(pieces) > 1 else pieces[0],
        )
    line, first = shapely.get_coordinates(merged), pieces[0].points
    if shapely.is_closed(merged):  # it begins and goes on where the first piece does
        begin = int(np.argmin(np.hypot(*(line - first[0]).T)))
        line = np.vstack([line[begin:-1], line[: begin + 1]])
        forth, back = (np.hypot(*(line[k] - first[1])) for k in (1, -2))
        return rounded(line if forth <= back else line[::-1])
    begin, end = (merged.project(shapely.Point(first[k])) for k in (0, 1))
    return rounded(line if begin < end else line[::-1])
