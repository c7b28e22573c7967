from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from tests.helpers import inside
from tests.helpers.records import make_record

followed = inside("physim.record", "followed")
ROOM = "physim.drawing.video"
sprite = inside(ROOM, "sprite")

FIELDS = (
    "time dt steps pose samples clearance boundary_clearance updates contacts bodies names "
    "footprints walls paths reference stop_station arrived modes accessible safe safe_distance "
    "name seed robots world_text commands shapes path setup record_every lead where begun_at begun"
    " steps_made steps_run moving moving_pose judged origin pose_at"
)


class Changed(SimpleNamespace):
    """What the video reads of a record, with some of it replaced."""

    def __getattr__(self, name: str) -> Any:
        if name == "course":  # unless it is among what was replaced
            return followed(self)
        raise AttributeError(name)

    @property
    def world_settings(self) -> Any:
        return yaml.safe_load(self.world_text)

    def holds(self, path: str) -> bool:
        return False

    def column(self, name: str, *, absent: float = np.nan) -> Any:
        known = name in (self.updates.dtype.names or ())
        return self.updates[name] if known else np.full(len(self.updates), absent)


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Any]]:
    """Make a record of so many robots and seconds, once each; it must not be changed."""
    records: dict[Any, Any] = {}

    def make(robots: int, seconds: float = 4.0) -> Any:
        key = (robots, seconds)
        if key not in records:
            folder = Path(tmp_path_factory.mktemp("record"))
            records[key] = make_record(folder / "r.h5", robots, seconds, dt=0.02)
        return records[key]

    yield make
    for record in records.values():
        record.close()


@pytest.fixture(scope="session")
def changed() -> Callable[..., Any]:
    """Return what the video reads of a record, with some of it replaced."""

    def change(record: Any, **changes: Any) -> Any:
        return Changed(**{f: getattr(record, f) for f in FIELDS.split()} | changes)

    return change


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """All that is written into pictures from now on."""
    words: list[str] = []

    def noted(text: str, *more: Any, **named: Any) -> Any:
        words.append(text)
        return sprite(text, *more, **named)

    for module in [one for name, one in sys.modules.items() if name.startswith(ROOM)]:
        if getattr(module, "sprite", None) is sprite:
            monkeypatch.setattr(module, "sprite", noted)
    return words
