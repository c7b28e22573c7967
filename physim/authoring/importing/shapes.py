"""Between the two forms of a drawing: shapes with roles, and what was made of them so far."""

from __future__ import annotations

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, DrawnRobot, Shape, Source
from physim.authoring.importing.path_pieces import take_paths


def with_shapes(drawing: Drawing) -> Drawing:
    """A drawing of boundaries, obstacles, paths and robots, with its shapes."""
    if drawing.shapes:
        return drawing

    def ring(points: object) -> object:
        return shapely.Polygon(points)

    def told(shape: Shape) -> Shape:
        source = drawing.source_at(shape.points.mean(axis=0), shape.role)
        where = (source.label, source.line) if source else ("", None)
        return Shape(shape.role, shape.geometry, shape.name, None, *where)

    places = [drawing.area] if drawing.area is not None else [drawing.within]
    found = [Shape("place", one) for one in places if one is not None]
    found += [Shape("boundary", shapely.LineString(line)) for line in drawing.boundaries]
    found += [Shape("obstacle", ring(one)) for one in drawing.obstacles]
    found += [Shape("obstacle", one) for one in drawing.solids]
    found += [Shape("robot", ring(one.outline), one.drawn_name) for one in drawing.robots]
    if drawing.reference is not None:
        found.append(Shape("path", shapely.LineString(drawing.reference)))
    found += [Shape("path", shapely.LineString(p), name) for name, p in drawing.paths.items()]
    drawing.shapes = [told(one) for one in found]
    return drawing


def with_lines(drawing: Drawing) -> Drawing:
    """A drawing of shapes, with boundaries, obstacles, paths and robots made of them."""
    if drawing.boundaries or drawing.area is not None:
        return drawing
    drawing.sources = [Source(s.role, s.label, s.line, s.points) for s in drawing.shapes]
    places = [one.geometry for one in drawing.of("place")]
    for one in drawing.of("obstacle", "place"):
        if one.geometry.interiors:
            drawing.add_outline(one.geometry)
            drawing.solids += [one.geometry] * (one.role == "obstacle")
        elif one.role == "place":
            drawing.boundaries.append(one.points)
        else:
            drawing.obstacles.append(one.points[:-1])
    drawing.boundaries += [one.points for one in drawing.of("boundary")]
    drawing.robots = [DrawnRobot(one.points[:-1], one.name) for one in drawing.of("robot")]
    take_paths(drawing, [(one.name, one.points) for one in drawing.of("path")])
    if places:
        line = shapely.LineString(drawing.reference) if drawing.reference is not None else None
        hold = [0.0 if line is None else one.intersection(line).length for one in places]
        drawing.within = places[int(np.argmax(hold))]
    return drawing
