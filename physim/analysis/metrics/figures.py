"""All figures of a run: `Figures`, and the one table of its metrics, `DEFINITIONS`.

A metric that has no meaning for a run (the distance between robots of a single one, say) is
absent. Over all physics steps, also those that are not recorded: distances. At all samples:
deviations and formation errors. Over all decisions: collision times, modes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from types import MappingProxyType

import numpy as np

from physim.analysis.metrics import contacts, modes, motion, progress
from physim.analysis.metrics.contacts import Deep, Episode, Graze, Severity
from physim.analysis.metrics.distances import (
    Width,
    corridor_width,
    near_wall,
    shortest_pair_collision_time,
)
from physim.analysis.metrics.metric import Definition, Metric, Moment, Place, Series
from physim.analysis.metrics.progress import Absent
from physim.analysis.metrics.registered import own_metrics
from physim.errors import PhysimError, nearest
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record, check_record


class Figures:
    """Figures of one run, each worked out from its record once, when it is first asked for.

    What was worked out stays with the record, so `Figures(record)` costs nothing: make one
    wherever a figure is needed. Arrays are shared; do not write into them. What has no meaning for
    the run is None. Raises TypeError for what is no record, RecordError for a damaged one.
    """

    __slots__ = ("__dict__", "record")
    record: Record

    def __init__(self, record: Record) -> None:
        """Take the figures of a record."""
        check_record(record)
        self.record = record
        self.__dict__ = vars(record).setdefault("figures", {})

    @cached_property
    def episodes(self) -> tuple[Episode, ...]:
        """Contacts that last, in the order of their beginning; their number is "contacts: N"."""
        return contacts.contact_episodes(self.record)

    @cached_property
    def grazes(self) -> tuple[Graze, ...]:
        """Contacts between two samples, in the order of time."""
        return contacts.grazes(self.record)

    @cached_property
    def deep(self) -> tuple[Deep, ...]:
        """Contacts too deep to be true, in the order of time."""
        return contacts.deep_contacts(self.record)

    @cached_property
    def severest(self) -> tuple[Episode, Severity] | None:
        """The contact of the greatest closing speed, then energy lost, then impulse.

        None without contacts, and where not every step is recorded.
        """
        if not self.episodes or self.record.samples <= self.record.steps_made:
            return None
        mass = contacts.masses(self.record)
        found = [(one, contacts.severity(self.record, one, mass)) for one in self.episodes]
        return max(
            found, key=lambda one: (one[1].closing, one[1].energy or 0.0, one[0].impulse or 0.0)
        )

    @cached_property
    def nearest(self) -> Moment | None:
        """The shortest distance [m] of two robots, (11); negative = depth."""
        moved = [one for one in self.grazes if one.b < self.record.moving]
        return self._shortest("clearance", "clearance", moved)

    @cached_property
    def nearest_wall(self) -> Moment | None:
        """The shortest distance [m] of a robot to a boundary or obstacle; negative = depth."""
        walls = [one for one in self.grazes if one.b >= self.record.moving]
        return self._shortest("boundary_clearance", "boundary", walls)

    def _shortest(self, value: str, which: str, grazed: list[Graze]) -> Moment | None:
        """The shortest at a sample, or that of the deepest contact between two."""
        rows = self.record.extremes
        if not (rows[f"{which}_step"] >= 0).any():
            return None
        who = int(np.argmin(rows[value]))
        row = rows[who]
        if grazed and -(deepest := max(grazed, key=lambda one: one.depth)).depth < row[value]:
            less, a, b = 0.0 - deepest.depth, deepest.a, deepest.b
            return Moment(less, deepest.step, deepest.time, a, b)
        return Moment.at(self.record, row[value], row[f"{which}_step"], who, row[f"{which}_other"])

    @cached_property
    def least(self) -> Moment | None:
        """The shortest distance [m] of a robot to anything, robot or wall."""
        found = [one for one in (self.nearest, self.nearest_wall) if one is not None]
        return min(found, key=lambda one: one.value, default=None)

    @cached_property
    def farthest(self) -> Moment | None:
        """The largest distance [m] of two robots (Fig. 6)."""
        row = self.record.farthest
        if row["step"] < 0:
            return None
        return Moment.at(self.record, row["farthest"], row["step"], row["a"], row["b"])

    @cached_property
    def collision_time(self) -> Moment | None:
        """The shortest collision time [s] at a decision, (11) (Figs. 3, 6)."""
        times = self.record.column("collision_time", absent=np.inf)
        times = np.nan_to_num(times, nan=np.inf, posinf=np.inf)
        if not np.isfinite(times).any():
            return None
        row = self.record.updates[k := int(np.argmin(times))]
        return Moment.at(self.record, times[k], row["step"], row["robot"])

    @cached_property
    def seen_collision_time(self) -> Moment | None:
        """The shortest collision time [s] of a robot and what moves that go on as a log shows them;
        None of a run, where decisions tell more."""
        return shortest_pair_collision_time(self.record) if self.record.judged else None

    @cached_property
    def absent(self) -> tuple[Absent, ...]:
        """Robots that have not arrived, by index."""
        return progress.absent(self.record)

    @cached_property
    def active_steps(self) -> IntArray:
        """(N,) steps until each robot was at its stop station for good."""
        return progress.active_steps(self.record)

    @cached_property
    def averaged(self) -> motion.AveragedSpeeds:
        """Speeds averaged over 10 s."""
        return motion.averaged_speeds(self.record)

    @cached_property
    def formation_errors(self) -> FloatArray | None:
        """(K, N) [m] at the samples, (10)."""
        return motion.sampled_errors(self.record)

    @cached_property
    def energy(self) -> Series | None:
        """Formation energy W [m^2] at the samples, (9)."""
        return motion.formation_energy(self.record)

    @cached_property
    def width(self) -> Width | None:
        """Width along the first robot's path."""
        return corridor_width(self.record) if self.record.robots else None

    @cached_property
    def where_nearest_wall(self) -> str:
        """Where along its wall the shortest boundary distance was; empty where not known."""
        at = self.nearest_wall
        return "" if at is None or at.b is None else near_wall(self.record, at.a, at.b, at.step)

    @cached_property
    def _taken(self) -> dict[str, Metric | None]:
        return {}

    def metric(self, name: str) -> Metric | None:
        """A metric by name; None where it has no meaning for the run.

        Registered ones are taken anew each time. Raises PhysimError, with the nearest name, for an
        unknown one, and for a registered metric that fails.
        """
        if name not in DEFINITIONS:
            return Metric.of(definition(name), self)
        if name not in self._taken:
            self._taken[name] = Metric.of(DEFINITIONS[name], self)
        return self._taken[name]

    def value(self, name: str) -> bool | int | float | None:
        """Value of a metric; None where it has no meaning for the run."""
        found = self.metric(name)
        return None if found is None else found.value

    def metrics(self) -> tuple[dict[str, Metric], tuple[str, ...]]:
        """Every metric that has a meaning for the run: physim's own, then registered ones.

        With a line for each registered one that failed.
        """
        own = own_metrics(DEFINITIONS)
        found, faults = {name: self.metric(name) for name in DEFINITIONS}, list(own.faults)
        for name, what in own.definitions.items():
            try:
                found[name] = Metric.of(what, self)
            except PhysimError as error:
                faults.append(str(error))
        return {name: one for name, one in found.items() if one is not None}, tuple(faults)


