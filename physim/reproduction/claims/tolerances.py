"""What counts as met: every bound that a verdict uses, with its reason."""

from __future__ import annotations

SAME = 0.05
"""[-] A measured figure within 5 % of the reported one is the same: the shapes and waypoints of
the paper are unknown, so nothing closer can be expected."""
ORDER = 10.0**0.5
"""[-] A figure within this factor, half a decade to either side, is of the same order."""
FOLLOWS = 0.25
"""[m] "Closely": root mean square deviation of at most a quarter of a robot's width of 1 m."""
AT_TURN = 2.0
"""[m] A robot is at a turn of its path within the look-ahead of it: there the target is round the
corner."""
START = 5.0
"""[m] After this distance a robot has come out of its random heading."""
SHARP_TURNS_ONLY = 0.5
"""[-] Deviations away from turns are at most this share of the largest one at a turn."""
BEND = 0.3
"""[rad] A path bends where its heading changes by more within `BEND_SPAN`."""
BEND_SPAN = 10.0
"""[m] along the path, half before and half behind the place"""
SAME_SIGN = 0.9
"""[-] share of the moments in bends at which the averaged rotation has the sign of the bend; a
robot alone must have it at every turn"""
ZERO_AT_END = 0.1
"""[m] Formation errors have converged to zero when none is larger at the end."""
BOUNDED = 10.0
"""[m] Formation errors count as bounded below the range within which robots are neighbours."""
GROWTH = 0.5
"""[m] A formation error has grown when it reaches this size, a quarter of a robot's length."""
COHESIVE = 2.0
"""[-] A group stays together when its largest distance never exceeds this multiple of that at the
start."""
WIDTH = 0.05
"""[m] Corridor widths equal the reported ones within this (widths are given to 0.1 m)."""
FARTHEST = 21.5
"""[m] reported largest distance between two robots"""
SPEED = 0.005
"""[m/s] Averaged speeds may leave 0.8 to 1.3 m/s by half of the last digit of a speed of 0.01."""
BEHIND = 0.5
"""[m] A robot is behind or in the lead when its formation error is larger than this."""
MOST_OF_TIME = 0.5
"""[-] more time in one mode than in the other"""
IN_TIME = 1.1
"""[-] A run takes hardly longer than its longest path at the steady speed when it stays below this
multiple of that time."""
SAFE_AREA = 0.01
"""[-] share of L by which the drawn safe area may come nearer to a wall: arcs are drawn as chords,
and the library leaves out detail below a hundredth of the distance"""
