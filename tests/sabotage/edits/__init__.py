"""All edits, by room."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits import (
    basics,
    checking,
    cli,
    controllers,
    crashtest,
    geometry,
    importing,
    loop,
    metrics,
    page,
    physics,
    plots,
    preview,
    record,
    reproduction,
    scene,
    summary,
    templates,
    validation,
    video,
    work,
    world,
    world_file,
)

EDITS: tuple[Edit, ...] = tuple(
    edit
    for room in (
        basics, geometry, world, world_file, scene, checking, physics, controllers, loop, work, record,
        metrics, summary, validation, video, page, plots, preview, importing, templates, crashtest,
        reproduction, cli,
    )
    for edit in room.EDITS
)  # fmt: skip
"""In the order of the layers."""
