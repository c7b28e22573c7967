"""What happens in a run, told in a paragraph: who starts where, and the first contact."""

from __future__ import annotations

import math

from physim.analysis.validation import Validation
from physim.analysis.validation.told import sentences, wrapped
from physim.errors import place_text, plural
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.units import joined, length

MOST_TOLD = 6
"""Robots whose starts are told one by one"""


def story(record: Record, found: Validation) -> str:
    """Tell what a record shows, ending in a newline; ``found`` is its validation.

    The first contact; without one, where two came nearest.
    """
    names = found.names
    some = range(record.robots if record.robots <= MOST_TOLD else 1)
    starts = joined([f"{names[i]} at {_pose(record.pose[0, i])}" for i in some])
    verb = "starts" if record.robots == 1 else "start"
    said = [f"{plural(record.robots, 'robot')} {verb}: {starts}."]
    touches = sorted((*found.contacts, *found.grazes), key=lambda one: one.time)
    near = (found.near_misses.smallest_robots, found.near_misses.smallest_boundary)
    nearest = min((one for one in near if one is not None), key=lambda one: one.value, default=None)
    if touches:
        said += sentences(touches[0], names)
        if more := len(touches) - 1:
            after = found.run.seconds - touches[0].time
            said.append(f"{plural(more, 'more contact')} in the {after:.2f} s after it.")
    elif nearest is None:
        said.append(f"Nothing comes near in {found.run.seconds:.2f} s.")
    else:
        said.append(
            f"Nothing touches in {found.run.seconds:.2f} s. The nearest are {names[nearest.a]} and "
            f"{names[nearest.b]} at {nearest.time:.2f} s, {length(nearest.value)} apart."
        )
        said += [
            f"{names[body]} was at {_pose(record.pose_at(nearest.step)[body])}."
            for body in (nearest.a, nearest.b)
            if body < record.robots
        ]
    return "\n".join(wrapped(" ".join(said), "", "")) + "\n"


def _pose(pose: FloatArray) -> str:
    x, y, heading = pose.tolist()
    turned = math.degrees(math.remainder(heading, 2.0 * math.pi))
    return f"{place_text(round(x, 2) + 0.0, round(y, 2) + 0.0)} facing {turned:.0f} degrees"
