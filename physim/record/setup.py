"""What a run was made with: controller, stages between it and the robots, versions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from physim.parts.drive import PLAIN
from physim.record.layout import NO_ORIGIN, Origin
from physim.units import joined
from physim.world.group import drivers_of
from physim.world.kinds import MOST_ROBOTS
from physim.world.run import ControllerChoice

if TYPE_CHECKING:
    from physim.record.layout import Judged
    from physim.record.reader import Record

STAGES = {"sensing": ("sensing", "stages"), "filters": ("filters",),
          "disturbances": ("disturbances",)}  # fmt: skip
"""What the stages are called, and where the world names them."""


NOT_KNOWN = "commands, decisions, modes, impulses and who was responsible: poses do not tell them"
"""Of a log that was judged"""
SHOWN_ROBOTS = 12
"""Robots of a controller that are listed one by one"""


@dataclass(frozen=True)
class Part:
    """A part of a run by name, with its settings; others had their defaults.

    They are those that the world gives it, or, of an object given from Python, those that differ.
    """

    name: str
    settings: dict[str, Any]
    not_known: tuple[str, ...] = ()
    """settings of an object of which it does not tell what they are"""

    def __str__(self) -> str:
        """``mode_switching (time_low 1.5, horizon 4.5)``."""
        return f"{self.name} ({self.set_to})" if self.set_to else self.name

    @property
    def set_to(self) -> str:
        """The settings, in words; empty where there are none to tell."""
        known = (f"{key} {_short(value)}" for key, value in self.settings.items())
        return ", ".join((*known, *(f"{name} not known" for name in self.not_known)))

    def to_dict(self) -> dict[str, Any]:
        """Name and settings, for JSON, and which are not known where there are such."""
        told = {"type": self.name, "settings": self.settings}
        return {**told, "not_known": list(self.not_known)} if self.not_known else told


@dataclass(frozen=True)
class Setup:
    """What a run was made with."""

    controllers: tuple[tuple[Part, tuple[int, ...]], ...]
    """each with the robots that it drives, the world's own first where it drives any; that has the
    name ``module:Class`` where it came from Python as an object"""
    stages: dict[str, tuple[Part, ...]]
    """by the words of `STAGES`, in the order in which they act"""
    others: tuple[str, ...]
    """parts that came from Python, such as ``filter my_module:Slow (share 0.5)``"""
    versions: dict[str, str]
    """of physim and its libraries; empty where the record does not say"""
    names: tuple[str, ...] = ()
    """of the robots"""
    drives: dict[str, tuple[int, ...]] = field(default_factory=dict)
    """robots of each drive, by its name, but for plain unicycles"""
    origin: Origin = NO_ORIGIN
    """of a branch: of which record, and what was changed"""
    begun: float = 0.0
    """[s] of the first sample"""
    judged: Judged | None = None
    """the log that was judged, where no run made the poses"""

    @property
    def controller(self) -> Part:
        """The first of the controllers: the only one where no robot has one of its own."""
        return self.controllers[0][0]

    @property
    def controller_names(self) -> str:
        """Names of the controllers, in words, each once."""
        return joined(dict.fromkeys(part.name for part, _ in self.controllers))

    def who(self, robots: Sequence[int]) -> str:
        """Robots, given by index, in words: names, of many the first ones."""
        names = [self.names[k] for k in robots[:SHOWN_ROBOTS] if k < len(self.names)]
        more = len(robots) - len(names)
        return ", ".join(names) + (f" and {more} more" if more else "")

    def lines(self) -> list[tuple[str, str]]:
        """Label and text of controller and stages; none for a stage that there is not."""
        stages = [(word, ", ".join(map(str, parts))) for word, parts in self.stages.items()]
        controllers = str(self.controller)
        if len(self.controllers) > 1:
            each = (f"{part} for {self.who(some)}" for part, some in self.controllers)
            controllers = "; ".join(each)
        drives = ", ".join(f"{name} ({self.who(some)})" for name, some in self.drives.items())
        found = [
            ("controller", controllers),
            ("drives", drives),
            *stages,
            ("from Python", ", ".join(self.others)),
        ]
        if (origin := self.origin).digest:
            words = f"record {origin.digest[:12]} from {self.begun:g} s on; changed: {origin}"
            found.append(("branch of", words))
        if self.judged is not None:
            told = f"the poses of {self.judged.source}: {'; '.join(self.judged.notes)}"
            found = [("judged", told), ("not known", NOT_KNOWN)]
        return [(word, text) for word, text in found if text]

    def to_dict(self) -> dict[str, Any]:
        """Controller and stages with their settings, and what came from Python, for JSON."""
        stages = {word: [part.to_dict() for part in parts] for word, parts in self.stages.items()}
        found = {"controller": self.controller.to_dict(), **stages, "from_python": self.others}
        if self.origin.digest:
            found["branch_of"] = asdict(self.origin) | {"time_s": self.begun}
        if self.judged is not None:
            found = {"judged": asdict(self.judged), "not_known": NOT_KNOWN}
        if len(self.controllers) > 1:
            found["controllers"] = [
                {**part.to_dict(), "robots": some} for part, some in self.controllers
            ]
        return found

    @property
    def made_with(self) -> str:
        """Versions, in words."""
        return ", ".join(f"{name} {version}" for name, version in self.versions.items())


def setup_of(record: Record) -> Setup:
    """Setup by the world inside a record, and the parts from Python with what is known of them.

    The world need not be valid: what it does not say as it should is told as far as it can be.
    """
    parts = [
        (kind, Part(name, dict(one.settings), one.not_known))
        for (kind, name), one in zip(record.given, record.given_settings, strict=False)
    ]
    world = record.world_settings
    if record.judged is not None:  # the world's parts did not act
        whole = ((Part(f"log {record.judged.source}", {}), tuple(range(record.robots))),)
        nothing: dict[str, tuple[Part, ...]] = dict.fromkeys(STAGES, ())
        return Setup(whole, nothing, (), record.versions, record.names, judged=record.judged)
    own = dict(parts).get("controller") or _part(world.get("controller"), ControllerChoice().type)
    entries = world.get("robots")
    named: list[tuple[tuple[str, Mapping[str, Any]] | None, int]] = []
    drives: dict[str, tuple[int, ...]] = {}
    robots = 0
    for entry in entries if isinstance(entries, list) else ():
        some = entry if isinstance(entry, Mapping) else {}
        count, part = some.get("count", 1), _part(some.get("controller"), "?")
        many = min(count, MOST_ROBOTS) if type(count) is int else 1
        is_own = some.get("controller") is None
        named.append((None if is_own else (part.name, part.settings), many))
        if some.get("drive") is not None:
            drive = _part(some["drive"], "?")
            if drive != Part(PLAIN, {}):
                mine = tuple(range(robots, robots + many))
                drives[drive.name] = (*drives.get(drive.name, ()), *mine)
        robots += many
    drivers = drivers_of((own.name, own.settings), named)
    stages: dict[str, tuple[Part, ...]] = {}
    for word, keys in STAGES.items():
        choices: Any = world
        for key in keys:
            choices = choices.get(key) if isinstance(choices, Mapping) else None
        stages[word] = tuple(_part(one, "?") for one in choices or ())
    return Setup(
        controllers=tuple(
            (own if one.is_own else Part(one.type, dict(one.settings)), one.robots)
            for one in drivers
        )
        or ((own, ()),),
        stages=stages,
        others=tuple(f"{kind} {part}" for kind, part in parts if kind != "controller"),
        versions=record.versions,
        names=record.names,
        drives=drives,
        origin=record.origin,
        begun=record.begun,
    )


def _part(choice: Any, usual: str) -> Part:
    """A part as the world names it; of a world that is none, what can be told."""
    if not isinstance(choice, Mapping):
        return Part(usual, {})
    settings = {str(key): value for key, value in choice.items() if key != "type"}
    return Part(str(choice.get("type", usual)), settings)


def _short(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"({', '.join(f'{key} {_short(one)}' for key, one in value.items())})"
    return f"{value:g}" if isinstance(value, float) else str(value)
