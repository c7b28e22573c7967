"""The whole decision of one robot, rule by rule, and the driver that asks for collision times.

A decision needs collision times at three places. It is written as a generator that yields its
questions and goes on with the answers, so that those of many decisions are worked out together.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.oracles import formation, path_following, paths, priority, safe_area
from tests.oracles.choice import smallest
from tests.oracles.collision_times import Answer, Question, collision_times
from tests.oracles.distances import smallest_distances
from tests.oracles.motion import arc, placed
from tests.oracles.switching import ARRIVED, BY_TIME, SAFE, next_mode
from tests.oracles.timing import longest_interval, stretched
from tests.oracles.tolerances import TIME

MOMENTS = 4001
"""at which a turning robot is looked at: over a turn of 8 s at 1 m/s less than 1e-6 m amiss"""


class UnsureError(Exception):
    """A collision time that decides is next to a graze, so no mode or command can be demanded."""


@dataclass(frozen=True)
class Memory:
    """What a decision leaves for the next."""

    mode: int = SAFE
    plan: tuple[tuple[float, float], ...] = ()
    """speed pairs still to come"""


@dataclass(frozen=True)
class Expected:
    """What a decision may be."""

    mode: int
    answers: dict[tuple[float, float], Answer]
    """the commands that are right, with the collision time under each; more than one only where
    rounding decides"""
    period: float
    """the hold, unless (14) or the stop shortens it"""
    distance: float
    boundary_distance: float
    considered: int
    evaluations: int
    settled: int
    """how many criteria it took: 1 the rule's own, then those of (5), at last the order"""
    continued: bool
    """whether the safe command is the rest of an earlier plan"""
    rest: dict[tuple[float, float], tuple[tuple[float, float], ...]]
    """what is left of the plan after each command"""


def arrived(view, s):
    """Whether the robot has come to its stop station."""
    return view.me.station >= view.me.stop_station - s.arrival_tolerance


def target_place(view, s):
    """Target (3) and all that decides where it moves to."""
    target, ahead = paths.target(view.me.path, view.me.station, s.look_ahead)
    station = min(view.me.station + s.look_ahead, paths.lengths(view.me.path)[-1])
    outside = safe_area.is_outside(view.me.outside, station)
    return safe_area.place(
        view.walls, target, ahead, outside, view.me.pose, s.look_ahead, s.safe_distance
    )


def forward_speed(view):
    """nu by (7), within the limit of the robot; 1 m/s without formation."""
    me, c = view.me, view.cluster
    nu = 1.0
    if c.active:
        mates = [(other.reference_station, other.lead) for other in view.neighbours]
        nu = formation.speed(
            me.reference_station, me.lead, mates, c.speed, c.gain, c.v_min, c.v_max
        )
    return min(nu, me.limits[0])


def considered_numbers(view):
    """Indices of the robots that this one has to consider."""
    me = view.me
    seen = [(j, other.pose, other.reference_station) for j, other in view.others]
    return priority.considered(view.index, me.pose, me.reference_station, seen, view.cluster.range)


def considered(view):
    """The robots that this one has to consider."""
    chosen = considered_numbers(view)
    return [other for j, other in view.others if j in chosen]


def decide(view, s, memory, target):
    """Decide at a target (moved into the safe area already); yields questions, returns Expected."""
    me, others = view.me, considered(view)
    nu = forward_speed(view)
    omegas = s.omegas if me.omegas is None else me.omegas
    everything = path_following.pairs(s.speeds if me.speeds is None else me.speeds, nu, omegas)
    left = paths.lengths(me.path)[-1] - me.station
    ahead = path_following.judging_time(s.judge_ahead, left, nu)

    # (5): the command that safe mode would take
    continued = memory.mode == SAFE and len(memory.plan) > 0
    if continued:
        sequences, best, settled = np.array([memory.plan]), {0}, 1
    else:
        may_reverse = s.reverse_in_safe_mode
        if may_reverse is None:
            may_reverse = not view.cluster.active
        forward_only = not may_reverse
        choice = path_following.pairs([1.0], nu, omegas) if forward_only else everything
        sequences = path_following.plans(choice, s.dwell_times)
        keys = path_following.judgements(me.pose, sequences, s.dwell_times, ahead, target)
        best, settled = smallest(keys)
    plans = [_pairs(sequences[k]) for k in sorted(best)]
    rest = {plan[0]: plan[1:] for plan in plans}

    # (11)
    distance = distances(me, [me.pose], others, (), 0.0)[0]
    boundary = distances(me, [me.pose], [], view.walls, 0.0)[0]
    looked_at = len(others) + 1  # the walls count as one
    evaluations = looked_at
    answers = yield from _ask(view, s, others, rest)
    mode = _mode(memory.mode, distance, answers.values(), boundary, s)
    waits = mode != SAFE and s.boundary_time_high is not None
    if waits:
        waits = _walls_wait((yield from _ask(view, s, [], rest)), s)
    if mode != SAFE and (waits or _stops_before(me, answers, s.boundary_low)):
        alone = yield from _ask(dataclasses.replace(view, walls=()), s, others, rest)
        mode = _mode(memory.mode, distance, alone.values(), boundary, s)
    longest = longest_interval(s)
    part = s.dwell_times[len(s.dwell_times) - len(sequences[0])]
    period = stretched(part, s.update_period, longest)

    if mode != SAFE:  # (12) or (13), ties by (5)
        commands = _pairs(everything)
        keys = path_following.judgements(
            me.pose, everything[:, None, :], [s.update_period], ahead, target
        )
        if mode == BY_TIME:
            all_answers = yield from _ask(view, s, others, commands)
            if not all(answer.sure for answer in all_answers.values()):
                raise UnsureError
            times = np.array([all_answers[command].time for command in commands])
            best, settled = smallest([-times, *keys], TIME)
            evaluations += looked_at * len(commands)
        else:
            ends = [arc(me.pose, np.array(c), s.update_period) for c in commands]
            walls = view.walls if boundary < s.safe_distance else ()
            gaps = distances(me, ends, others, walls, s.update_period)
            best, settled = smallest([-gaps, *keys])
        period, continued, rest = longest, False, {commands[k]: () for k in best}
        answers = yield from _ask(view, s, others, rest)
        evaluations += looked_at
    return Expected(
        mode, answers, period, distance, boundary, len(others), evaluations, settled, continued,
        rest,
    )  # fmt: skip


