"""``physim judge``: a log of poses in; record and summary out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from physim.cli.options import WORLD_HELP, File, Output, Positive, Whole
from physim.cli.output import FILES, SUMMARY, Target, inputs, run_folder
from physim.cli.pictures import files_written
from physim.cli.simulating import tell
from physim.errors import WorldError
from physim.files import write_text

TOUCHED = 1


def judge(
    log: File, /, *,
    world: Annotated[str, Parameter(help=f"whose robots and walls they are: {WORLD_HELP}")],
    output: Output | None = None,
    force: bool = False,
    seed: Whole | None = None,
    set_: Annotated[tuple[str, ...], Parameter("--set")] = (),
    degrees: bool = False,
    every: Positive | None = None,
    gaps: Positive | None = None,
    jumps: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Judge poses that no run of physim made, of real robots or of another simulator: contacts,
    distances, collision times, formation errors and arrivals, as DIR/record.h5 and
    DIR/summary.json.

    arguments:
      LOG.csv  a CSV file with columns time [s], robot (its name in the world, or its number from
          0), x, y [m] and heading [rad], and a row for each sample of a robot

    options:
      --world WORLD  the world
      -o, --output DIR  output folder (default: runs/LOG)
      --force  overwrite an earlier run in DIR
      --seed N  seed of the world, where it draws a road
      --set KEY=VALUE  change one key of the world (may be repeated)
      --degrees  headings are degrees
      --every S  step of the record [s], where the samples have none in common; poses between two
          samples lie along the twist that joins them
      --gaps S  bridge gaps of up to S seconds along the twist (default: five usual spacings)
      --jumps  take steps that are farther than the robot's limits allow as they are
      --quiet  print no table

    exit codes:
      0    nothing touched, and the world's expectations are met
      1    contacts, or not as the world expects
      2    bad input: one message says file, line and column
      130  interrupted (Ctrl-C)

    physim page, plot, video, summary and validate read the record, and say what poses do not tell

    examples:
      physim judge log.csv --world my_world.yaml
      physim judge log.csv --world ten_robots --degrees -o judged
      physim judge log.csv --world my_world.yaml --every 0.02
    """
    from physim.analysis.summary import summarise, table
    from physim.judging import MAYBE_DEGREES
    from physim.judging import judge as judged
    from physim.world.file import read_world

    found, document = read_world(world, overrides=set_)
    tell(document.lines(document.warnings))
    folder = output or Path("runs") / log.stem
    read = (log, *inputs(world))
    Target(folder, force, read).folder([folder / name for name in FILES], "an earlier run")
    try:
        record = judged(
            log, found, seed=seed, every=every, gaps=gaps, jumps=jumps, degrees=degrees
        )  # fmt: skip
    except WorldError as error:
        raise document.error(error.faults) from None
    assert record.judged is not None
    tell(note for note in record.judged.notes if note.startswith(MAYBE_DEGREES))
    summary = summarise(record)
    with run_folder(folder, force, *read):
        record.save(folder / "record.h5")
        write_text(folder / SUMMARY, summary.to_json())
    if quiet:
        tell(summary.warnings)
    else:
        print(table(summary, brief=True), end="")
        print(files_written(folder))
    touched = summary.run.episodes or summary.run.grazes
    return TOUCHED if touched or not summary.held else 0
