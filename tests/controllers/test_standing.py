"""Robots that had to stop before a corner: whether the wall behind it keeps them there."""

from __future__ import annotations

import physim
from physim.world.file import parse_world

AISLES = """\
name: aisles
time: {step: 0.01, duration: 80.0}
boundaries: [[[0, 0], [21.2, 0], [21.2, 8.8], [0, 8.8], [0, 0]]]
obstacles: [[[3.6, 4.0], [17.6, 4.0], [17.6, 4.8], [3.6, 4.8]]]
reference_path: [[1.8, 2.0], [19.4, 2.0], [19.4, 6.8], [2.28, 6.8]]
robots:
  - {name: a, footprint: &box {length: 1.8, width: 1.0}, pose: [8.2, 2.0, 0.0], path: {offset: 0.0}}
  - {name: b, footprint: *box, pose: [5.0, 2.0, 0.0], path: {offset: 0.0}}
  - {name: c, footprint: *box, pose: [1.8, 2.0, 0.0], path: {offset: 0.0}}
formation: {gain: 0.05, range: 10.0}
"""


def test_a_wall_behind_a_corner_keeps_nobody_standing_who_had_to_stop() -> None:
    """With one threshold for robots and walls (13) likes standing best, for ever."""
    with physim.simulate(parse_world(AISLES)) as record:
        assert record.ended == "duration"
        assert {record.modes[mode].name for mode in record.updates["mode"][-30:]} >= {"danger_time"}
    for high in (1.0, 1.4):
        text = AISLES + f"controller: {{type: mode_switching, boundary_time_high: {high}}}\n"
        with physim.simulate(parse_world(text)) as record:
            assert (record.ended, len(record.contacts)) == ("finished", 0)
