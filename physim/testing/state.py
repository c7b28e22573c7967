"""What a controller keeps beside its memory: on itself, on its class, in its module."""

from __future__ import annotations

import sys
from types import ModuleType

from physim.control import Controller
from physim.testing.contents import Contents, contents

MOST = 5000
"""Values of one object, class or global that are looked at."""
SELF = "self"
CALLED = ("__init__", "__call__")
"""Names of this kind that are looked at: the others are not the author's."""


class Watch:
    """Looks at all that a controller could keep something on."""

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.classes = [kind for kind in type(controller).__mro__ if _is_own(kind.__module__)]
        names = dict.fromkeys(kind.__module__ for kind in self.classes)
        self.modules = [sys.modules[name] for name in names if name in sys.modules]

    def look(self) -> Contents:
        """What is kept now, by the name under which the controller's code knows it."""
        found = contents(self.controller, SELF, most=MOST)
        seen = set(self.classes)
        for kind in self.classes:
            _look_at(kind, kind.__name__, kind.__module__, seen, found)
        for module in self.modules:
            _look_at(module, module.__name__, module.__name__, seen, found)
        return found


def is_shared(place: str) -> bool:
    """Whether what is kept at a place is shared by all instances."""
    return not place.startswith((f"{SELF}.", f"{SELF}["))


def _is_own(module: str) -> bool:
    """Whether a class of this module may be the author's: not one of Python or of what checks."""
    return module.partition(".")[0] not in sys.stdlib_module_names and module != "physim.control"


def _look_at(
    owner: type | ModuleType, place: str, module: str, seen: set[type], found: Contents
) -> None:
    """Take down what a class or module keeps; its own functions and classes, once, likewise."""
    for name, value in list(vars(owner).items()):
        if name.startswith("__") and name.endswith("__") and name not in CALLED:
            continue
        where = f"{place}.{name}"
        is_own = getattr(value, "__module__", None) == module
        found.update(contents(value, where, functions=is_own, most=MOST))
        if is_own and isinstance(value, type) and value not in seen:
            seen.add(value)
            _look_at(value, where, module, seen, found)
