"""All that a record says of decisions, commands and its end, computed anew from its poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from physim.declared import Declared
from physim.record import Record
from physim.registry import CONTROLLER, SENSING, shipped_parts
from physim.validation.announced import check_schedule
from physim.validation.columns import (
    Considered,
    Meaning,
    StandardColumns,
    check_considered,
    check_priority,
)
from physim.validation.commands import check_commands
from physim.validation.decisions import DecisionTable
from physim.validation.ending import ArrivalCheck, check_counts, check_ending
from physim.validation.mismatch import Mismatch, Mismatches
from physim.validation.origin import Inside
from physim.validation.replay import Replay
from physim.validation.walk import SampleBlock, sample_blocks

PAPER = "mode_switching"
"""Name of the controller whose considered robots follow the paper's rule of priority."""


@dataclass(frozen=True)
class Recomputed:
    """What was computed anew, and what does not agree."""

    decisions: int
    replayed: int
    """of these, how many were made again by the world's own controller"""
    columns: tuple[str, ...]
    """standard columns of decisions that were computed from the geometry"""
    left_out: tuple[str, ...]
    """what could not be computed, and why"""
    mismatches: tuple[Mismatch, ...]


def recompute(record: Record, inside: Inside, table: DecisionTable) -> Recomputed:
    """Hold everything that follows from poses, commands and the world inside against the record."""
    found, scene = Mismatches(record), inside.scene
    considered = Considered(record)
    replay, columns, left_out = _checkers(record, inside, considered)
    by_rule = replay is not None and scene is not None and scene.world.controller.type == PAPER
    arrivals = None if scene is None else ArrivalCheck(record, scene)
    check_schedule(record, table, found)
    check_considered(record, considered, found)
    check_commands(record, table, scene, inside.stages, found)
    check_counts(record, found)
    for block in sample_blocks(record):
        _stations(record, block, found)
        if arrivals is not None:
            arrivals.take(block)
        if columns is not None:
            columns.take(block, found)
        if by_rule and scene is not None:
            check_priority(record, block, scene.sensing_range, considered, found)
        if replay is not None:
            replay.take(block, found)
    if arrivals is not None and scene is not None:
        check_ending(record, scene, arrivals, found)
    if replay is not None and replay.broken is not None:
        left_out.append(f"decisions from there on: {replay.broken}")
    return Recomputed(
        len(record.updates), 0 if replay is None else replay.decided,
        () if columns is None else tuple(columns.columns), tuple(left_out), found.found,
    )  # fmt: skip


def _checkers(
    record: Record, inside: Inside, considered: Considered
) -> tuple[Replay | None, StandardColumns | None, list[str]]:
    """What makes decisions again, what works out their columns, and what cannot be done."""
    scene, own = inside.scene, inside.controller
    if not len(record.updates):
        return None, None, ["decisions: there are none"]
    if scene is None:
        return None, None, [
            "commands within limits, arrival, modes, rules, targets, considered robots, distances "
            "and collision times of decisions: the record holds no text of its world"
        ]  # fmt: skip
    if SENSING.word in (inside.stages or ()):
        return None, None, [
            "modes, rules, commands, targets, considered robots, distances and collision times of "
            "decisions: what robots sensed is not in the record"
        ]  # fmt: skip
    settings = getattr(own, "settings", None)
    columns = StandardColumns(record, scene, Meaning.of(record, settings), considered)
    kind = scene.world.controller.type
    why = inside.why_not
    if own is not None and kind not in shipped_parts(CONTROLLER):
        why = f"{kind} is not shipped with physim, and need not decide alike twice"
    elif own is not None and record.declared != Declared.of(own):
        why = "the record declares others"
    if why or own is None:
        what = "modes, rules, commands and targets of decisions, and whom they had to consider"
        return None, columns, [f"{what}: {why}"]
    return Replay(record, scene, own, considered), columns, []


def _stations(record: Record, block: SampleBlock, found: Mismatches) -> None:
    """Stations and formation errors of decisions against the poses."""
    rows, lead = block.rows, record.lead
    station, deviation, reference = block.course[block.at, rows["robot"]].T
    mean = block.reference_station[block.at].mean(axis=1)
    error = (mean - reference) - (lead.mean() - lead[rows["robot"]])
    exact = {"station": station, "deviation": deviation, "reference_station": reference}
    found.add_columns("/updates", rows, block.row, exact, "by its pose")
    found.add_columns(
        "/updates", rows, block.row, {"formation_error": np.asarray(error)}, "by all poses"
    )
