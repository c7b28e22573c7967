"""All edits, by room."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits import (
    basics,
    campaigns,
    checking,
    cli,
    controllers,
    crashtest,
    drawings,
    falsify,
    geometry,
    import_robots,
    import_work,
    importing,
    loop,
    metrics,
    page,
    physics,
    plots,
    preview,
    record,
    reports,
    reproduction,
    roads,
    scene,
    statistics,
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
        basics, geometry, statistics, world, roads, world_file, scene, checking, physics, controllers, loop,
        work, record, metrics, summary, validation, video, page, plots, preview, importing,
        import_robots, drawings, import_work, templates, crashtest, campaigns, falsify, reports, reproduction, cli,
    )
    for edit in room.EDITS
)  # fmt: skip
"""In the order of the layers."""
