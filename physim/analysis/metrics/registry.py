"""Every metric by name, with its definition, unit and source.

A metric that has no meaning for a run (the distance between robots of a single one, say) is
absent. Over all physics steps, also those that are not recorded: distances. At all samples:
deviations and formation errors. Over all decisions: collision times, modes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from types import MappingProxyType

from physim.analysis.metrics.contacts import Episode, Severity, contact_episodes, grazes, severest
from physim.analysis.metrics.distances import (
    Width,
    corridor_width,
    farthest_pair,
    shortest_boundary_distance,
    shortest_collision_time,
    shortest_distance,
    width_extreme,
)
from physim.analysis.metrics.metric import (
    Definition,
    Found,
    Metric,
    Moment,
    Place,
    Series,
)
from physim.analysis.metrics.modes import (
    decisions,
    disturbed_steps,
    evaluations,
    filtered_steps,
    messages,
    mode_switches,
    share_of_modes,
    updates_per_second,
)
from physim.analysis.metrics.motion import (
    AveragedSpeeds,
    averaged_extreme,
    averaged_speeds,
    deviation_peak,
    deviation_rms,
    formation_error_final,
    formation_error_peak,
    formation_error_rms,
    mean_speed,
    sampled_energy,
)
from physim.analysis.metrics.progress import finished, stop_distance, time_to_finish
from physim.analysis.metrics.registered import own_metrics
from physim.errors import PhysimError, nearest
from physim.geometry.shapes import FloatArray
from physim.record import Record, check_record


class Courses:
    """A record with what several metrics share, each worked out once."""

    def __init__(self, record: Record) -> None:
        self.record = record

    @cached_property
    def episodes(self) -> tuple[Episode, ...]:
        """Contact episodes."""
        return contact_episodes(self.record)

    @cached_property
    def severest(self) -> tuple[Episode, Severity] | None:
        """The severest contact."""
        return severest(self.record, self.episodes)

    @cached_property
    def averaged(self) -> AveragedSpeeds:
        """Speeds averaged over 10 s."""
        return averaged_speeds(self.record)

    @cached_property
    def energy(self) -> Series | None:
        """Formation energy W at the samples."""
        return sampled_energy(self.record)

    @cached_property
    def width(self) -> Width | None:
        """Width along the first robot's path."""
        return corridor_width(self.record) if self.record.robots else None


def _contacts(run: Courses, robots: bool | None = None) -> int | None:
    if (robots and run.record.robots < 2) or "contacts" not in run.record.tables:
        return None
    return sum(robots is None or episode.robots is robots for episode in run.episodes)


def _grazes(record: Record) -> int | None:
    return len(grazes(record)) if "contacts" in record.tables else None


def _first_contact(run: Courses) -> Moment | None:
    first = next(iter(run.episodes), None)
    return None if first is None else Moment(first.time, first.step, first.time, first.a, first.b)


def _deepest_contact(run: Courses) -> Moment | None:
    deepest = max(run.episodes, key=lambda episode: episode.depth, default=None)
    if deepest is None:
        return None
    time = deepest.depth_step * run.record.dt
    return Moment(deepest.depth, deepest.depth_step, time, deepest.a, deepest.b)


def _severest(run: Courses, figure: Callable[[Episode, Severity], float | None]) -> Moment | None:
    """A figure of the severest contact."""
    if run.severest is None or (value := figure(*run.severest)) is None:
        return None
    one = run.severest[0]
    return Moment(value, one.step, one.time, one.a, one.b)


def _energy(run: Courses, last: bool) -> float | None:
    course = run.energy
    if course is None or not len(course.values):
        return None
    return float(course.values[-1] if last else course.values.max())


def _averaged(run: Courses, values: FloatArray, largest: bool) -> Moment | None:
    return averaged_extreme(run.averaged.time, values, run.record.dt, largest)


def _width(run: Courses, largest: bool) -> Place | None:
    return None if run.width is None else width_extreme(run.width, 0, largest)


def _of(find: Callable[[Record], Found]) -> Callable[[Courses], Found]:
    """Turn a function of a record into one of `Courses`."""
    return lambda run: find(run.record)


