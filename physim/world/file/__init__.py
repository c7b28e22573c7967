"""World files: YAML to `physim.world.World`, strictly, with the place of every fault."""

from physim.world.file.loading import (
    load_world,
    located,
    parse_world,
    read_world,
    warning_lines,
    world_of,
)
from physim.world.file.nodes import Document
from physim.world.file.overrides import apply_overrides
from physim.world.file.reading import read_document

__all__ = [
    "Document",
    "apply_overrides",
    "load_world",
    "located",
    "parse_world",
    "read_document",
    "read_world",
    "warning_lines",
    "world_of",
]
