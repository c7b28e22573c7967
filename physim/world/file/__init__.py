"""World files: YAML to `physim.world.World`, strictly, with the place of every fault."""

from physim.world.file.document import Document, apply_overrides, read_document
from physim.world.file.loading import load_world, parse_world, read_world

__all__ = [
    "Document",
    "apply_overrides",
    "load_world",
    "parse_world",
    "read_document",
    "read_world",
]
