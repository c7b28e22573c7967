"""Collision time by marching: shapely distances, steps of distance over the largest speed.

Slow and obvious: no point of a body moves faster than speed + |omega| * radius, so a step of
distance / (sum of both) cannot step over a contact.
"""

from __future__ import annotations

import math

import numpy as np
import shapely


def pose_at(pose, twist, t):
    """Exact pose after t: twist (v, omega) is an arc, (vx, vy, omega) a straight line."""
    x, y, heading = pose
    if len(twist) == 3:
        return x + twist[0] * t, y + twist[1] * t, heading + twist[2] * t
    v, omega = twist
    if omega == 0.0:
        return x + v * t * math.cos(heading), y + v * t * math.sin(heading), heading
    radius = v / omega
    end = heading + omega * t
    return (
        x + radius * (math.sin(end) - math.sin(heading)),
        y - radius * (math.cos(end) - math.cos(heading)),
        end,
    )


def geometry_at(parts, pose):
    """Union-like collection of parts placed at a pose."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    turn = np.array([[c, s], [-s, c]])
    return shapely.GeometryCollection([shape(np.asarray(p) @ turn + pose[:2]) for p in parts])


def shape(points):
    """Polygon, segment or point of one part."""
    if len(points) == 1:
        return shapely.Point(points[0])
    return shapely.LineString(points) if len(points) == 2 else shapely.Polygon(points)


def distance_at(parts_a, pose_a, twist_a, parts_b, pose_b, twist_b, t):
    """Shapely's distance at time t."""
    a = geometry_at(parts_a, pose_at(pose_a, twist_a, t))
    b = geometry_at(parts_b, pose_at(pose_b, twist_b, t))
    return shapely.distance(a, b)


def largest_speed(parts, twist):
    """No point of the body is ever faster [m/s]."""
    radius = max(np.hypot(*np.asarray(p).T).max() for p in parts)
    return math.hypot(*twist[:-1]) + abs(twist[-1]) * radius


def marched_time(
    parts_a, pose_a, twist_a, parts_b, pose_b, twist_b, horizon, close=1e-9, cap=20000
):
    """First time within ``close``; inf if none up to the horizon, None when the cap is reached."""
    bound = largest_speed(parts_a, twist_a) + largest_speed(parts_b, twist_b)
    t = 0.0
    for _ in range(cap):
        d = distance_at(parts_a, pose_a, twist_a, parts_b, pose_b, twist_b, t)
        if d <= close:
            return t
        if bound == 0.0:
            return math.inf
        t += 0.999999 * (d - 0.25 * close) / bound
        if t > horizon:
            return math.inf
    return None
