"""What a layer, a shape or a feature is for, by its name: boundary, wall, obstacle, path, robot."""

from __future__ import annotations

import re

from physim.errors import nearest

ROLES = ("boundary", "wall", "obstacle", "path", "robot")
NAME = re.compile(
    r"(boundar(?:y|ies)|walls?|obstacles?|paths?|reference(?:[\s_-]paths?)?|robots?)"
    r"(?:[\s_.:#-]+(.*)|(\d.*|[a-z]))?$"
)
"""Roles are words of their own: a wallpaper is no wall."""
ABOUT = "labels?|texts?|names?|icons?|legend"
OF_A_ROBOT = f"routes?|tracks?|traject\\w*|paths?|goals?|starts?|targets?|areas?|zones?|{ABOUT}"
OTHER = {
    is_robot: re.compile(rf"(?:^|[\s_.:#-])({words})(?:$|[\s_.:#-])")
    for is_robot, words in ((False, ABOUT), (True, OF_A_ROBOT))
}
"""Words after a role by which a thing is something else: ``robot_route_0`` is no robot."""
OF_WORD = {"bou": "boundary", "wal": "wall", "obs": "obstacle", "pat": "path", "ref": "path",
           "rob": "robot"}  # fmt: skip
WORDS = ["boundary", "boundaries", "wall", "walls", "obstacle", "obstacles", "path", "robot",
         "robots"]  # fmt: skip


def role_named(name: str) -> tuple[str, str]:
    """Role that a name says, and the rest of it: ``wall`` and ``left`` of ``Wall-left``.

    Both are empty where it says none.
    """
    text = name.strip().lower()
    found = NAME.match(text)
    if found is None or OTHER[found[1].startswith("robot")].search(found[2] or ""):
        return "", ""
    return OF_WORD[text[:3]], name.strip()[len(found[1]) :].strip(" _:#-")


def nearest_role(name: str) -> str:
    """``; did you mean ...?`` for a name that is nearly one of a role; else empty."""
    return "" if NAME.match(name.strip().lower()) else nearest(name.strip().lower(), WORDS)
