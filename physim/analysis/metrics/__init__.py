"""Figures of one run, each from its `Record` alone.

Named metrics: `measure` gives those that have a meaning for the run, `DEFINITIONS` describes each
with unit and source::

    found = physim.metrics.measure(record)
    found[].value, found[].bodies

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

from physim.analysis.metrics.contacts import Deep, Episode, Graze, Severity, masses, severity
from physim.analysis.metrics.distances import (
    Width,
    collision_times,
    corridor_width,
    pair_distances,
    placed,
)
from physim.analysis.metrics.figures import DEFINITIONS, Figures, definition, measure
from physim.analysis.metrics.metric import Definition, Each, Metric, Moment, Place, Series
from physim.analysis.metrics.modes import mode_spans
from physim.analysis.metrics.motion import (
    AveragedSpeeds,
    averaged_speeds,
    desired_leads,
    deviation_peak,
    deviations,
    formation_energy,
    formation_errors,
    formation_parts,
)
from physim.analysis.metrics.progress import Absent, column_over_time
from physim.analysis.metrics.registered import own_metrics, own_part

__all__ = [
    "DEFINITIONS", "Absent", "AveragedSpeeds", "Deep", "Definition", "Each", "Episode", "Figures",
    "Graze", "Metric", "Moment", "Place", "Series", "Severity", "Width", "averaged_speeds",
    "collision_times", "column_over_time", "corridor_width", "definition", "desired_leads",
    "deviation_peak", "deviations", "formation_energy", "formation_errors", "formation_parts",
    "masses", "measure", "mode_spans", "own_metrics", "own_part", "pair_distances", "placed",
    "severity",
]  # fmt: skip
