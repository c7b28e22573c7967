"""Worlds from what people have: race-track CSV, ROS map, SVG drawing, WKT and GeoJSON."""

from physim.importing.drawing import ImportSourceError, Options
from physim.importing.importing import Imported, import_world
from physim.importing.source import FORMATS

__all__ = ["FORMATS", "ImportSourceError", "Imported", "Options", "import_world"]
