"""Which robots have a drive of their own, and what it allows them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from physim.errors import ControllerError, Fault, WorldError
from physim.geometry.shapes import FloatArray
from physim.parts.drive import Drive, Most
from physim.parts.registry import DRIVE, make_part
from physim.world import Robot
from physim.world.run import Choice
from physim.world.scene import Driven


class Drives(NamedTuple):
    """Drives of N robots."""

    driven: tuple[Driven, ...]
    most: FloatArray
    """(N, 5) `Most` of each"""


def drives_of(robots: Sequence[Robot], entries: Sequence[int]) -> Drives:
    """Make each drive once; those of robots without one are none. Raises WorldError."""
    made: dict[Choice, tuple[Drive, list[int]]] = {}
    most, same = [], {}
    for i, robot in enumerate(robots):
        of, choice = robot.limits, robot.drive
        if choice is not None and choice not in made:
            where = ("robots", entries[i], "drive")
            try:
                drive = make_part(DRIVE, choice.type, choice.settings, where=where)
            except ControllerError as error:
                raise WorldError([Fault(where, str(error))]) from None
            made[choice] = drive, []
        if choice is not None:
            made[choice][1].append(i)
        if (of, choice) not in same:
            plain = Most(of.v, of.omega)
            same[of, choice] = plain if choice is None else made[choice][0].most(of.v, of.omega)
        most.append(same[of, choice])
    driven = (Driven(one.type, drive, np.array(who)) for one, (drive, who) in made.items())
    return Drives(tuple(driven), np.array(most, dtype=np.float64).reshape(-1, 5))
