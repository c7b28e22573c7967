"""Every metric by name, with its definition, unit and source.

A metric that has no meaning for a run (the distance between robots of a single one, say) is
absent. Over all physics steps, also those that are not recorded: distances. At all samples:
deviations and formation errors. Over all decisions: collision times, modes.
"""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType
from typing import TYPE_CHECKING

from physim.analysis.metrics import modes, motion, progress
from physim.analysis.metrics.contacts import Episode, Severity
from physim.analysis.metrics.distances import width_extreme
from physim.analysis.metrics.metric import Definition, Moment, Place
from physim.analysis.metrics.registered import own_metrics
from physim.errors import PhysimError, nearest
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.analysis.metrics.figures import Figures


def _contacts(run: Figures, robots: bool | None = None) -> int | None:
    if (robots and run.record.robots < 2) or "contacts" not in run.record.tables:
        return None
    return sum(robots is None or episode.robots is robots for episode in run.episodes)


def _first_contact(run: Figures) -> Moment | None:
    first = next(iter(run.episodes), None)
    return None if first is None else Moment(first.time, first.step, first.time, first.a, first.b)


def _deepest_contact(run: Figures) -> Moment | None:
    deepest = max(run.episodes, key=lambda episode: episode.depth, default=None)
    if deepest is None:
        return None
    time = deepest.depth_step * run.record.dt
    return Moment(deepest.depth, deepest.depth_step, time, deepest.a, deepest.b)


def _severest(run: Figures, figure: Callable[[Episode, Severity], float | None]) -> Moment | None:
    """A figure of the severest contact."""
    if run.severest is None or (value := figure(*run.severest)) is None:
        return None
    one = run.severest[0]
    return Moment(value, one.step, one.time, one.a, one.b)


def _energy(run: Figures, last: bool) -> float | None:
    course = run.energy
    if course is None or not len(course.values):
        return None
    return float(course.values[-1] if last else course.values.max())


def _averaged(run: Figures, values: FloatArray, largest: bool) -> Moment | None:
    return motion.averaged_extreme(run.averaged, values, run.record.dt, largest)


def _width(run: Figures, largest: bool) -> Place | None:
    return None if run.width is None else width_extreme(run.width, 0, largest)


