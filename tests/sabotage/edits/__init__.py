"""All edits, by room."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits import (
    basics, checking, cli, crashtest, geometry, importing, loop, metrics, physics, plots, preview, record, reproduction, scene, summary, templates, validation, video, world, world_file,
)

EDITS: tuple[Edit, ...] = (
    *basics.EDITS, *geometry.EDITS, *world.EDITS, *world_file.EDITS, *scene.EDITS, *checking.EDITS, *physics.EDITS, *loop.EDITS, *record.EDITS, *metrics.EDITS, *summary.EDITS, *validation.EDITS, *video.EDITS, *plots.EDITS, *preview.EDITS, *importing.EDITS, *templates.EDITS, *crashtest.EDITS, *reproduction.EDITS, *cli.EDITS,
)