def _pairs(array):
    """Speed pairs (C, 2) as tuples."""
    return tuple((float(v), float(omega)) for v, omega in array)


def _walls_wait(answers, s):
    """Whether walls alone are met only after ``boundary_time_high``.

    UnsureError where it turns on rounding, or on which of several commands is taken.
    """
    found = set()
    for answer in answers.values():
        if not answer.sure or abs(answer.time - s.boundary_time_high) < 2.0 * TIME:
            raise UnsureError
        found.add(answer.time > s.boundary_time_high)
    if len(found) > 1:
        raise UnsureError
    return found.pop()


def _stops_before(me, answers, clear):
    """Whether the robot stands at its stop before it meets anything, if it keeps its command.

    If that turns, before it has less than ``clear`` [m] of its way to go until then. UnsureError
    where it turns on rounding, or on which of several commands is taken.
    """
    ahead = paths.point_at(me.path, me.station)[1]
    found = set()
    for command, answer in answers.items():
        time = answer.time - (clear / abs(command[0]) if command[0] and command[1] else 0.0)
        spare = _farthest(me.pose, command, ahead, time) - (me.stop_station - me.station)
        if abs(spare) < 2.0 * TIME:
            raise UnsureError
        found.add(spare > 0.0)
    if len(found) > 1:
        raise UnsureError
    return found.pop()


def _farthest(pose, command, ahead, time):
    """How far a robot comes along a direction within a time, looked at moment by moment; 0 for
    one that begins by going back.
    """
    v, omega = command
    if time <= 0.0 or v * float(np.array([math.cos(pose[2]), math.sin(pose[2])]) @ ahead) <= 0.0:
        return 0.0
    if omega == 0.0 and math.isinf(time):
        return math.inf
    turn = math.tau / abs(omega) if omega else math.inf  # after which it is where it was
    moments = np.linspace(0.0, min(time, turn), MOMENTS)
    ends = arc(pose, np.array(command), moments)
    return float(((ends[:, :2] - pose[:2]) @ ahead).max())


def _ask(view, s, others, commands):
    """Collision times under some commands, the others keeping theirs: a dict of answers."""
    me, asked = view.me, list(dict.fromkeys(commands))
    seen = tuple((other.parts, other.pose, other.command) for other in others)
    still = s.collision_motion == "translation"
    answers = yield [
        Question(me.parts, me.pose, command, seen, view.walls, s.horizon, still)
        for command in asked
    ]
    return dict(zip(asked, answers, strict=True))


def _mode(previous, distance, answers, boundary, s):
    """Mode by Fig. 5, or UnsureError where it turns on what the answers leave open."""
    modes = set()
    for answer in answers:
        if not answer.sure and answer.time < math.inf:
            raise UnsureError
        latest = answer.time + TIME if answer.time > 0.0 else 0.0
        modes |= {next_mode(previous, distance, t, boundary, s) for t in (answer.time, latest)}
    if len(modes) > 1:
        raise UnsureError
    return modes.pop()


def distances(me, poses, others, walls, t):
    """Smallest signed distances of the robot at each of ``poses`` after t, others moved on."""
    theirs = list(walls)
    for other in others:
        there = arc(other.pose, np.array(other.command), t)
        theirs += [placed(part, there) for part in other.parts]
    mine = [[placed(part, pose) for part in me.parts] for pose in poses]
    return smallest_distances(mine, [theirs] * len(poses))


def decide_all(decisions: list[Any]) -> list[Any]:
    """Run many decisions (generators of `decide`) side by side; Expected or UnsureError of each."""
    outcome: list[Any] = [None] * len(decisions)
    asked: list[Any] = [None] * len(decisions)
    running = {}

    def go_on(k, answers):
        try:
            asked[k] = decisions[k].send(answers)
            running[k] = True
        except StopIteration as stop:
            outcome[k] = stop.value
            running.pop(k, None)
        except UnsureError as unsure:
            outcome[k] = unsure
            running.pop(k, None)

    for k in range(len(decisions)):
        go_on(k, None)
    while running:
        order = list(running)
        answers = iter(collision_times([q for k in order for q in asked[k]]))
        for k in order:
            go_on(k, [next(answers) for _ in asked[k]])
    return outcome


__all__ = ["ARRIVED", "Expected", "Memory", "UnsureError", "arrived", "decide", "decide_all"]