_ALL = (
    Definition(
        "simulated_time", "s", "simulated time of the run", "-",
        lambda run: run.record.steps_run * run.record.dt,
    ),
    Definition(
        "finished", "-",
        "whether every robot stood at its stop station at the end, judged by its motion",
        "-", _of(finished),
    ),
    Definition(
        "time_to_finish", "s", "time at which the last robot stood at its stop station for good",
        "Section 1", _of(time_to_finish),
    ),
    Definition(
        "stop_distance", "m", "distance of a robot from its stop station at the end, once all have "
        "arrived, the largest", "-", _of(stop_distance),
    ),
    Definition(
        "contacts", "-", "contact episodes: maximal runs of samples at which two bodies touch",
        "-", _contacts,
    ),
    Definition(
        "contacts_between_robots", "-", "contact episodes of two robots", "-",
        lambda run: _contacts(run, True),
    ),
    Definition(
        "contacts_with_boundaries", "-", "contact episodes of a robot and a boundary or obstacle",
        "-", lambda run: _contacts(run, False),
    ),
    Definition(
        "grazes", "-", "contacts between two samples: apart at both, touching within the step", "-",
        _of(_grazes),
    ),
    Definition(
        "first_contact", "s", "time of the first sample of the first contact", "-", _first_contact,
    ),
    Definition(
        "deepest_contact", "m", "greatest depth of any contact", "-", _deepest_contact,
    ),
    Definition(
        "closing_speed", "m/s", "of the severest contact: the greatest closing speed of any, along "
        "the normal, just before", "-", lambda run: _severest(run, lambda _, how: how.closing),
    ),
    Definition(
        "energy_lost", "J", "by the impact of the severest contact", "-",
        lambda run: _severest(run, lambda _, how: how.energy),
    ),
    Definition(
        "impulse", "N s", "of the severest contact: the impact and the pushing after it", "-",
        lambda run: _severest(run, lambda one, _: one.impulse),
    ),
    Definition(
        "shortest_distance", "m", "shortest distance between two robots; negative = depth",
        "(11), Figs. 3b, 6c", _of(shortest_distance),
    ),
    Definition(
        "shortest_boundary_distance", "m",
        "shortest distance of a robot to a boundary or obstacle; negative = depth", "(11)",
        _of(shortest_boundary_distance),
    ),
    Definition(
        "farthest_distance", "m", "largest distance between the shapes of two robots", "Fig. 6c",
        _of(farthest_pair),
    ),
    Definition(
        "shortest_collision_time", "s", "shortest collision time that decided, at any decision",
        "(11), Figs. 3c, 6d", _of(shortest_collision_time),
    ),
    Definition(
        "formation_error_peak", "m", "largest size of a formation error at any sample",
        "(10), Figs. 2b, 7a", _of(formation_error_peak),
    ),
    Definition(
        "formation_error_final", "m",
        "largest size of the formation errors at the last sample",
        "(10), Figs. 2b, 7a", _of(formation_error_final),
    ),
    Definition(
        "formation_error_rms", "m", "root mean square of the formation errors over time",
        "(10), Figs. 2b, 7a", _of(formation_error_rms),
    ),
    Definition(
        "formation_energy_peak", "m^2", "largest formation energy W", "(9)",
        lambda run: _energy(run, last=False),
    ),
    Definition(
        "formation_energy_final", "m^2", "formation energy W at the end", "(9)",
        lambda run: _energy(run, last=True),
    ),
    Definition(
        "deviation_peak", "m",
        "deviation of greatest size from the own path at any sample; left positive",
        "Figs. 1b, 2c, 7d", _of(deviation_peak),
    ),
    Definition(
        "deviation_rms", "m",
        "root mean square deviation from the own path over the active time",
        "Figs. 1b, 2c, 7d", _of(deviation_rms),
    ),
    Definition(
        "mean_speed", "m/s", "mean applied forward speed over the active time", "Fig. 7c",
        _of(mean_speed),
    ),
    Definition(
        "averaged_speed_min", "m/s",
        "smallest forward speed averaged over 10 s, every 0.1 s, all of them active", "Fig. 7c",
        lambda run: _averaged(run, run.averaged.forward, largest=False),
    ),
    Definition(
        "averaged_speed_max", "m/s",
        "largest forward speed averaged over 10 s, every 0.1 s, all of them active", "Fig. 7c",
        lambda run: _averaged(run, run.averaged.forward, largest=True),
    ),
    Definition(
        "averaged_rotation_min", "rad/s",
        "smallest rotational speed averaged over 10 s, every 0.1 s, all of them active: fastest "
        "turn to the right",
        "Figs. 1c, 7b", lambda run: _averaged(run, run.averaged.rotational, largest=False),
    ),
    Definition(
        "averaged_rotation_max", "rad/s",
        "largest rotational speed averaged over 10 s, every 0.1 s, all of them active: fastest "
        "turn to the left",
        "Figs. 1c, 7b", lambda run: _averaged(run, run.averaged.rotational, largest=True),
    ),
    Definition(
        "width_min", "m", "least corridor width between two sides along the first robot's path, "
        "every 0.1 m: shortest distance to the left plus to the right boundary", "Fig. 4",
        lambda run: _width(run, largest=False),
    ),
    Definition(
        "width_max", "m", "greatest corridor width between two sides along the first robot's path",
        "Fig. 4", lambda run: _width(run, largest=True),
    ),
    Definition(
        "danger_share", "-", "share of modes declared as danger in the active time",
        "Figs. 5, 8", lambda run: share_of_modes(run.record, danger=True),
    ),
    Definition(
        "safe_share", "-", "share of all other modes in the active time", "Figs. 5, 8",
        lambda run: share_of_modes(run.record, danger=False),
    ),
    Definition(
        "mode_switches", "1/min", "changes between safe and danger mode a minute of active time",
        "Figs. 5, 8", _of(mode_switches),
    ),
    Definition("decisions", "-", "decisions of all robots", "(14)", _of(decisions)),
    Definition(
        "updates_per_second", "1/s", "decisions a second of an active robot", "(14)",
        _of(updates_per_second),
    ),
    Definition(
        "messages", "-", "messages: one for each considered robot and decision", "(14)",
        _of(messages),
    ),
    Definition(
        "collision_time_evaluations", "-", "collision times computed for the decisions",
        "(11), (14)", _of(evaluations),
    ),
    Definition(
        "filtered_steps", "-", "robot-steps over which the filtered command differs from the "
        "nominal one", "-", _of(filtered_steps),
    ),
    Definition(
        "disturbed_steps", "-", "robot-steps over which the applied command differs from the "
        "filtered one", "-", _of(disturbed_steps),
    ),
)  # fmt: skip