def measure(record: Record, names: Iterable[str] | None = None) -> dict[str, Metric]:
    """Take metrics of a run from its record alone: all, or those of ``names``, in their order.

    All are physim's own (`DEFINITIONS`) and those that packages registered. Metrics that have no
    meaning for the run are left out. Raises PhysimError for an unknown name and for a registered
    metric that fails, RecordError for a damaged record.
    """
    run = Figures(record)
    if names is None:
        found, faults = run.metrics()
        if faults:
            raise PhysimError(faults[0])
        return found
    taken = {name: run.metric(name) for name in names}
    return {name: metric for name, metric in taken.items() if metric is not None}


def definition(name: str) -> Definition:
    """Definition of a metric. Raises PhysimError, with the nearest one, for an unknown name."""
    own = own_metrics(DEFINITIONS)
    known = {**own.definitions, **DEFINITIONS}
    if name in known:
        return known[name]
    for fault in own.faults:
        if f'"{name}"' in fault:
            raise PhysimError(fault)
    close = nearest(name[:100], [*DEFINITIONS, *own.definitions])
    raise PhysimError(f'no metric is called "{name[:100]}"{close} (physim summary --definitions)')


# What the table finds, beside the figures above


def _contacts(run: Figures, first: int = 0, last: int | None = None) -> int | None:
    """How many contacts robots have with bodies ``first`` to ``last - 1``; None without any."""
    if "contacts" not in run.record.tables or last in (first, 1):
        return None
    last = len(run.record.bodies) if last is None else last
    return sum(first <= episode.b < last for episode in run.episodes)


def _first_contact(run: Figures) -> Moment | None:
    for one in run.episodes:
        return Moment.at(run.record, one.time, one.step, one.a, one.b)
    return None


def _deepest_contact(run: Figures) -> Moment | None:
    if not run.episodes:
        return None
    one = max(run.episodes, key=lambda episode: episode.depth)
    return Moment.at(run.record, one.depth, one.depth_step, one.a, one.b)


