"""A small campaign of real runs on disk, made in this process."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from physim.campaigns import Folder, Row, run_one, spec_of
from physim.world.file import parse_world

WORLD = """\
name: small
seed: 1
time: {step: 0.02, duration: 1.0}  # [s]
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}  # [m]
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [6.0, 1.0, random], path: {offset: 1.0}}
  - {name: b, footprint: {length: 1.4, width: 1.0}, pose: [3.0, -1.0, 0.3], path: {offset: -1.0}}
formation: {range: 8.0}
"""


def campaign(folder: Path, seeds: range, controllers: tuple[str, ...]) -> list[Row]:
    """Run all and put the rows into a folder."""
    cells = [spec_of(parse_world(WORLD, controller=name), 1, name="small") for name in controllers]
    place = Folder(folder)
    place.open(cells)
    rows = [run_one(replace(cell, seed=seed)) for seed in seeds for cell in cells]
    place.rows.write(rows)
    return rows
