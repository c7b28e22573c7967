"""What a run's record knows of the settings of parts that came from Python as objects."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from pydantic import BaseModel

import physim
from physim import simulate
from physim.analysis.summary import summarise, table_rows
from physim.errors import RecordError
from tests.helpers import inside, road
from tests.helpers.stages import Changes

ModeSwitching, ModeSwitchingSettings = inside(
    "physim.controllers", "ModeSwitching", "ModeSwitchingSettings"
)
given_settings = inside("physim.parts", "given_settings")


class Base:
    def decide(self, observation: Any, memory: Any) -> physim.Decision:
        return physim.Decision(0.0, 0.0, 0.1)


class Settings(BaseModel):
    gap: float = 2.2
    names: list[str] = ["a"]


class OfModel(Base):
    Settings = Settings

    def __init__(self, settings: Settings) -> None:
        self.settings = settings


class Hidden(OfModel):
    def __init__(self, own: Settings) -> None:
        self._s = own


@dataclass
class AsData(Base):
    gap: float = 2.2
    table: list[int] = field(default_factory=lambda: [1, 2])


class Kept(Base):
    def __init__(self, gap: float = 2.2, far: Any = None, *, scale: float = 1.0) -> None:
        self.gap, self.far, self.scale, self._own = gap, far, scale, 3


class NotKept(Base):
    def __init__(self, gap: float = 2.2, *more: int) -> None:
        self._gap = gap


class Scaled(Changes):
    def __init__(self, share: float = 1.0) -> None:
        super().__init__(lambda given: share * given)
        self.share = share


@pytest.mark.parametrize(
    ("part", "settings", "not_known"),
    [
        (OfModel(Settings(gap=3)), {"gap": 3.0}, ()),
        (Hidden(Settings(names=["b"])), {}, ("settings",)),
        (AsData(1.0, [3]), {"gap": 1.0, "table": [3]}, ()),
        (Kept(), {"gap": 2.2, "far": None, "scale": 1.0}, ()),
        (Kept(3.0, np.array([1.0, 2.0]), scale=np.float32(0.5)),
         {"gap": 3.0, "far": [1.0, 2.0], "scale": 0.5}, ()),
        (Kept(far=print), {"gap": 2.2, "scale": 1.0}, ("far",)),
        (NotKept(), {}, ("gap", "more")),
        (ModeSwitching(ModeSwitchingSettings(time_low=0.7)), {"time_low": 0.7}, ()),
    ],
)  # fmt: skip
def test_what_an_object_tells_of_its_settings(
    part: object, settings: dict[str, Any], not_known: tuple[str, ...]
) -> None:
    found = given_settings(part)
    assert (found.settings, found.not_known) == (settings, not_known)


WORLD = road([[20.0, 0.0, 0.0]], duration=0.1)


def test_settings_of_objects_stand_in_summary_and_table(tmp_path: Path) -> None:
    given, path = ModeSwitching(ModeSwitchingSettings(time_low=0.7)), tmp_path / "r.h5"
    simulate(WORLD, controller=given, filters=[Scaled(0.5), Scaled()], path=path)
    with physim.Record.load(path) as read:
        found = json.loads(summarise(read).to_json())
        assert found["controller"]["settings"] == {"time_low": 0.7}
        assert "not_known" not in found["controller"]
        assert ["share 0.5" in one for one in found["from_python"]] == [True, False]
        assert "time_low 0.7" in dict(table_rows(summarise(read)))["controller"]
    told = json.loads(summarise(simulate(WORLD, controller=NotKept(3.0))).to_json())["controller"]
    assert (told["settings"], told["not_known"]) == ({}, ["gap", "more"])
    for text in ("[", "{}", '[{"not_known": []}]'):
        with h5py.File(path, "r+") as file:
            file.attrs["given_settings"] = text
        with pytest.raises(RecordError, match="given_settings"):
            physim.Record.load(path)


def test_settings_that_are_not_the_worlds_are_never_told_as_the_worlds() -> None:
    world = WORLD.changed(controller={"type": "mode_switching", "time_low": 0.7})
    own = simulate(world, controller=ModeSwitching(ModeSwitchingSettings(time_low=0.7)))
    assert own.given == ()
    assert own.setup.controller.settings == {"time_low": 0.7}
    other = simulate(world, controller=ModeSwitching())
    assert other.setup.controller.settings == {}
    named = WORLD.changed(controller={"type": "tests.parts.test_given:OfModel", "gap": 1.0})
    assert simulate(named, controller=OfModel(Settings(gap=1.0))).given == ()
    record = simulate(named, controller=OfModel(Settings(gap=3.0)))
    assert record.setup.controller.settings == {"gap": 3.0}