def _severest(run: Figures, figure: Callable[[Episode, Severity], float | None]) -> Moment | None:
    """A figure of the severest contact."""
    if run.severest is None or (value := figure(*run.severest)) is None:
        return None
    one = run.severest[0]
    return Moment.at(run.record, value, one.step, one.a, one.b)


def _formation_error(run: Figures, first: int = 0) -> Moment | None:
    """The largest size at the samples from one on."""
    errors = run.formation_errors
    return None if errors is None else motion.extreme(run.record, np.abs(errors), first)


def _deviation(run: Figures) -> Moment | None:
    return motion.extreme(run.record, np.abs(run.record.course[:, :, 1]))


def _energy(run: Figures, last: bool) -> float | None:
    course = run.energy
    if course is None or not len(course.values):
        return None
    return float(course.values[-1] if last else course.values.max())


def _averaged(run: Figures, values: FloatArray, largest: bool) -> Moment | None:
    """The largest or smallest of averaged speeds (K, N)."""
    if not np.isfinite(values).any():
        return None
    place = int(np.nanargmax(values) if largest else np.nanargmin(values))
    k, robot = np.unravel_index(place, values.shape)
    at = float(run.averaged.time[k])
    return Moment(float(values[k, robot]), round(at / run.record.dt), at, int(robot))


def _width(run: Figures, largest: bool) -> Place | None:
    if run.width is None or not np.isfinite(run.width.width).any():
        return None
    width = np.where(np.isfinite(run.width.width), run.width.width, np.nan)
    k = int(np.nanargmax(width) if largest else np.nanargmin(width))
    return Place(float(width[k]), float(run.width.station[k]), 0)


