"""A run of a campaign again, bit by bit, with its record."""

from __future__ import annotations

import re
from pathlib import Path

from physim._version import __version__
from physim.campaigns.folder import Folder, read
from physim.campaigns.one_run import figures, one_line, ready, simulation_of
from physim.campaigns.pool import Job, Processes, Stop, outcomes
from physim.campaigns.rows import ERROR, Row
from physim.campaigns.sources import own_parts, source_hash, sources_of
from physim.campaigns.spec import RunSpec, engine, usual_limit
from physim.errors import PhysimError, RecordError
from physim.record import Record
from physim.simulation.run import record_run
from physim.world.file.files import file_text
from physim.world.file.loading import parse_world

LONGEST_NUMBER = 8
"""Digits of the number of a row; more are those of a run"""


def find_row(folder: Folder, which: str) -> Row:
    """Row by its number, from 0 in the order of ``results.csv``, or by the digits of its run.

    Raises PhysimError where there is none, or several begin with these digits.
    """
    rows = read(folder.path)
    if re.fullmatch("[0-9]+", which) and len(which) <= LONGEST_NUMBER:
        if int(which) < len(rows):
            return rows[int(which)]
        there = f"there are 0 to {len(rows) - 1}" if rows else "it has no rows yet"
        raise PhysimError(f"{folder.path}: has no row {which}; {there}")
    found = [row for row in rows if row.run.startswith(which)]
    if len(found) == 1 and which:
        return found[0]
    what = f"has {len(found)} runs" if found else "has no run"
    raise PhysimError(
        f"{folder.path}: {what} whose digits begin with {which[:40]!r}; give the number of a row "
        "(from 0), or the first digits in its column run"
    )


def spec_of_row(folder: Folder, row: Row, controller: str | None = None) -> RunSpec:
    """The spec of a row, where the same run can be made here.

    ``controller`` allows a class of one's own, which is code, to be imported. Raises PhysimError
    where versions or the source of its controller or of a stage are others now, with all that is.
    """
    label = row.world, row.settings, row.controller
    cell = next(one for one in folder.cells() if one.label == label)
    own = row.controller if ":" in row.controller else None
    if own is not None and controller != own:
        raise PhysimError(
            f"run {row.run}: its controller {own} is code of your own; give it again by "
            f"--controller {own}"
        )
    file = folder.world_file(row.world_hash)
    text = file_text(file)
    world = parse_world(text, str(file), controller=own)
    sources = sources_of(world)
    named = " and ".join(name for _, name in own_parts(world)) or row.controller
    differing = [
        f"{what} {there or 'unknown'} there, {here or 'unknown'} here"
        for what, there, here in (
            ("physim", row.physim, __version__),
            ("engine", row.engine, engine()),
            (f"source of {named}", cell.source_hash, source_hash(sources)),
        )
        if there != here
    ]
    if differing:
        raise PhysimError(f"run {row.run} would not be the same again: {'; '.join(differing)}")
    return RunSpec(text, row.seed, *label, sources, usual_limit(world))


def replay(spec: RunSpec, path: Path, stop: Stop) -> str:
    """Run a spec again with its record at ``path``; says why it broke off, "" where it did not.

    It is done by another process, since it may be a run that kills its own. Raises PhysimError
    where its record cannot be written, which says nothing of the run.
    """
    executor = Processes(1)
    job = Job(spec.note, _record, (spec, path), spec.timer, ready)
    try:
        for outcome in outcomes(iter([(spec, job)]), executor, stop):
            if outcome.error is not None:
                return one_line(outcome.error)
            why, unwritten = outcome.result or ("", False)
            if unwritten:
                raise PhysimError(why)
            return str(why)
    finally:
        executor.shutdown(cancel_futures=True)
    return ""


def _record(spec: RunSpec, path: Path, stop: Stop) -> tuple[str, bool]:
    """In the other process: what ended the run early, and whether it only could not be written."""
    try:
        record_run(simulation_of(spec), path=path, overwrite=True, stop=stop).close()
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return one_line(error), isinstance(error, RecordError)
    return "", False


def check(record: Record, row: Row) -> list[str]:
    """What a record has otherwise than the row of its run; nothing where it is the same run."""
    if row.failed:
        return [] if row.ended != ERROR or record.ended == ERROR else [f"ended {record.ended} here"]
    if row.digest and record.digest() != row.digest:
        return [f"digest {row.digest[:12]} there, {record.digest()[:12]} here"]
    return [
        f"{key} {getattr(row, key)} there, {value} here"
        for key, value in figures(record).items()
        # what others measure says nothing of a run, nor does a column that its row lacks
        if key != "metrics" and getattr(row, key) not in (None, "", value)
    ]
