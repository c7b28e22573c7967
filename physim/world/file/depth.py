"""How deep a text nests, before a library takes it that goes down by calls."""

from __future__ import annotations

import yaml

from physim.world.file.reading import MOST_DEPTH, Loader


def is_deep(text: str) -> bool:
    """Whether the text of a world nests deeper than any may. Raises yaml.YAMLError."""
    depth = 0
    for event in yaml.parse(text, Loader=Loader):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
            if depth > MOST_DEPTH:
                return True
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
    return False
