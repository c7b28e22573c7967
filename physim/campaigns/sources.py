"""Controllers and stages of one's own: which modules and files a run is made of, by their texts.

Taken are the modules of their classes and all that those import from the same folder, and files
that their settings name. Of installed packages the module of the class alone counts.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib.util
import sys
import sysconfig
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from pydantic import BaseModel

from physim.errors import ControllerError
from physim.parts.registry import (
    CONTROLLER,
    STAGES,
    Kind,
    checked_settings,
    find_part,
    shipped_parts,
)
from physim.world import World
from physim.world.faults import describe

LONGEST_NAME = 4096
"""Characters of a text that may name a file"""


class Source(NamedTuple):
    """Text of one module; or, without a name, the hash of a file that settings name."""

    module: str
    file: str
    """where it lay"""
    text: str

    @property
    def package(self) -> bool:
        """Whether it is the ``__init__`` of a package."""
        return Path(self.file).name == "__init__.py"


@functools.lru_cache(maxsize=64)
def source_hash(sources: tuple[Source, ...]) -> str:
    """Hash of modules and texts, wherever they lie; empty where there are none."""
    if not sources:
        return ""
    found = hashlib.sha256()
    for one in sources:
        found.update(f"{one.module or one.file}\0{one.text}\0".encode())
    return found.hexdigest()[:12]


Part = tuple[Kind, str]


def own_parts(world: World) -> tuple[Part, ...]:
    """Controllers and stages of a world that did not come with physim, each once."""
    listed = (world.sensing.stages, world.filters, world.disturbances)
    named = [(CONTROLLER, one.type) for one in world.drivers()]
    named += [(kind, c.type) for kind, some in zip(STAGES, listed, strict=True) for c in some]
    return tuple(part for part in dict.fromkeys(named) if part[1] not in shipped_parts(part[0]))


def sources_of(world: World) -> tuple[Source, ...]:
    """All that a run of a world is made of beside physim and the world: modules, then files.

    Raises ControllerError where a part or its source cannot be had.
    """
    return modules_of(own_parts(world)) + files_named(world)


def modules_of(parts: Sequence[Part]) -> tuple[Source, ...]:
    """Modules of parts that came not with physim, in the order of their names.

    Controllers are named as ``--controller`` takes them. Raises ControllerError where one cannot be
    had.
    """
    found: dict[str, Source] = {}
    for kind, name in parts:
        module = find_part(kind, name, trusted=True).__module__
        file = _file_of(module)
        if file is None:
            continue
        if is_installed(file):  # it must be there; its text is part of what the run is all the same
            found[module] = _read(module, file)
            continue
        root = file.parents[module.count(".") + (file.name == "__init__.py")]
        waiting = [module]
        while waiting:
            name = waiting.pop()
            place = _file_of(name)
            if name in found or place is None or root not in place.parents or is_installed(place):
                continue
            found[name] = one = _read(name, place)
            waiting += [*filter(None, [name.rpartition(".")[0]]), *_imported(one)]
    return tuple(found[name] for name in sorted(found))


def files_named(world: World) -> tuple[Source, ...]:
    """Files that settings of one's own controller and stages name, as of a trained network.

    Given in the world, or by default; from the working folder, or that of the part's module. They
    do not travel with a run, but it is another one where they hold something else.
    """
    kinds = {name: kind for kind, name in own_parts(world)}
    stages = (*world.sensing.stages, *world.filters, *world.disturbances)
    found: dict[str, Source] = {}
    named = [(one.type, one.settings) for one in world.drivers()]
    for name, given in (*named, *((one.type, one.settings) for one in stages)):
        if name in kinds:
            part = find_part(kinds[name], name, trusted=True)
            place = _file_of(part.__module__)
            settings, _ = checked_settings(part, given, ())
            for text in _texts(given if settings is None else settings):
                for folder in (Path(), *([] if place is None else [place.parent])):
                    if (digest := _digest_of(folder / text)) and text not in found:
                        found[text] = Source("", text, digest)
    return tuple(found[text] for text in sorted(found))


def changed_source(sources: Sequence[Source], world: World) -> str:
    """Module or file that is there, but holds something else than it did; or empty."""
    if not sources:
        return ""
    then = {one.module or one.file: one.text for one in sources}
    now = {one.module or one.file: one.text for one in sources_of(world)}
    return next((name for name, text in then.items() if now.get(name, text) != text), "")


def _texts(value: object) -> Iterator[str]:
    """Texts among settings that may be names of files."""
    if isinstance(value, str | PurePath):
        text = str(value)
        if 0 < len(text) <= LONGEST_NAME and "\0" not in text:
            yield text
    elif isinstance(value, BaseModel):
        yield from _texts(dict(value))
    elif isinstance(value, Mapping | list | tuple):
        for one in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(one)


def _digest_of(file: Path) -> str:
    """Hash of a file; empty where there is none that can be read."""
    try:
        if not file.is_file():
            return ""
        with file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""


def _read(module: str, file: Path) -> Source:
    try:
        spec = importlib.util.find_spec(module)
        loader: Any = None if spec is None else spec.loader
        return Source(module, str(file), loader.get_source(module))  # it may be in an archive
    except (ImportError, OSError, ValueError, AttributeError):
        raise ControllerError(f"{file}: the source of {describe(module)} cannot be read") from None


def _file_of(module: str) -> Path | None:
    """File of a module that is none of physim, where it is one of Python text."""
    if module.partition(".")[0] == "physim":
        return None
    loaded = sys.modules.get(module)
    place = getattr(loaded, "__file__", None)
    if loaded is None:
        try:
            spec = importlib.util.find_spec(module)
        except (ImportError, ValueError, AttributeError):
            return None
        place = None if spec is None else spec.origin
    if not isinstance(place, str) or not place.endswith(".py"):
        return None
    return Path(place).absolute()


def is_installed(file: str | Path) -> bool:
    """Whether a file belongs to Python or an installed package."""
    folders = (sysconfig.get_paths()[key] for key in ("stdlib", "platstdlib", "purelib", "platlib"))
    return any(Path(folder) in Path(file).parents for folder in folders)


@functools.lru_cache(maxsize=256)
def _imported(one: Source) -> tuple[str, ...]:
    """Names of modules that a text imports, and of what may be one."""
    package = one.module if one.package else one.module.rpartition(".")[0]
    try:
        nodes = list(ast.walk(ast.parse(one.text)))
    except (SyntaxError, ValueError, RecursionError):
        return ()
    found: list[str] = []
    for node in nodes:
        if isinstance(node, ast.Import):
            found += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*parts, *([base] if base else [])])
            found += filter(None, [base])
            found += (f"{base}.{alias.name}".lstrip(".") for alias in node.names)
    return tuple(found)
