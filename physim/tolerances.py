"""Every tolerance of the project, named, with its reason."""

from math import hypot

CONTACT = 1e-9
"""[m] Shapes closer than this touch. The engine decides contact to 1e-12 m at 10 km from the
origin and to 1e-14 m near it, so 1e-9 m is above its rounding and far below any real gap."""

TIME = 1e-6
"""[s] How well a collision time is asserted, where the shapes close at 1e-3 m/s or more."""

CLOSING_SPEED = 1e-3
"""[m/s] Slowest closing speed at which ``TIME`` is asserted: CONTACT / CLOSING_SPEED = TIME."""

ROUNDING = 1e-10
"""[m] How far a distance at the engine's poses may be from that on the exact arcs, by rounding:
some tens of steps within a kilometre of the origin add up to 1e-12 m."""

LENGTH = 1e-9
"""[m] Points closer than this are one point (duplicate neighbours, closed rings)."""

TIE = 1e-12
"""[m, rad, s] Objectives closer than this are equal, so rounding does not break a tie."""

TUNNEL_FRACTION = 0.25
"""[-] Largest advance of any robot point in one step, as a share of the smallest robot width.
Walls hold while the advance is at most half the robot's length; a quarter leaves a factor two."""

SETTLED_DEPTH = 2e-3
"""[m] Overlap of a robot held at rest by a wall: collision_slop (1 mm) and as much again."""

DEEP = 2.1e-2
"""[m] How deep two bodies may be in each other where a step ends, if it is of 0.01 s or less: the
depth of an impact at IMPACT_SPEED. The world `jam` stays below it. `physim.contacts.allowed_depth`
says what longer steps may reach."""

IMPACT_SPEED = 2.0
"""[m/s] Impacts up to this closing speed are left as the engine finds them, where a step ends."""

ONE_STEP = 1e-11
"""[m, rad] How far a recorded pose may be from the end of the arc that begins at the pose before:
rounding of one step, 1e-12 m at 10 km; farther out the rounding of coordinates is added."""

ULPS = 8.0
"""Roundings of a coordinate in one step, for worlds far from the origin."""

PUSHED = 1e-2
"""[m] A robot within this of where another one in contact could get in a step may be pushed by it,
though it touches nothing at either sample: the engine eases robots out of an overlap by a share of
its depth, twice a step; 6 % each at 0.01 s, 27 % at 0.05 s."""

WHOLE_STEPS = 1e-9
"""[-] How far, as a share, a duration may be from a whole number of steps: far above the rounding
of their quotient, and at most a tenth of a step in 1e8 steps."""

FLAT = 1e-12
"""[-] Sine of the turn at a corner below which the two edges count as one straight edge. A part
that is concave by that much differs from a convex one by less than ``CONTACT`` up to 1000 m."""


def chord(v: float, omega: float, lateral: float, dt: float) -> float:
    """Return the largest gap [m] between the arc of one step and the straight line of its ends.

    Between two samples the engine moves position and angle linearly; the exact arc lies at most
    ``|v| |omega| dt^2 / 8`` from that, of an omnidirectional robot with the length of its velocity.
    """
    return hypot(v, lateral) * abs(omega) * dt * dt / 8.0


SHARE = 1e-9
"""Share of a step, and of a limit of commands, that rounding may take up."""

PUSH = 1e-3
"""[m/s] A robot that closes on another by this much more than its command says was pushed: above
the engine's corrections and roundings, far below any push that matters. A robot stands by command
where no point of it is to move by as much."""
