"""Whether a library may take the text of a world that physim wrote, before it does.

What goes down by calls is ended by a text that nests deeply; and a few lines of aliases that name
one another stand for more values than memory holds, as soon as one is written out.
"""

from __future__ import annotations

import yaml

from physim.world.file.reading import MOST_DEPTH, Loader


def is_plain(text: str) -> bool:
    """Whether a text has no aliases, as none that `to_yaml` gives has, and nests no deeper than
    a world may. Raises yaml.YAMLError."""
    depth = 0
    for event in yaml.parse(text, Loader=Loader):
        if isinstance(event, yaml.AliasEvent):
            return False
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
            if depth > MOST_DEPTH:
                return False
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
    return True
