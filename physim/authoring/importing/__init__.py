"""Worlds from what people have: race-track CSV, ROS map, SVG drawing, WKT and GeoJSON."""

from physim.authoring.importing.drawing import ImportSourceError
from physim.authoring.importing.importing import Imported, import_world
from physim.authoring.importing.options import Options
from physim.authoring.importing.source import FORMATS

__all__ = ["FORMATS", "ImportSourceError", "Imported", "Options", "import_world"]
