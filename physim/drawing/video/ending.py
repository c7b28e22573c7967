"""How a run ended, in a few lines: who has not arrived, who stands across its path, and why."""

from __future__ import annotations

import numpy as np
import shapely

from physim.analysis.metrics import absent
from physim.drawing.timeline import NO_ROW, Timeline
from physim.geometry.shapes import FloatArray

ACROSS = 10.0
"""[deg] from the direction of its path at which a robot is said to stand across it"""
LATELY = 5.0
"""[s] before the end in which a contact or a mode of danger explains how a robot stands"""
MOST_NOTES = 5


def notes(timeline: Timeline) -> list[str]:
    """Return at most `MOST_NOTES` lines about robots, by index: what is odd at the end, and why."""
    record = timeline.record
    missing = {one.robot: one for one in absent(record)}
    angles = across(timeline)
    found: list[tuple[int, str]] = []
    for robot, angle in enumerate(angles.tolist()):
        name = record.names[robot]
        turned = f"{abs(angle):.0f}° across its path" if abs(angle) >= ACROSS else ""
        if robot in missing:
            said = missing[robot].is_astray or not turned
            line = missing[robot].sentence(name) + ("" if said else f", {turned}")
        elif turned:
            line = f"{name} stands {turned}"
        else:
            continue
        found.append((robot, line))
    shown = found if len(found) <= MOST_NOTES else found[: MOST_NOTES - 1]
    lines = [f"{line}: {why(timeline, k, arrived=k not in missing)}" for k, line in shown]
    more = len(found) - len(shown)
    return [*lines, f"and {more} robots more"] if more else lines


def across(timeline: Timeline) -> FloatArray:
    """Return the angle (N,) [deg] from the direction of each robot's path to its heading."""
    scene, pose = timeline.scene, timeline.record.pose[-1]
    lines = [shapely.LineString(path) for path in scene.paths]
    station = shapely.line_locate_point(lines, shapely.points(pose[:, :2]))
    length = shapely.length(lines)
    ends = (np.clip(station + by, 0.0, length) for by in (-0.05, 0.05))
    before, after = (
        shapely.get_coordinates(shapely.line_interpolate_point(lines, at)) for at in ends
    )
    heading = np.arctan2(*(after - before).T[::-1])
    turned = (pose[:, 2] - heading + np.pi) % (2.0 * np.pi) - np.pi
    return np.asarray(np.degrees(turned))


def why(timeline: Timeline, robot: int, arrived: bool) -> str:
    """Return what the record says about why a robot stands as it does at the end."""
    end, contacts = timeline.duration, timeline.contacts
    mine = np.flatnonzero((contacts.bodies == robot).any(axis=1))
    if len(mine) and contacts.ended[mine].max() >= end - LATELY:
        last = int(mine[np.argmax(contacts.ended[mine])])
        a, b = contacts.bodies[last].tolist()
        other = timeline.record.bodies[b if a == robot else a].name
        if contacts.ended[last] > end + 1e-9:
            return f"in contact with {other} since {contacts.began[last]:.1f} s"
        return f"in contact with {other} until {contacts.ended[last]:.1f} s"
    modes = timeline.scene.modes
    for time in np.arange(end, max(end - LATELY, 0.0), -0.1).tolist():
        mode = int(timeline.modes(timeline.decisions(time))[robot])
        if mode >= 0 and modes[mode].danger:
            return f"its mode was “{modes[mode]}” until {time:.1f} s"
    if timeline.decisions(end)[robot] == NO_ROW:
        return "it has not decided"
    return "to arrive is to stand at its station, however turned" if arrived else "no contact"