DEFINITIONS = MappingProxyType({one.name: one for one in _ALL})
"""Every metric by name, in the order of reports."""


def measure(record: Record, names: Iterable[str] | None = None) -> dict[str, Metric]:
    """Take metrics of a run from its record alone: all, or those of ``names``, in their order.

    All are physim's own (`DEFINITIONS`) and those that packages registered. Metrics that have no
    meaning for the run are left out. Raises PhysimError for an unknown name and for a registered
    metric that fails, RecordError for a damaged record.
    """
    if names is None:
        found, faults = measured(record)
        if faults:
            raise PhysimError(faults[0])
        return found
    check_record(record)
    known, run = dict(DEFINITIONS), Courses(record)
    wanted = list(names)
    if not known.keys() >= set(wanted):
        known = definitions()
    taken = {name: Metric.of(_known(name, known), run) for name in wanted}
    return {name: metric for name, metric in taken.items() if metric is not None}


def measured(record: Record) -> tuple[dict[str, Metric], tuple[str, ...]]:
    """Take all metrics of a run; with a line for each registered one that failed."""
    check_record(record)
    run, found, own = Courses(record), {}, own_metrics(DEFINITIONS)
    faults = list(own.faults)
    for name, what in (*DEFINITIONS.items(), *own.definitions.items()):
        try:
            metric = Metric.of(what, run)
        except PhysimError as error:
            if name in DEFINITIONS:
                raise
            faults.append(str(error))
            continue
        if metric is not None:
            found[name] = metric
    return found, tuple(faults)


def definitions() -> dict[str, Definition]:
    """Every metric by name: physim's own, then those that packages registered and can be used."""
    return {**DEFINITIONS, **own_metrics(DEFINITIONS).definitions}


def definition(name: str) -> Definition:
    """Definition of a metric. Raises PhysimError, with the nearest one, for an unknown name."""
    return DEFINITIONS[name] if name in DEFINITIONS else _known(name, definitions())


def _known(name: str, known: Mapping[str, Definition]) -> Definition:
    if name in known:
        return known[name]
    for fault in own_metrics(DEFINITIONS).faults:
        if f'"{name}"' in fault:
            raise PhysimError(fault)
    close = nearest(name[:100], list(known))
    raise PhysimError(f'no metric is called "{name[:100]}"{close} (physim summary --definitions)')
