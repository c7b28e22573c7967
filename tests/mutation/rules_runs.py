"""Rules of a run and of what is told of it, broken: stages, arrival, states, records, metrics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.helpers import inside
from tests.mutation.rules import called, found, given, instead, replaced, rule

ARRIVAL = "physim.simulation.arrival:"
CHECKS = "physim.simulation.decision_checks:"
CRASH = "physim.analysis.crashtest."
DISTANCES = "physim.analysis.metrics.distances:"
LOOP = "physim.simulation.loop:Simulation."
MOTION = "physim.analysis.metrics.motion:"
PROGRESS = "physim.analysis.metrics.progress:"
RANDOM = "physim.randomness:"


# Random numbers


@rule("basics")
def all_robots_draw_alike() -> None:
    """The numbers of a pair of indices do not depend on the second."""
    given(RANDOM + "draw", second=lambda a: np.zeros_like(a.second))


@rule("basics")
def every_step_draws_alike() -> None:
    """The numbers of a step are those of step 0."""
    given(RANDOM + "draw", step=lambda a: np.uint64(0))


@rule("basics")
def purposes_share_a_stream() -> None:
    """What is drawn for one purpose shifts what is drawn for another."""
    instead(RANDOM + "purpose_key", lambda a: 1)


@rule("basics")
def robots_share_a_stream() -> None:
    """One robot more shifts what others draw."""
    given(RANDOM + "stream", robot=lambda a: 0)


@rule("basics")
def normal_numbers_are_even() -> None:
    """Numbers that are to be normal have a deviation of 1 and bounds."""
    from physim.randomness import uniform

    instead(RANDOM + "normal", lambda a: math.sqrt(12.0) * (uniform(**vars(a)) - 0.5))


# Stages of a step


def knowing(a: Any, sensed: Any, old: Any) -> Any:
    """Call with other things sensed, and put back what was."""
    simulation, known = a.self, a.self._sensed
    simulation._sensed = sensed, (known or a.self._sense())[1]
    try:
        return old()
    finally:
        simulation._sensed = known


def truth_of(a: Any) -> Any:
    everybody = inside("physim.parts", "everybody")

    return everybody(a.self.now, a.self._shared)


@rule("loop")
def controllers_know_the_truth() -> None:
    """Controllers see what is, whatever the sensing stages make of it."""

    def decide(old: Any, a: Any) -> Any:
        a.self._sense()
        return knowing(a, truth_of(a), old)

    called(LOOP + "_decide", decide)


@rule("loop")
def filters_know_the_truth() -> None:
    """Filters see what is, whatever the sensing stages make of it."""

    def act(old: Any, a: Any) -> Any:
        a.self._sense()
        return knowing(a, truth_of(a), old)

    called(LOOP + "_filter", act)


@rule("loop")
def others_are_seen_by_what_moved_them() -> None:
    """The command that a robot holds, as others see it, is the applied one, not the nominal."""
    given(LOOP + "_arrive", nominal=lambda a: a.self._told[-1])


@rule("loop")
def filters_get_disturbed_commands() -> None:
    """A filter is given what disturbances make of the nominal commands, not these."""

    def exchange(old: Any) -> Any:
        def act(self: Any, nominal: Any) -> Any:
            disturbed = self._disturb(nominal)[0] if self.parts.disturbances else nominal
            return old(self, np.clip(disturbed, -self.scene.limits, self.scene.limits))

        return act

    replaced(LOOP + "_filter", exchange)


@rule("loop")
def holds_are_rounded_up() -> None:
    """A command is held for the steps that its time begins, not for those it fills."""
    given(CHECKS + "fits", hold=lambda a: np.ceil(a.hold / a.dt - 1e-9) * a.dt)
    given(CHECKS + "hold_steps", hold=lambda a: np.ceil(a.hold / a.scene.dt - 1e-9) * a.scene.dt)


@rule("loop")
def limits_bind_speeds_forward_alone() -> None:
    """A robot may turn as fast as its controller likes."""
    half = np.array((1.0, 0.0))
    given(CHECKS + "within", command=lambda a: a.command * half)
    given(CHECKS + "check_commands", command=lambda a: a.command * half)


@rule("loop")
def formation_errors_leave_out_leads() -> None:
    """A formation error is the distance to the mean place, not held against its desired one."""
    instead(
        "physim.simulation.observation:formation_errors",
        lambda a: a.reference_station.mean(axis=-1, keepdims=True) - a.reference_station,
    )


@rule("loop")
def formation_errors_are_to_the_first_robot() -> None:
    """A formation error is the distance to the base node, not to the mean of all."""

    def to_the_first(a: Any) -> Any:
        station, lead = a.reference_station, a.scene.formation.lead
        return (station[..., :1] - station) - (lead[0] - lead)

    instead("physim.simulation.observation:formation_errors", to_the_first)


# Arrival


@rule("loop")
def passing_its_stop_is_arriving() -> None:
    """A robot has arrived when its station is there, moving or not."""
    given(ARRIVAL + "note_arrivals", near=lambda a: np.full_like(a.near, np.inf))
    given(ARRIVAL + "arrivals", near=lambda a: np.full_like(a.near, np.inf))


@rule("loop")
def standing_anywhere_is_arriving() -> None:
    """A robot has arrived when it stands, wherever that is."""
    given(ARRIVAL + "note_arrivals", least=lambda a: np.full_like(a.least, -np.inf))
    given(ARRIVAL + "arrivals", least=lambda a: np.full_like(a.least, -np.inf))


@rule("loop")
def who_arrived_once_has_arrived() -> None:
    """A robot that drives on, or is pushed away, still counts as arrived."""
    instead(
        ARRIVAL + "since",
        lambda a: np.where(a.arrived.any(axis=0), a.arrived.argmax(axis=0), -1),
    )


@rule("loop")
def all_arrive_at_some_time() -> None:
    """A run is finished when each robot has stood at its stop, not all of them at one sample."""

    def ever(old: Any, a: Any) -> None:
        old()
        so_far = getattr(a.self, "ever", False) | a.self.arrived
        a.self.ever, a.self.all = so_far, bool(np.all(so_far))

    called(ARRIVAL + "Arrivals.follow", ever)


@rule("loop")
def standing_is_to_be_back() -> None:
    """Who is where it was half a second ago stands, whatever it did in between."""

    def ends_alone(old: Any, a: Any) -> bool:
        length = len(a.trail)
        row = a.step % length
        a.trail[row] = a.pose[:, :2]
        moved = np.hypot(*(a.trail[(row + 1) % length] - a.trail[row]).T)
        a.arrived[:] = (a.station >= a.least) & (moved <= a.near) & (a.step + 1 >= length)
        return bool(a.arrived.all())

    called(ARRIVAL + "note_arrivals", ends_alone)


# States and records


def afterwards(where: str, act: Any) -> None:
    """Do something more once a method has returned."""

    def more(old: Any, a: Any) -> Any:
        value = old()
        act(a)
        return value

    called(where, more)


@rule("loop")
def memories_stay_behind() -> None:
    """What controllers remember does not come along with a state."""

    def forget(a: Any) -> None:
        a.self.memory = {name: np.zeros_like(one) for name, one in a.self.memory.items()}

    afterwards(LOOP + "restore", forget)


@rule("loop")
def stages_begin_anew() -> None:
    """Sensing, filters and disturbances do not come along with a state."""

    def begin(a: Any) -> None:
        a.self._stages = a.self.parts.start(a.self.scene)

    afterwards(LOOP + "restore", begin)


@rule("loop")
def all_decide_after_a_state() -> None:
    """When robots decide next does not come along with a state."""

    def now(a: Any) -> None:
        a.self.next_decision = np.full_like(a.self.next_decision, a.self.now.step)
        a.self._next_due = a.self.now.step

    afterwards(LOOP + "restore", now)


@rule("loop")
def blocks_do_not_meet() -> None:
    """A contact between the last sample of a block and the first of the next is not found."""

    def forget(old: Any, a: Any) -> Any:
        a.self._before = tuple(one[:0] for one in a.self._before)
        return old()

    called("physim.simulation.swept_contacts:SweptContactFinder.rows", forget)


@rule("loop")
def distances_are_those_of_samples_told() -> None:
    """A coarse record has the distances at its samples, not the least ones since the one before."""

    def forget(old: Any, a: Any) -> Any:
        a.self.least = np.full_like(a.self.least, np.inf)
        return old()

    called("physim.simulation.recorder:Recorder._write_poses", forget)


@rule("record")
def extremes_are_those_of_the_last_block() -> None:
    """An extreme is that of the samples noted last, not of all."""

    def anew(old: Any, a: Any) -> None:
        for name in ("clearance", "boundary_clearance"):
            a.self.rows[name] = np.inf
        a.self.farthest["farthest"] = -np.inf
        old()

    called("physim.record.writer:Extremes.note", anew)


@rule("record")
def digest_leaves_out_the_motion() -> None:
    """Two records with other poses may have one digest."""
    called(
        "physim.record.layout:_add",
        lambda old, a: None if a.path.startswith("/steps") else old(),
    )


@rule("metrics")
def every_stage_has_the_nominal_command() -> None:
    """The record tells the nominal command where the filtered or applied one is asked for."""
    given("physim.record.history:RecordedHistory.commands_over", stage=lambda a: "nominal")


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
def danger_is_counted_by_decisions() -> None:
    """The share of danger mode is one of decisions, not of the time that they held."""
    given("physim.analysis.metrics.modes:_danger_share", weight=lambda a: np.ones_like(a.weight))


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
    from physim.analysis.metrics import decisions

    instead("physim.analysis.metrics.modes:messages", lambda a: decisions(a.record))


@rule("metrics")
def leads_are_those_over_the_first() -> None:
    """(10) holds the distance to the mean place against the lead over the base node."""
    instead(MOTION + "desired_leads", lambda a: a.record.lead)


@rule("metrics")
def width_is_twice_the_nearer_side() -> None:
    """The width of a corridor is that about its path, as if that ran in the middle (Fig. 4)."""
    replaced(
        "physim.geometry.corridor:Widths.width",
        lambda old: property(lambda self: 2.0 * np.minimum(self.left, self.right)),
    )


@rule("metrics")
def walls_of_a_corridor_are_lines_like_others() -> None:
    """Which wall is left goes by the half-plane, in a corridor that passes itself as well."""
    given("physim.geometry.corridor:side_feet", walls=lambda a: None)


@rule("metrics")
def nearest_pair_is_nearest_at_the_end() -> None:
    """The shortest distance is that of the last sample."""
    from dataclasses import replace

    from physim.analysis.metrics import Moment

    def last(value: Any, a: Any) -> Any:
        if not isinstance(value, Moment) or not a.record.samples:
            return value
        return replace(value, value=float(a.record.clearance[-1].min()))

    found(DISTANCES + "shortest_distance", last)


# Crash test


@rule("crashtest")
def predictions_go_straight() -> None:
    """The analysis foresees straight motion where the robots go on arcs (1)."""

    def straight(a: Any) -> Any:
        case, some = a.case, slice(a.case.first, a.case.last)
        pose, command = case.start[some].copy(), case.command[some]
        pose[:, 0] += a.t * command[:, 0] * np.cos(pose[:, 2])
        pose[:, 1] += a.t * command[:, 0] * np.sin(pose[:, 2])
        pose[:, 2] += a.t * command[:, 1]
        return pose

    instead(CRASH + "prediction:poses_at", straight)


@rule("crashtest")
def cases_are_judged_a_sample_late() -> None:
    """The distances by which a case is judged are those one sample later."""
    given(CRASH + "report:classify", distance=lambda a: np.append(a.distance[1:], a.distance[-1:]))


@rule("crashtest")
def closing_is_that_of_reference_points() -> None:
    """How fast a gap closes goes by how robots move, not by how their nearest points do."""
    given(CRASH + "prediction:point_speed", x=lambda a: a.pose[0], y=lambda a: a.pose[1])


@rule("crashtest")
def cases_are_one_case() -> None:
    """Every case of a seed draws what the first of its kind draws."""
    given(CRASH + "drawing:draw_case", number=lambda a: a.number % 8)
