"""Cars show how their front wheels are turned."""

from __future__ import annotations

import numpy as np

import physim
from physim.analysis.summary import summarise
from tests.drawing.video.looking import around, pixels
from tests.helpers import inside
from tests.helpers.unpacking import unpack

Timeline, frame_at = inside("physim.drawing", "Timeline"), inside("physim.drawing", "frame_at")
run_data = inside("physim.drawing.page", "run_data")


def test_wheels_stand_on_the_front_axle_at_their_angle() -> None:
    world = physim.load_world("cars").changed(time={"duration": 0.62})
    with physim.simulate(world) as record:
        row = int(np.abs(record.steering).max(axis=1).argmax())
        car = int(np.abs(record.steering[row]).argmax())
        time, angle = row * record.dt, float(record.steering[row, car])
        x, y, heading = record.pose[row, car]
        timeline = Timeline(record)
        image, edge = frame_at(record, time, speed=1.0), 0.4 * timeline.at(time).colours[car]
        header, _ = unpack(run_data(record, summarise(record)))
        assert abs(angle) > 0.4
        c, s = np.cos(heading), np.sin(heading)
        ahead = np.array([np.cos(heading + angle), np.sin(heading + angle)])
        wheels = header["scene"]["wheels"][str(car)]
        for forward, left in wheels["at"]:
            assert forward == 0.9
            middle = np.array([x + c * forward - s * left, y + s * forward + c * left])
            for along in (-0.8, 0.0, 0.8):
                place = middle + along * wheels["half"] * ahead
                assert pixels(image, edge, around(record, time, place, 0)) == 1
            beside = middle + wheels["half"] * ahead[::-1] * (-1.0, 1.0)
            assert pixels(image, edge, around(record, time, beside, 0)) == 0
