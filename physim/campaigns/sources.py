"""Controllers and stages of one's own as text: a run takes the source along, wherever it is done.

Taken along are the modules of their classes and all that those import from the same folder;
installed packages are not, and must be there. A module is made of the text that came, whatever lies
on disk by then, and its code is called by the name of its file, so that errors point into it.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib
import importlib.abc
import importlib.util
import sys
import sysconfig
from collections.abc import Iterator, Mapping, Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path, PurePath
from types import ModuleType
from typing import NamedTuple

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
    package: bool
    """whether it is the ``__init__`` of a package"""


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
    """Controller and stages of a world that did not come with physim, each once."""
    listed = (world.sensing.stages, world.filters, world.disturbances)
    named = [(CONTROLLER, world.controller.type)]
    named += [(kind, c.type) for kind, some in zip(STAGES, listed, strict=True) for c in some]
    return tuple(part for part in dict.fromkeys(named) if part[1] not in shipped_parts(part[0]))


def sources_of(parts: Sequence[Part]) -> tuple[Source, ...]:
    """Modules of parts that came with neither physim nor an installed package.

    Controllers are named as ``--controller`` takes them. Raises ControllerError where one cannot be
    had.
    """
    found: dict[str, Source] = {}
    for kind, name in parts:
        _add(found, find_part(kind, name, trusted=True).__module__)
    return tuple(found[name] for name in sorted(found))


def files_named(world: World) -> tuple[Source, ...]:
    """Files that settings of one's own controller and stages name, as of a trained network.

    Given in the world, or by default; from the working folder, or that of the part's module. They
    do not travel with a run, but it is another one where they hold something else.
    """
    kinds = {name: kind for kind, name in own_parts(world)}
    stages = (*world.sensing.stages, *world.filters, *world.disturbances)
    found: dict[str, Source] = {}
    for choice in (world.controller, *stages):
        if choice.type in kinds:
            part = find_part(kinds[choice.type], choice.type, trusted=True)
            place = _file_of(part.__module__)
            settings, _ = checked_settings(part, choice.settings, ())
            for text in _texts(choice.settings if settings is None else settings):
                for folder in (Path(), *([] if place is None else [place.parent])):
                    if (digest := _digest_of(folder / text)) and text not in found:
                        found[text] = Source("", text, digest, False)
    return tuple(found[text] for text in sorted(found))


def changed_file(sources: Sequence[Source], world: World) -> str:
    """File that settings name and that is there, but holds something else than it did; or empty."""
    then = {source.file: source.text for source in sources if not source.module}
    if not then:
        return ""
    now = {source.file: source.text for source in files_named(world)}
    return next((file for file, text in then.items() if now.get(file, text) != text), "")


def _texts(value: object) -> Iterator[str]:
    """Texts among settings that may be names of files."""
    if isinstance(value, str) and 0 < len(value) <= LONGEST_NAME and "\0" not in value:
        yield value
    elif isinstance(value, PurePath):
        yield from _texts(str(value))
    elif isinstance(value, BaseModel):
        yield from _texts(dict(value))
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from _texts(one)
    elif isinstance(value, list | tuple):
        for one in value:
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


def _add(found: dict[str, Source], module: str) -> None:
    """Add a module, and what it imports from the same folder."""
    file = _file_of(module)
    if module.partition(".")[0] == "physim" or file is None:
        return
    if _is_installed(file):  # it must be there; its text is part of what the run is all the same
        found[module] = _read(module, file)
        return
    root = file.parents[module.count(".") + (file.name == "__init__.py")]
    waiting = [module]
    while waiting:
        name = waiting.pop()
        place = _file_of(name)
        if name in found or name.partition(".")[0] == "physim" or place is None:
            continue
        if root not in place.parents or _is_installed(place):
            continue
        found[name] = one = _read(name, place)
        parent = name.rpartition(".")[0]
        waiting += [parent] if parent else []
        waiting += _imported(one)


def provide(sources: Sequence[Source]) -> None:
    """Let modules be imported from their texts in this process.

    Those that were imported with another text are forgotten, with all that came along with it.
    """
    wanted = {
        one.module: one for one in sources if one.module and not _is_installed(Path(one.file))
    }
    if not wanted or all(_is_loaded(one) for one in wanted.values()):
        return
    earlier = [finder for finder in sys.meta_path if isinstance(finder, Carried)]
    for finder in earlier:
        sys.meta_path.remove(finder)
    for name in {*wanted, *(name for finder in earlier for name in finder.sources)}:
        sys.modules.pop(name, None)
    sys.meta_path.insert(0, Carried(wanted))


class Carried(importlib.abc.MetaPathFinder, importlib.abc.InspectLoader):
    """Finds and loads modules whose texts came with a run."""

    def __init__(self, sources: dict[str, Source]) -> None:
        self.sources = sources

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        """What Python asks for a module."""
        one = self.sources.get(fullname)
        if one is None:
            return None
        spec = ModuleSpec(fullname, self, origin=one.file, is_package=one.package)
        spec.has_location = True
        return spec

    def get_source(self, fullname: str) -> str:
        """Text of a module, for tracebacks too."""
        return self.sources[fullname].text

    def is_package(self, fullname: str) -> bool:
        """Whether a module is a package."""
        return self.sources[fullname].package

    def exec_module(self, module: ModuleType) -> None:
        """Run the text of a module."""
        one = self.sources[module.__name__]
        exec(compile(one.text, one.file, "exec"), module.__dict__)


def _is_loaded(one: Source) -> bool:
    """Whether a module is here, and was made of this very text."""
    module = sys.modules.get(one.module)
    if module is None:
        return False
    for finder in sys.meta_path:
        if isinstance(finder, Carried) and one.module in finder.sources:
            return finder.sources[one.module].text == one.text
    return _text(getattr(module, "__file__", None)) == one.text


def _text(file: str | None) -> str | None:
    try:
        return None if file is None else Path(file).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return None


def _read(module: str, file: Path) -> Source:
    text = _text(str(file))
    if text is None:
        raise ControllerError(f"{file}: the source of {describe(module)} cannot be read")
    return Source(module, str(file), text, file.name == "__init__.py")


def _file_of(module: str) -> Path | None:
    """File of a module, where it is one of Python text."""
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


def _is_installed(file: Path) -> bool:
    """Whether a file belongs to Python or an installed package."""
    folders = (sysconfig.get_paths()[key] for key in ("stdlib", "platstdlib", "purelib", "platlib"))
    return any(Path(folder) in file.parents for folder in folders)


def _imported(one: Source) -> Iterator[str]:
    """Names of modules that a text imports, and of what may be one."""
    package = one.module if one.package else one.module.rpartition(".")[0]
    try:
        nodes = list(ast.walk(ast.parse(one.text)))
    except (SyntaxError, ValueError, RecursionError):
        return
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*parts, *([base] if base else [])])
            if base:
                yield base
            yield from (f"{base}.{alias.name}".lstrip(".") for alias in node.names)


__all__ = [
    "Part",
    "Source",
    "changed_file",
    "files_named",
    "own_parts",
    "provide",
    "source_hash",
    "sources_of",
]
