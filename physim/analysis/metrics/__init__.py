"""Figures of one run, each from its `Record` alone.

Named metrics: `measure` gives those that have a meaning for the run, `DEFINITIONS` describes each
with unit and source::

    found = physim.metrics.measure(record)
    found["shortest_distance"].value, found["shortest_distance"].bodies

Packages may register further metrics, see `physim.analysis.metrics.registered`. `Figures` has what
several tables and pictures of a run share, each worked out once.

Courses over time, along a path or by pair, for pictures and experiments: `formation_errors`,
`formation_energy`, `deviations`, `averaged_speeds`, `mode_spans`, `collision_times`,
`pair_distances`, `corridor_width`.

What has no meaning for a run (the distance between robots of a single one, say) is None or absent,
not 0; so is what depends on a column that the controller did not declare. "Fig." and numbers in
parentheses refer to the paper.
"""

from __future__ import annotations

from physim.analysis.metrics.contacts import (
    Deep,
    Episode,
    Graze,
    Severity,
    contact_episodes,
    deep_contacts,
    grazes,
    masses,
    severest,
    severity,
)  # fmt: skip
from physim.analysis.metrics.distances import (
    Width,
    collision_times,
    corridor_width,
    farthest_pair,
    pair_distances,
    placed,
    shortest_boundary_distance,
    shortest_collision_time,
    shortest_distance,
)  # fmt: skip
from physim.analysis.metrics.figures import Figures, measure
from physim.analysis.metrics.metric import Definition, Each, Metric, Moment, Place, Series
from physim.analysis.metrics.modes import (
    decisions,
    evaluations,
    messages,
    mode_spans,
    mode_switches,
    share_of_modes,
    updates_per_second,
)  # fmt: skip
from physim.analysis.metrics.motion import (
    AveragedSpeeds,
    averaged_speeds,
    desired_leads,
    deviation_peak,
    deviation_rms,
    deviations,
    formation_energy,
    formation_error_final,
    formation_error_peak,
    formation_error_rms,
    formation_errors,
    formation_parts,
    has_formation,
    mean_speed,
)  # fmt: skip
from physim.analysis.metrics.progress import (
    Absent,
    absent,
    active_steps,
    column_over_time,
    finished,
    stop_distance,
    time_to_finish,
)  # fmt: skip
from physim.analysis.metrics.registered import own_metrics, own_part
from physim.analysis.metrics.registry import DEFINITIONS, definition

__all__ = [
    "DEFINITIONS", "Absent", "AveragedSpeeds", "Deep", "Definition", "Each", "Episode", "Figures",
    "Graze", "Metric", "Moment", "Place", "Series", "Severity", "Width", "absent", "active_steps",
    "averaged_speeds", "collision_times", "column_over_time", "contact_episodes", "corridor_width",
    "decisions",
    "deep_contacts", "definition", "desired_leads", "deviation_peak", "deviation_rms", "deviations",
    "evaluations", "farthest_pair", "finished", "formation_energy", "formation_error_final",
    "formation_error_peak", "formation_error_rms", "formation_errors", "formation_parts", "grazes",
    "has_formation", "masses", "mean_speed", "measure", "messages", "mode_spans",
    "mode_switches", "own_metrics", "own_part", "pair_distances", "placed", "severest", "severity",
    "share_of_modes", "shortest_boundary_distance", "shortest_collision_time", "shortest_distance",
    "stop_distance", "time_to_finish", "updates_per_second",
]  # fmt: skip