_ALL = (
    Definition("simulated_time", "s", "simulated time of the run", "-",
               lambda run: run.record.steps_run * run.record.dt),
    Definition("finished", "-",
               "whether every robot stood at its stop station at the end, judged by its motion",
               "-", lambda run: progress.finished(run.record)),
    Definition("time_to_finish", "s",
               "time at which the last robot stood at its stop station for good", "Section 1",
               lambda run: progress.time_to_finish(run.record)),
    Definition("stop_distance", "m", "distance of a robot from its stop station at the end, once "
               "all have arrived, the largest", "-",
               lambda run: progress.stop_distance(run.record)),
    Definition("contacts", "-",
               "contact episodes: maximal runs of samples at which two bodies touch", "-",
               _contacts),
    Definition("contacts_between_robots", "-", "contact episodes of two robots", "-",
               lambda run: _contacts(run, True)),
    Definition("contacts_with_boundaries", "-",
               "contact episodes of a robot and a boundary or obstacle", "-",
               lambda run: _contacts(run, False)),
    Definition("grazes", "-",
               "contacts between two samples: apart at both, touching within the step", "-",
               lambda run: len(run.grazes) if "contacts" in run.record.tables else None),
    Definition("first_contact", "s", "time of the first sample of the first contact", "-",
               _first_contact),
    Definition("deepest_contact", "m", "greatest depth of any contact", "-", _deepest_contact),
    Definition("closing_speed", "m/s", "of the severest contact: the greatest closing speed of "
               "any, along the normal, just before", "-",
               lambda run: _severest(run, lambda _, how: how.closing)),
    Definition("energy_lost", "J", "by the impact of the severest contact", "-",
               lambda run: _severest(run, lambda _, how: how.energy)),
    Definition("impulse", "N s", "of the severest contact: the impact and the pushing after it",
               "-", lambda run: _severest(run, lambda one, _: one.impulse)),
    Definition("shortest_distance", "m", "shortest distance between two robots; negative = depth",
               "(11), Figs. 3b, 6c", lambda run: run.nearest),
    Definition("shortest_boundary_distance", "m",
               "shortest distance of a robot to a boundary or obstacle; negative = depth", "(11)",
               lambda run: run.nearest_wall),
    Definition("farthest_distance", "m", "largest distance between the shapes of two robots",
               "Fig. 6c", lambda run: run.farthest),
    Definition("shortest_collision_time", "s",
               "shortest collision time that decided, at any decision", "(11), Figs. 3c, 6d",
               lambda run: run.collision_time),
    Definition("formation_error_peak", "m", "largest size of a formation error at any sample",
               "(10), Figs. 2b, 7a",
               lambda run: motion.formation_error(run.record, run.formation_errors)),
    Definition("formation_error_final", "m",
               "largest size of the formation errors at the last sample", "(10), Figs. 2b, 7a",
               lambda run: motion.formation_error(run.record, run.formation_errors, -1)),
    Definition("formation_error_rms", "m", "root mean square of the formation errors over time",
               "(10), Figs. 2b, 7a",
               lambda run: motion.formation_error_rms(run.record, run.formation_errors)),
    Definition("formation_energy_peak", "m^2", "largest formation energy W", "(9)",
               lambda run: _energy(run, last=False)),
    Definition("formation_energy_final", "m^2", "formation energy W at the end", "(9)",
               lambda run: _energy(run, last=True)),
    Definition("deviation_peak", "m",
               "largest size of a deviation from the own path at any sample", "Figs. 1b, 2c, 7d",
               lambda run: motion.sized(motion.deviation_peak(run.record))),
    Definition("deviation_rms", "m",
               "root mean square deviation from the own path over the active time",
               "Figs. 1b, 2c, 7d", lambda run: motion.deviation_rms(run.record)),
    Definition("mean_speed", "m/s", "mean applied forward speed over the active time", "Fig. 7c",
               lambda run: motion.mean_speed(run.record)),
    Definition("averaged_speed_min", "m/s",
               "smallest forward speed averaged over 10 s, every 0.1 s, all of them active",
               "Fig. 7c", lambda run: _averaged(run, run.averaged.forward, largest=False)),
    Definition("averaged_speed_max", "m/s",
               "largest forward speed averaged over 10 s, every 0.1 s, all of them active",
               "Fig. 7c", lambda run: _averaged(run, run.averaged.forward, largest=True)),
    Definition("averaged_rotation_min", "rad/s", "smallest rotational speed averaged over 10 s, "
               "every 0.1 s, all of them active: fastest turn to the right", "Figs. 1c, 7b",
               lambda run: _averaged(run, run.averaged.rotational, largest=False)),
    Definition("averaged_rotation_max", "rad/s", "largest rotational speed averaged over 10 s, "
               "every 0.1 s, all of them active: fastest turn to the left", "Figs. 1c, 7b",
               lambda run: _averaged(run, run.averaged.rotational, largest=True)),
    Definition("width_min", "m", "least corridor width between two sides along the first robot's "
               "path, every 0.1 m: shortest distance to the left plus to the right boundary",
               "Fig. 4", lambda run: _width(run, largest=False)),
    Definition("width_max", "m",
               "greatest corridor width between two sides along the first robot's path", "Fig. 4",
               lambda run: _width(run, largest=True)),
    Definition("danger_share", "-", "share of modes declared as danger in the active time",
               "Figs. 5, 8", lambda run: modes.share_of_modes(run.record, danger=True)),
    Definition("safe_share", "-", "share of all other modes in the active time", "Figs. 5, 8",
               lambda run: modes.share_of_modes(run.record, danger=False)),
    Definition("mode_switches", "1/min",
               "changes between safe and danger mode a minute of active time", "Figs. 5, 8",
               lambda run: modes.mode_switches(run.record)),
    Definition("decisions", "-", "decisions of all robots", "(14)",
               lambda run: modes.decisions(run.record)),
    Definition("updates_per_second", "1/s", "decisions a second of an active robot", "(14)",
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
)  # fmt: skip

DEFINITIONS = MappingProxyType({one.name: one for one in _ALL})
"""Every metric by name, in the order of reports."""


def definition(name: str) -> Definition:
    """Definition of a metric. Raises PhysimError, with the nearest one, for an unknown name."""
    if name in DEFINITIONS:
        return DEFINITIONS[name]
    own = own_metrics(DEFINITIONS)
    if name in own.definitions:
        return own.definitions[name]
    for fault in own.faults:
        if f'"{name}"' in fault:
            raise PhysimError(fault)
    close = nearest(name[:100], [*DEFINITIONS, *own.definitions])
    raise PhysimError(f'no metric is called "{name[:100]}"{close} (physim summary --definitions)')
