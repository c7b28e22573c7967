"""Shapes of an SVG drawing that are walls because the user says so, or that could be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from physim.authoring.importing.svg_bare import FAULT, LINE, SAME_ID
from physim.errors import nearest
from physim.escaping import escaped

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
NAMES = (LABEL, "id", SAME_ID)
MOST_ADVISED = 5
MOST_MEASURED = 2_000
"""Shapes without a role whose extent is looked up, which takes a millisecond each."""


def names_of(element: Any) -> list[str]:
    """Label and id of an element, as far as it has them."""
    own = element.values.get("attributes", {})
    return [str(own[key]) for key in NAMES if own.get(key)]


class Walls:
    """What the user asked to be taken as walls, and how large everything without a role is."""

    def __init__(self, asked: frozenset[str], hidden: Sequence[str] = ()) -> None:
        """``asked`` are ids or labels of shapes or groups, ``hidden`` is told of those not seen."""
        self._asked, self._hidden = asked, hidden
        self._found: set[str] = set()
        self._known: set[str] = set()
        self._measured = 0
        self._boxes: dict[str, tuple[float, float, float, float]] = {}
        self._lines: dict[str, str] = {}

    def takes(self, element: Any) -> bool:
        """Whether an element was asked for by its id or its label."""
        names = set(names_of(element))
        self._known |= names
        self._found |= names & self._asked
        return bool(names & self._asked)

    def asked_for(self, element: Any) -> bool:
        """Whether an element was itself asked for, not a group that it is in."""
        return not self._asked.isdisjoint(names_of(element))

    def note(self, element: Any, group: str, metres: float) -> None:
        """Take note of a shape without a role, in a group; ``metres`` is the length of a pixel.

        It goes by its own name, else by that of the group.
        """
        name = next(iter(names_of(element)), "") or group
        if not name or FAULT in element.values or self._measured >= MOST_MEASURED:
            return
        box = element.bbox()
        self._measured += 1
        if box is None:
            return
        if line := element.values.get("attributes", {}).get(LINE):
            self._lines.setdefault(name, f"line {line}, ")
        x0, y0, x1, y1 = (float(value) * metres for value in box)
        a0, b0, a1, b1 = self._boxes.get(name, (x0, y0, x1, y1))
        self._boxes[name] = min(a0, x0), min(b0, y0), max(a1, x1), max(b1, y1)

    def unknown(self, lines: Mapping[str, int]) -> str:
        """What is wrong with what was asked for; empty where all of it is there.

        ``lines`` are those of all ids, of what is not drawn, too.
        """
        for name in sorted(self._asked - self._found):
            if name in lines:
                return (
                    f"--boundary {escaped(name)}: line {lines[name]}: not drawn where it stands "
                    "(hidden, without lines, in <defs>, or the whole drawing)"
                )
            known = sorted(self._known)
            return (
                f"--boundary {escaped(name)}: no shape and no group has that id or label"
                f"{escaped(nearest(name[:100], known)) or self.advice()}"
            )
        return ""

    def advice(self) -> str:
        """Which shapes and groups could be walls, the largest first, and how to say so.

        And the first of what is left out, which may hide them.
        """
        sizes = {name: (x1 - x0, y1 - y0) for name, (x0, y0, x1, y1) in self._boxes.items()}
        largest = sorted(sizes, key=lambda name: -max(sizes[name]))[:MOST_ADVISED]
        hidden = [one for one in self._hidden if ": hidden <" in one]
        more = f" and {len(hidden) - 1} more" if len(hidden) > 1 else ""
        unseen = f"; not seen: {hidden[0]}{more}" if hidden else ""
        if not largest:
            return unseen
        listed = ", ".join(
            f'"{escaped(name)[:60]}" ({self._lines.get(name, "")}{sizes[name][0]:.3g} x '
            f"{sizes[name][1]:.3g} m)"
            for name in largest
        )
        return f"; --boundary ID takes a shape or group for one: the largest are {listed}{unseen}"
