"""Where a command writes, decided and checked before anything is computed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from physim.errors import PhysimError, WorldError
from physim.files import check_regular, write_text

CUT_SHORT = ".cut_short"
"""Between name and ending of a video that was interrupted."""
STDOUT = Path("-")
"""What stands for standard output where a file is asked for."""
SUMMARY = "summary.json"
BOTH, BOTH_PAGE = "both.mp4", "both.html"
"""A branch beside its original"""
FILES = (
    "record.h5", "video.mp4", f"video{CUT_SHORT}.mp4", SUMMARY, "page.html", BOTH,
    f"both{CUT_SHORT}.mp4", BOTH_PAGE,
)  # fmt: skip
PAGE, WORLD = (".html", ".htm"), (".yaml", ".yml")
"""How files end"""


@dataclass(frozen=True)
class Target:
    """A file or folder that a command is to write, and whether what is there may be overwritten.

    ``others`` are further files that the command reads or writes, ``option`` is what names the
    target.
    """

    path: Path
    force: bool
    others: Sequence[Path] = ()
    option: str = "-o"

    def file(
        self, *, ends: tuple[str, ...] = (), another: str = "file", in_new: bool = False
    ) -> Path:
        """The file. Raises PhysimError unless it may be written.

        It may not where another file of the command is or something other than a regular file, nor
        without ``force`` where anything exists, nor where there is no folder for it, unless the
        command makes one (``in_new``). ``option`` names it, or another ``another``.
        """
        path = self.path
        if path.is_dir():
            raise PhysimError(f"{path}: is a folder; {self.option} takes a file")
        if ends and path.suffix.lower() not in ends:
            raise PhysimError(f"{path}: must end in {' or '.join(ends)}")
        if any(map(self._is, self.others)):
            raise PhysimError(
                f"{path}: is an input or another output; {self.option} takes another {another}"
            )
        check_regular(path)
        if os.path.lexists(path) and not self.force:
            raise PhysimError(
                f"{path}: exists; use --force to overwrite it, or {self.option} for another "
                f"{another}"
            )
        if not in_new and not path.absolute().parent.is_dir():
            raise PhysimError(f"{path}: there is no folder {path.parent}")
        return path

    def _is(self, other: Path) -> bool:
        try:
            return other.samefile(self.path)
        except (OSError, ValueError):
            return other.resolve() == self.path.resolve()

    def folder(self, earlier: Sequence[Path] = (), what: str = "", empty: bool = False) -> Path:
        """The folder, which need not exist. Raises PhysimError unless it may be written to.

        It may not where it is a file, nor without ``force`` where it holds one of the files
        ``earlier``, which are ``what``, or, if it is to be ``empty``, anything; nor, at all, where
        one of these is another file of the command, no regular file, or a record that a run is
        writing.
        """
        from physim.record.lock import check_unwritten

        path, option = self.path, self.option
        if os.path.lexists(path) and not path.is_dir():
            raise PhysimError(f"{path}: is a file; {option} takes a folder")
        with writing(path):
            found = [one for one in earlier if os.path.lexists(one)]
            held = any(path.iterdir()) if empty and path.exists() else bool(found)
        for one in found:
            if not (empty and one.is_dir()):
                Target(one, True, self.others, option).file()
                check_unwritten(one)
        if held and not self.force:
            holds = "is not empty" if empty else f"holds {what} ({found[0].name})"
            raise PhysimError(
                f"{path}: {holds}; use --force to overwrite it, or {option} for another folder"
            )
        return path


def remove(files: Sequence[Path]) -> None:
    """Remove files of an earlier command; another one may have removed them just now."""
    for file in files:
        with writing(file.parent):
            file.unlink(missing_ok=True)


@contextmanager
def run_folder(folder: Path, force: bool, *inputs: Path) -> Iterator[Path]:
    """Make the folder of a run; no other run may take it before all files of this one are written.

    Raises PhysimError as `Target.folder`. With ``force`` the earlier run's own files are removed,
    others are left alone.
    """
    from physim.record.lock import check_unwritten

    summary = folder / SUMMARY
    check_unwritten(summary)
    earlier = [folder / name for name in FILES]
    Target(folder, force, inputs).folder(earlier, "an earlier run")
    remove(earlier)
    with alone(summary):
        yield folder


@contextmanager
def alone(file: Path) -> Iterator[None]:
    """Make the folder of a file, and keep others from it while a block runs.

    Raises RecordError where another command is writing there.
    """
    from physim.record.lock import WriteLock

    with writing(file.parent):
        file.parent.mkdir(parents=True, exist_ok=True)
        lock = WriteLock(file)
    with closing(lock):
        yield


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """What is written to a path; an OSError becomes a PhysimError that names it."""
    try:
        yield
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written ({error.strerror})") from None


def inputs(*given: str | Path | None) -> tuple[Path, ...]:
    """Files of worlds and records as the command line names them, shipped worlds by name."""
    from physim.world.file.files import find_world

    files = []
    for one in given:
        if one is not None:
            try:
                files.append(find_world(one))
            except WorldError:
                continue  # reading it says what is wrong
    return tuple(files)


def check_json(path: Path | None, force: bool, others: Sequence[Path] = ()) -> None:
    """Raise PhysimError unless ``--json`` may be written to a file; ``-`` is standard output."""
    if path is not None and path != STDOUT:
        Target(path, force, others, "--json").file()


@contextmanager
def json_alone(json: Path | bool | None) -> Iterator[TextIO]:
    """Standard output, for JSON alone where ``--json`` asks for it there.

    All else that is printed then, by the user's code too, goes to standard error.
    """
    stdout = sys.stdout
    with redirect_stdout(sys.stderr if json in (True, STDOUT) else stdout):
        yield stdout


def write_json(path: Path | None, text: str, out: TextIO) -> None:
    """Write what ``--json`` asks for, if anything. Raises PhysimError when it cannot be written."""
    if path == STDOUT:
        out.write(text if text.endswith("\n") else text + "\n")
    elif path is not None:
        write_text(path, text)