DEFINITIONS = MappingProxyType({one.name: one for one in (
    Definition("simulated_time", "s", "simulated time of the run", "-",
               lambda run: run.record.steps_run * run.record.dt),
    Definition("finished", "-",
               "whether every robot stood at its stop station at the end, judged by its motion",
               "-", lambda run: progress.finished(run.record)),
    Definition("time_to_finish", "s",
               "time from which all robots stand at their stop stations", "Section 1",
               lambda run: progress.time_to_finish(run.record)),
    Definition("stop_distance", "m", "largest distance of a robot from its stop station at "
               "the end, if all have arrived", "-",
               lambda run: progress.stop_distance(run.record)),
    Definition("standstill", "s", "time before the end over which no robot that had not arrived "
               "advanced 0.1 m along its path; 0 if all arrived", "-",
               lambda run: progress.standstill(run.record)),
    Definition("contacts", "-",
               "contact episodes: maximal runs of samples at which two bodies touch", "-",
               _contacts),
    Definition("contacts_between_robots", "-", "contact episodes of two robots", "-",
               lambda run: _contacts(run, 0, run.record.robots)),
    Definition("contacts_with_movers", "-",
               "contact episodes of a robot and a mover or an obstacle that can be pushed", "-",
               lambda run: _contacts(run, run.record.robots, run.record.moving)),
    Definition("contacts_with_boundaries", "-",
               "contact episodes of a robot and a boundary or obstacle", "-",
               lambda run: _contacts(run, run.record.moving)),
    Definition("grazes", "-",
               "contacts between two samples: apart at both, touching within the step", "-",
               lambda run: len(run.grazes) if "contacts" in run.record.tables else None),
    Definition("first_contact", "s", "time of the first sample of the first contact", "-",
               _first_contact),
    Definition("deepest_contact", "m", "greatest depth of any contact", "-", _deepest_contact),
    Definition("closing_speed", "m/s", "closing speed along the normal just before the "
               "severest contact, which is the one with the greatest", "-",
               lambda run: _severest(run, lambda _, how: how.closing)),
    Definition("energy_lost", "J", "kinetic energy lost in the impact of the severest contact", "-",
               lambda run: _severest(run, lambda _, how: how.energy)),
    Definition("impulse", "N s", "impulse of the severest contact, its impact and the pushing",
               "-", lambda run: _severest(run, lambda hit, _: hit.impulse)),
    Definition("shortest_distance", "m",
               "shortest distance of a robot to another, or to what moves; negative = depth",
               "(11), Figs. 3b, 6c", lambda run: run.nearest),
    Definition("shortest_boundary_distance", "m",
               "shortest distance of a robot to a boundary or obstacle; negative = depth", "(11)",
               lambda run: run.nearest_wall),
    Definition("farthest_distance", "m", "largest distance between the shapes of two robots",
               "Fig. 6c", lambda run: run.farthest),
    Definition("shortest_collision_time", "s",
               "shortest collision time that a decision reported", "(11), Figs. 3c, 6d",
               lambda run: run.collision_time),
    Definition("seen_collision_time", "s",
               "of a log that was judged: shortest collision time of a robot and what else moves "
               "that go on as they are seen to move", "(11)", lambda run: run.seen_collision_time),
    Definition("formation_error_peak", "m", "largest size of a formation error at any sample",
               "(10), Figs. 2b, 7a", _formation_error),
    Definition("formation_error_final", "m",
               "largest size of the formation errors at the last sample", "(10), Figs. 2b, 7a",
               lambda run: _formation_error(run, -1)),
    Definition("formation_error_rms", "m", "root mean square of the formation errors over time",
               "(10), Figs. 2b, 7a",
               lambda run: motion.formation_error_rms(run.record, run.formation_errors)),
    Definition("formation_energy_peak", "m^2", "largest formation energy W", "(9)",
               lambda run: _energy(run, last=False)),
    Definition("formation_energy_final", "m^2", "formation energy W at the end", "(9)",
               lambda run: _energy(run, last=True)),
    Definition("deviation_peak", "m",
               "largest size of a deviation from the own path at any sample", "Figs. 1b, 2c, 7d",
               _deviation),
    Definition("deviation_rms", "m",
               "root mean square deviation from the own path over the active time",
               "Figs. 1b, 2c, 7d", lambda run: motion.deviation_rms(run.record)),
    Definition("mean_speed", "m/s", "mean applied forward speed over the active time", "Fig. 7c",
               lambda run: motion.mean_speed(run.record)),
    Definition("averaged_speed_min", "m/s",
               "smallest forward speed averaged over 10 s in which the robot is active",
               "Fig. 7c", lambda run: _averaged(run, run.averaged.forward, largest=False)),
    Definition("averaged_speed_max", "m/s",
               "largest forward speed averaged over 10 s in which the robot is active",
               "Fig. 7c", lambda run: _averaged(run, run.averaged.forward, largest=True)),
    Definition("averaged_rotation_min", "rad/s", "smallest rotational speed averaged over 10 s in "
               "which the robot is active: fastest turn to the right", "Figs. 1c, 7b",
               lambda run: _averaged(run, run.averaged.rotational, largest=False)),
    Definition("averaged_rotation_max", "rad/s", "largest rotational speed averaged over 10 s in "
               "which the robot is active: fastest turn to the left", "Figs. 1c, 7b",
               lambda run: _averaged(run, run.averaged.rotational, largest=True)),
    Definition("speed_changes", "m/s^2", "sum of the changes of the commanded forward speed, by "
               "size, per second of active time of a mean robot", "-",
               lambda run: motion.command_changes(run.record, 0)),
    Definition("rotation_changes", "rad/s^2", "sum of the changes of the commanded rotational "
               "speed, by size, per second of active time of a mean robot", "-",
               lambda run: motion.command_changes(run.record, 1)),
    Definition("width_min", "m", "least corridor width along the first robot's path, every "
               "0.1 m: shortest distance to the left boundary plus that to the right one",
               "Fig. 4", lambda run: _width(run, largest=False)),
    Definition("width_max", "m",
               "greatest corridor width along the first robot's path", "Fig. 4",
               lambda run: _width(run, largest=True)),
    Definition("danger_share", "-", "share of the active time in modes declared as danger",
               "Figs. 5, 8", lambda run: modes.share_of_modes(run.record, danger=True)),
    Definition("safe_share", "-", "share of the active time in all other modes", "Figs. 5, 8",
               lambda run: modes.share_of_modes(run.record, danger=False)),
    Definition("mode_switches", "1/min",
               "changes between safe and danger mode per minute of active time", "Figs. 5, 8",
               lambda run: modes.mode_switches(run.record)),
    Definition("decisions", "-", "decisions of all robots", "(14)",
               lambda run: len(run.record.updates) if "updates" in run.record.tables else None),
    Definition("updates_per_second", "1/s", "decisions per second of an active robot", "(14)",
               lambda run: modes.updates_per_second(run.record)),
    Definition("messages", "-", "messages: one for each considered robot and decision", "(14)",
               lambda run: modes.messages(run.record)),
    Definition("collision_time_evaluations", "-", "collision times computed for the decisions",
               "(11), (14)", lambda run: modes.evaluations(run.record)),
    Definition("filtered_steps", "-",
               "robot-steps over which the filtered command differs from the nominal one", "-",
               lambda run: modes.differing_steps(run.record, "nominal", "filtered")),
    Definition("disturbed_steps", "-",
               "robot-steps over which the applied command differs from the filtered one", "-",
               lambda run: modes.differing_steps(run.record, "filtered", "applied")),
)})  # fmt: skip
"""Every metric by name, in the order of reports."""
