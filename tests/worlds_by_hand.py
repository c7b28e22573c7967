"""Small worlds written by hand, for tests of the layers that read, build and run them."""

from __future__ import annotations

STRAIGHT = """\
# A straight corridor with two boxes, one behind the other.
name: straight
seed: 3
time: {step: 0.01, duration: 30.0}  # [s]
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}  # [m]
robots:
  - name: r1
    footprint: {length: 1.8, width: 1.0}  # [m]
    pose: [6.0, 1.0, 0.0]  # [m, m, rad]
    path: [[0.0, 1.0], [30.0, 1.0]]  # [m]
  - name: r2
    footprint: {length: 1.8, width: 1.0}
    pose: [3.0, -1.0, random]
    path: {offset: -1.0}
formation: {gain: 0.05, speed: 1.0, spacing: [0.0, -3.0]}
controller: {type: mode_switching, look_ahead: 2.0}
expect: {contacts: 0}
"""
