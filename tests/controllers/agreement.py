"""Whole decisions, held against the oracle's; what was met on the way is counted."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from physim import Decisions
from tests.controllers.scenes import History, decisions
from tests.helpers import inside
from tests.oracles import decision as oracle
from tests.oracles import paths, safe_area, switching, timing
from tests.oracles.decision import Expected, Memory, UnsureError
from tests.oracles.tolerances import ROUNDING, TIME
from tests.oracles.view import View, view

ModeSwitching = inside("physim.controllers", "ModeSwitching")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

Case = tuple[History, ModeSwitchingSettings]


@dataclass
class Tally:
    """Where the controller and the oracle differ, and how often each branch was met."""

    faults: list[str] = field(default_factory=list)
    met: Counter[str] = field(default_factory=Counter)


@dataclass(frozen=True)
class Asked:
    """One robot of one case at one moment."""

    case: int
    moment: int
    view: View
    settings: ModeSwitchingSettings
    memory: Memory

    def __str__(self) -> str:
        return f"case {self.case}, moment {self.moment}, robot {self.view.index}"


def hold_against_oracle(cases: list[Case]) -> Tally:
    """Ask the controller and the oracle in every case, moment after moment."""
    made = [decisions(history, settings) for history, settings in cases]
    tally, memory = Tally(), {}
    for moment in range(max(len(history.moments) for history, _ in cases)):
        asked = []
        for k, (history, settings) in enumerate(cases):
            robots = history.moments[moment]
            for i in range(len(robots)):
                seen = view(robots, history.wall_parts, history.cluster, i)
                known = memory.get((k, i), Memory())
                if known is not None:  # None: what it remembers is not known for sure
                    asked.append(Asked(k, moment, seen, settings, known))
        rows = [made[a.case][moment] for a in asked]
        memory |= _compare(asked, rows, tally)
    return tally


def _compare(
    asked: list[Asked], rows: list[Decisions], tally: Tally
) -> dict[tuple[int, int], Memory | None]:
    """Compare the decisions of one moment; what the robots remember of them."""
    kept: dict[tuple[int, int], Memory | None] = {}
    under_way = []
    for a, made in zip(asked, rows, strict=True):
        i, key = a.view.index, (a.case, a.view.index)
        if oracle.arrived(a.view, a.settings):
            tally.met["arrived"] += 1
            tally.faults += [f"{a}: {f}" for f in _faults_of_arrived(a, made, i)]
            kept[key] = Memory(switching.ARRIVED)
            continue
        target = made.report[i, :2]
        kind = safe_area.judge(oracle.target_place(a.view, a.settings), target)
        if kind not in safe_area.KINDS:
            tally.faults.append(f"{a}: target {kind}")
        tally.met[f"target {kind}"] += 1
        under_way.append((a, made, key, oracle.decide(a.view, a.settings, a.memory, target)))
    outcomes = oracle.decide_all([deciding for *_, deciding in under_way])
    for (a, made, key, _), expected in zip(under_way, outcomes, strict=True):
        kept[key] = None
        if isinstance(expected, UnsureError):
            tally.met["unsure"] += 1
            continue
        tally.met["decided"] += 1
        tally.met.update(met_by(a, expected))
        found = faults_of(a.settings, expected, made, a.view) + faults_of_names(a, expected, made)
        tally.faults += [f"{a}: {fault}" for fault in found]
        kept[key] = _remembered(a, expected, made, tally)
    return kept


def _faults_of_arrived(a: Asked, made: Decisions, i: int) -> list[str]:
    faults = []
    if made.mode[i] != switching.ARRIVED or made.command[i].any():
        faults.append(f"mode {made.mode[i]}, command {made.command[i]}; it has arrived")
    if made.hold[i] != timing.longest_interval(a.settings):
        faults.append(f"hold {made.hold[i]}")
    target, _ = paths.target(a.view.me.path, a.view.me.station, a.settings.look_ahead)
    if not np.allclose(made.report[i, :2], target, rtol=0.0, atol=ROUNDING):
        faults.append(f"target {made.report[i, :2]}, not {target}")
    if (
        not np.isnan(made.report[i, 2:5]).all()
        or made.report[i, 5:].any()
        or len(considered_by(made, i))
    ):
        faults.append(f"report {made.report[i]}")
    return faults


def considered_by(made: Decisions, i: int) -> np.ndarray:
    """Robots that robot i considered."""
    return made.considered[made.considered_start[i] : made.considered_start[i + 1]]


def right_command(expected: Expected, command: np.ndarray) -> tuple[float, float] | None:
    """The command of the oracle that a decision took."""
    near = [c for c in expected.answers if np.allclose(c, command, rtol=0.0, atol=ROUNDING)]
    return near[0] if near else None


def faults_of(
    settings: ModeSwitchingSettings, expected: Expected, made: Decisions, seen: View
) -> list[str]:
    """What is wrong with the decision of a robot."""
    i = seen.index
    if made.mode[i] != expected.mode:
        return [f"mode {made.mode[i]}, not {expected.mode}"]
    command = right_command(expected, made.command[i])
    if command is None:
        return [f"mode {expected.mode}: command {made.command[i]}, not one of {expected.answers}"]
    _, _, distance, boundary, time, evaluations = made.report[i]
    values = [
        ("distance", distance, expected.distance),
        ("boundary distance", boundary, expected.boundary_distance),
        ("considered", len(considered_by(made, i)), expected.considered),
        ("evaluations", evaluations, expected.evaluations),
    ]
    faults = [f"{n} {v}, not {e}" for n, v, e in values if v != e and not abs(v - e) <= ROUNDING]
    answer = expected.answers[command]
    if not answer.sure:
        return faults
    if not (time == answer.time or abs(time - answer.time) <= TIME):
        faults.append(f"collision time {time}, not {answer.time}")
    hold = expected_hold(seen, settings, expected, command)
    if not abs(made.hold[i] - hold) <= TIME:
        faults.append(f"hold {made.hold[i]}, not {hold}")
    return faults


def expected_hold(
    seen: View, s: ModeSwitchingSettings, expected: Expected, command: tuple[float, float]
) -> float:
    """How long a right command holds [s]."""
    left = seen.me.stop_station - seen.me.station
    tau = timing.interval(
        expected.period, s.beta, expected.answers[command].time, s.event_triggered
    )
    return min(tau, timing.until_stop(left, command[0]))


RULES = {switching.BY_DISTANCE: "distance", switching.BY_TIME: "time"}


def faults_of_names(a: Asked, expected: Expected, made: Decisions) -> list[str]:
    """Whether the decision names the rule that made it, and the robots that it considered."""
    i = a.view.index
    named = ModeSwitching.rules[made.rule[i]].name
    followed = "plan" if expected.continued else "path_following"
    faults = []
    if named != RULES.get(expected.mode, followed):
        faults.append(f"rule {named} in mode {expected.mode}")
    others = oracle.considered_numbers(a.view)
    if considered_by(made, i).tolist() != sorted(others):
        faults.append(f"considered {considered_by(made, i)}, not {others}")
    return faults


def _remembered(a: Asked, expected: Expected, made: Decisions, tally: Tally) -> Memory | None:
    """What the robot remembers of its decision; None where that is not known for sure."""
    command = right_command(expected, made.command[a.view.index])
    if command is None or not expected.answers[command].sure:
        return None
    time, s = expected.answers[command].time, a.settings
    hold = expected_hold(a.view, s, expected, command)
    is_short = hold < expected.period
    by_time = timing.interval(expected.period, s.beta, time, s.event_triggered)
    tally.met["shortened by (14)"] += by_time < expected.period
    tally.met["shortened by the stop"] += hold < by_time
    if expected.mode != switching.SAFE or is_short:
        return Memory(expected.mode)  # what is left of a plan is dropped
    return Memory(expected.mode, expected.rest[command])


def fresh_mode(expected: Expected, time: float, s: ModeSwitchingSettings) -> int:
    """Mode of a robot that came from safe mode, with avoidance on."""
    on = s if s.avoidance != "none" else s.model_copy(update={"avoidance": "time_first"})
    seen = (expected.distance, time, expected.boundary_distance)
    return switching.next_mode(switching.SAFE, *seen, on)


def met_by(a: Asked, expected: Expected) -> dict[str, int]:
    """Which branches a decision went through: 1, or 0 for those that it did not."""
    s, seen, me = a.settings, a.view, a.view.me
    by = {switching.SAFE: "safe", switching.BY_DISTANCE: "(12)", switching.BY_TIME: "(13)"}
    mode = by[expected.mode]
    answer = next(iter(expected.answers.values()))
    left = paths.lengths(me.path)[-1] - me.station
    nu = oracle.forward_speed(seen)
    time = answer.time
    others = [other for _, other in seen.others]
    fresh = fresh_mode(expected, time, s)
    within = expected.boundary_distance < s.safe_distance
    met = {
        f"mode {mode}": True,
        f"{mode} settled by (5)": expected.settled > 1,
        f"{mode} settled by heading": expected.settled > (1 if mode == "safe" else 2),
        "settled by |omega|": expected.settled == (3 if mode == "safe" else 4),
        "settled by order": expected.settled == (4 if mode == "safe" else 5),
        "(12) with boundary within L": mode == "(12)" and within,
        "(12) with boundary beyond L": mode == "(12)" and not within,
        "(12) with others": mode == "(12)" and expected.considered > 0,
        "(12) while touching": mode == "(12)"
        and min(expected.distance, expected.boundary_distance) < 0.0,
        "(13) with others": mode == "(13)" and expected.considered > 0,
        "safe with others": mode == "safe" and expected.considered > 0,
        "kept in danger by hysteresis": mode != "safe" and a.memory.mode in (1, 2) and fresh == 0,
        "a wall beyond boundary_time_high": s.boundary_time_high is not None
        and s.boundary_time_high < time <= s.time_high
        and mode == "safe"
        and a.memory.mode in (1, 2),
        "plan of several pairs": mode == "safe" and len(s.dwell_times) > 1,
        "plan gone on with": expected.continued,
        "too near to tell": len(expected.answers) > 1,
        "judged to the last waypoint": nu > 0.0 and s.update_period < left / nu < s.judge_ahead,
        "target past a wall": oracle.target_place(seen, s).outside,
        "equal stations": any(o.reference_station == me.reference_station for o in others),
        "ahead beyond range along s*": any(
            o.reference_station - me.reference_station > seen.cluster.range for o in others
        ),
        "behind within range": any(o.reference_station < me.reference_station for o in others),
        "speed by (7) at its bound": seen.cluster.active
        and nu in (seen.cluster.v_min, seen.cluster.v_max),
        "speed by (7) between": seen.cluster.active
        and seen.cluster.v_min < nu < min(seen.cluster.v_max, me.limits[0]),
        "speed at the robot's limit": nu == me.limits[0],
        "neighbours listed": seen.cluster.active and seen.cluster.adjacency is not None,
        "without formation": not seen.cluster.active,
        "own set of speeds": me.speeds is not None and mode != "safe",
        "own set of omegas": me.omegas is not None,
        "reverse in safe mode": s.reverse_in_safe_mode and mode == "safe" and seen.cluster.active,
        "forward only without formation": s.reverse_in_safe_mode is False
        and mode == "safe"
        and not seen.cluster.active,
        "translation": s.collision_motion == "translation" and time < math.inf,
        "nonconvex": len(me.parts) > 1,
        "no collision within the horizon": time == math.inf,
        "avoidance off": s.avoidance == "none" and fresh_mode(expected, time, s) != 0,
        "(12) before a short time": s.avoidance == "distance_first"
        and mode == "(12)"
        and 0.0 < time < s.time_low,
        "(13) behind no short time": s.avoidance in ("distance_first", "time")
        and mode == "(13)"
        and time > s.time_high,
        "stretched": timing.longest_interval(s) > s.update_period,
        "not stretched": timing.longest_interval(s) == s.update_period,
        "without events": not s.event_triggered and s.beta * time < expected.period,
    }
    return {name: int(bool(is_so)) for name, is_so in met.items()}
