"""Rules of a run and of what is told of it, broken: holds, limits, arrival, metrics, crash test."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.mutation.rules import called, found, given, instead, replaced, rule

ARRIVAL = "physim.simulation.arrival:"
CHECKS = "physim.simulation.checks:"
CRASH = "physim.analysis.crashtest."
MOTION = "physim.analysis.metrics.motion:"
PROGRESS = "physim.analysis.metrics.progress:"


@rule("simulation")
def holds_are_rounded_up() -> None:
    """A command is held for the steps that its time begins, not for those it fills."""

    def longer(a: Any) -> Any:
        dt = a.allowed.dt
        return a.d._replace(hold=np.ceil(a.d.hold / dt - 1e-9) * dt)

    given(CHECKS + "decision_fault", d=longer)


@rule("simulation")
def limits_bind_speeds_forward_alone() -> None:
    """A robot may turn as fast as its controller likes."""
    half = np.array((1.0, 0.0))
    given(CHECKS + "command_fault", command=lambda a: a.command * half)
    given(CHECKS + "decision_fault", d=lambda a: a.d._replace(command=a.d.command * half))


@rule("simulation")
def formation_errors_leave_out_leads() -> None:
    """A formation error is the distance to the mean place, not held against its desired one."""
    instead(
        "physim.simulation.observation:formation_errors",
        lambda a: a.reference_station.mean(axis=-1, keepdims=True) - a.reference_station,
    )


# Arrival


def bounded(**rows: float) -> None:
    """Judge arrivals by other bounds: of the station, beside the stop, and of motion."""
    names = ("least", "greatest", "beside", "moved")

    def others(a: Any) -> Any:
        bounds = a.bounds.copy()
        for name, value in rows.items():
            bounds[:, names.index(name)] = value
        return bounds

    given(ARRIVAL + "judge_arrivals", bounds=others)


@rule("simulation")
def passing_its_stop_is_arriving() -> None:
    """A robot has arrived when its station is there, moving or not."""
    bounded(moved=math.inf)


@rule("simulation")
def standing_anywhere_is_arriving() -> None:
    """A robot has arrived when it stands, wherever that is."""
    bounded(least=-math.inf, greatest=math.inf, beside=math.inf)


@rule("simulation")
def standing_beside_a_stop_is_arriving() -> None:
    """A robot has arrived where its station is there, however far beside its path it stands."""
    bounded(beside=math.inf)


@rule("simulation")
def who_arrived_once_has_arrived() -> None:
    """A robot that drives on, or is pushed away, still counts as arrived."""

    def once(a: Any) -> Any:
        first = np.where(a.arrived.any(axis=0), a.first + a.arrived.argmax(axis=0), -1)
        return np.where(a.before >= 0, a.before, first)

    instead(ARRIVAL + "later_since", once)


@rule("simulation")
def all_arrive_at_some_time() -> None:
    """A run is finished when each robot has stood at its stop, not all of them at one sample."""

    def ever(old: Any, a: Any) -> None:
        old()
        so_far = getattr(a.self, "ever", False) | a.self.arrived
        a.self.ever, a.self.all = so_far, bool(np.all(so_far))

    called(ARRIVAL + "Arrivals.follow", ever)


@rule("record")
def digest_leaves_out_the_motion() -> None:
    """Two records with other poses may have one digest."""
    called(
        "physim.record.reader:Record.read",
        lambda old, a: old()[:0] if a.path == "/steps/pose" and not a.check else old(),
    )


# Metrics


@rule("metrics")
def a_pair_has_one_contact() -> None:
    """Two bodies that part and touch again have one contact episode."""

    def first(episodes: Any, a: Any) -> Any:
        seen: dict[tuple[int, int], Any] = {}
        for one in episodes:
            seen.setdefault((one.a, one.b), one)
        return tuple(seen.values())

    found("physim.analysis.metrics.contacts:contact_episodes", first)


@rule("metrics")
def closing_speed_is_that_of_reference_points() -> None:
    """How hard a contact is goes by how the robots move, not by how the touching points do."""

    def middle(a: Any) -> Any:
        if a.body >= a.record.robots:
            return a.point
        return tuple(a.record.pose_at(a.step)[a.body, :2].tolist())

    given("physim.analysis.metrics.contacts:point_velocity", point=middle)


@rule("metrics")
def everybody_is_a_neighbour() -> None:
    """(9) sums over all pairs, not over N_i."""
    found(
        MOTION + "_neighbours",
        lambda value, a: (np.ones((a.record.robots, a.record.robots)), value[1]),
    )


@rule("metrics")
def time_at_the_stop_counts() -> None:
    """A robot that has arrived is still active."""
    instead(PROGRESS + "active_steps", lambda a: np.full(a.record.robots, a.record.steps_run))


@rule("metrics")
def deviation_counts_at_the_stop() -> None:
    """The root mean square deviation goes on over the time at the stop."""
    found(PROGRESS + "active_samples", lambda away, a: np.ones_like(away))


@rule("metrics")
def first_to_arrive_finishes() -> None:
    """The time to finish is that of the first robot."""
    found(
        PROGRESS + "time_to_finish",
        lambda time, a: None if time is None else float(a.record.arrived.min() * a.record.dt),
    )


@rule("metrics")
def messages_are_decisions() -> None:
    """A decision is one message, however many robots it considers (14)."""
    instead("physim.analysis.metrics.modes:messages", lambda a: len(a.record.updates))


@rule("metrics")
def leads_are_those_over_the_first() -> None:
    """(10) holds the distance to the mean place against the lead over the base node."""
    instead(MOTION + "desired_leads", lambda a: a.record.lead)


@rule("metrics")
def width_is_twice_the_nearer_side() -> None:
    """The width of a corridor is that about its path, as if that ran in the middle (Fig. 4)."""
    replaced(
        "physim.world.ground.corridor:Widths.width",
        lambda old: property(lambda self: 2.0 * np.minimum(self.left, self.right)),
    )


# Crash test


@rule("crashtest")
def predictions_go_straight() -> None:
    """The analysis foresees straight motion where the robots go on arcs (1)."""

    def straight(a: Any) -> int:
        some = slice(*a.batch.first_robot[a.k : a.k + 2])
        pose, command = a.batch.start[some].copy(), a.batch.command[some]
        pose[:, 0] += a.t * command[:, 0] * np.cos(pose[:, 2])
        pose[:, 1] += a.t * command[:, 0] * np.sin(pose[:, 2])
        pose[:, 2] += a.t * command[:, 1]
        a.pose[: len(pose)] = pose
        return len(pose)

    instead(CRASH + "prediction:put_poses", straight)


@rule("crashtest")
def closing_is_that_of_reference_points() -> None:
    """How fast a gap closes goes by how robots move, not by how their nearest points do."""
    given(CRASH + "prediction:closing_speed", x=lambda a: a.pose[0], y=lambda a: a.pose[1])
