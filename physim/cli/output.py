"""Where a command writes, decided and checked before anything is computed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from types import SimpleNamespace
from typing import TextIO

from physim.drafts import check_regular, discard, draft_of
from physim.errors import PhysimError, WorldError

CUT_SHORT = ".cut_short"
"""Between name and ending of a video that was interrupted."""
STDOUT = Path("-")
"""What stands for standard output where a file is asked for."""
SUMMARY = "summary.json"
FILES = ("record.h5", "video.mp4", f"video{CUT_SHORT}.mp4", SUMMARY, "page.html")


def output_folder(folder: Path, force: bool, *inputs: Path) -> Path:
    """Make the output folder and return it.

    Raises PhysimError when it holds an earlier run and ``force`` is not set, when it is a file,
    when it cannot be written, or when one of ``inputs`` would be overwritten. With ``force`` the
    earlier run's own files are removed, others are left alone.
    """
    earlier = [folder / name for name in FILES if os.path.lexists(folder / name)]
    remove_earlier(folder, earlier, force, *inputs, what="an earlier run")
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(13, "Permission denied")
    return folder


@contextmanager
def run_folder(folder: Path, force: bool, *inputs: Path) -> Iterator[Path]:
    """`output_folder`, which no other run may take before all files of this one are written."""
    from physim.record.lock import WriteLock, check_unwritten

    summary = folder / SUMMARY
    check_unwritten(summary)
    output_folder(folder, force, *inputs)
    with writing(folder):
        lock = WriteLock(summary)
    try:
        yield folder
    finally:
        lock.release()


def remove_earlier(
    folder: Path,
    earlier: Sequence[Path],
    force: bool,
    *inputs: Path,
    what: str,
    later: bool = False,
) -> None:
    """Remove from a folder the files of an earlier command, or nothing.

    ``later`` leaves that to the caller, who knows then that there is something to put in their
    place. Raises PhysimError where there are any and ``force`` is not set, where one is no regular
    file, one of ``inputs`` or a record that a run is writing, and where it is no folder.
    """
    from physim.record.lock import check_unwritten

    a_folder(folder)
    for file in earlier:
        new_file(file, True, *inputs)
        check_unwritten(file)
    if earlier and not force:
        raise PhysimError(
            f"{folder}: holds {what} ({earlier[0].name}); "
            "use --force to overwrite it, or -o for another folder"
        )
    with writing(folder):
        for file in () if later else earlier:
            file.unlink(missing_ok=True)  # another command may have removed it just now


def empty_folder(folder: Path, force: bool, *files: Path, option: str = "-o") -> None:
    """Raise PhysimError unless ``files`` may be written in a folder: an empty one, or by force."""
    a_folder(folder, option)
    for file in files:
        check_regular(file)
    with writing(folder):
        if not force and folder.exists() and any(folder.iterdir()):
            raise PhysimError(
                f"{folder}: is not empty; use --force to overwrite it, "
                f"or {option} for another folder"
            )


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """What is written to a path; an OSError becomes a PhysimError that names it."""
    try:
        yield
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written ({error.strerror})") from None


def a_folder(path: Path, option: str = "-o") -> None:
    """Raise PhysimError where something exists that is no folder."""
    if path.exists() and not path.is_dir():
        raise PhysimError(f"{path}: is a file; {option} takes a folder")
    if path.is_symlink() and not path.exists():
        raise PhysimError(f"{path}: is a link to what is not there; {option} takes a folder")


def new_file(
    path: Path, force: bool, *inputs: Path, option: str = "-o", another: str = "file"
) -> None:
    """Raise PhysimError unless a file may be written.

    It may not where one of ``inputs`` is, nor where something other than a regular file is, nor
    without ``force`` where anything exists. ``option`` names the file, or another ``another``.
    """
    if path.is_dir():
        raise PhysimError(f"{path}: is a folder; {option} takes a file")
    for source in inputs:
        if _same(source, path):
            raise PhysimError(f"{path}: is the input; {option} takes another {another}")
    check_regular(path)
    if os.path.lexists(path) and not force:
        raise PhysimError(
            f"{path}: exists; use --force to overwrite it, or {option} for another {another}"
        )


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


def its_folder(path: Path) -> None:
    """Raise PhysimError where the folder of a file does not exist."""
    if not path.absolute().parent.is_dir():
        raise PhysimError(f"{path}: there is no folder {path.parent}")


def new_json(path: Path | None, force: bool, *inputs: Path) -> None:
    """Raise PhysimError unless ``--json`` may be written to a file; ``-`` is standard output."""
    if path is not None and path != STDOUT:
        new_file(path, force, *inputs, option="--json")
        its_folder(path)


def world_name(path: Path) -> None:
    """Raise PhysimError for the name of a world file that no command would take for one."""
    if not path.is_dir() and path.suffix.lower() not in (".yaml", ".yml"):
        raise PhysimError(f"{path}: a world file ends in .yaml")


def new_page(path: Path, force: bool, *inputs: Path, option: str = "-o") -> None:
    """Raise PhysimError unless a page may be written to a file."""
    if path.suffix.lower() not in (".html", ".htm"):
        raise PhysimError(f"{path}: a page ends in .html")
    new_file(path, force, *inputs, option=option)
    its_folder(path)


def alone(path: Path | None, *others: Path | None, option: str = "--json") -> None:
    """Raise PhysimError where a file to be written is one of others that the command writes."""
    if path is None or path == STDOUT:
        return
    if any(other is not None and path.resolve() == other.resolve() for other in others):
        raise PhysimError(
            f"{path}: is what the command writes besides; {option} takes another file"
        )


def spare(path: Path | None, *folders: Path, option: str = "-o") -> None:
    """Raise PhysimError where a file to be written is a part of a campaign that is read."""
    from physim.campaigns.folder import is_part

    for folder in folders:
        if path is not None and is_part(path, folder):
            raise PhysimError(
                f"{path}: is a part of the campaign in {folder}; {option} takes another file"
            )


@contextmanager
def output_of(json: Path | bool | None) -> Iterator[TextIO]:
    """Standard output, for JSON alone where ``--json`` asks for it there.

    All else that is printed then, by the user's code too, goes to standard error.
    """
    stdout = sys.stdout
    with redirect_stdout(sys.stderr if json in (True, STDOUT) else stdout):
        yield stdout


def write_json(options: SimpleNamespace, text: str) -> None:
    """Write what ``--json`` asks for, if anything. Raises PhysimError when it cannot be written."""
    if options.json == STDOUT:
        options.stdout.write(text if text.endswith("\n") else text + "\n")
    elif options.json is not None:
        write_text(options.json, text)


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all. Raises PhysimError when it cannot be written."""
    part = draft_of(path)
    with writing(path):
        try:
            part.write_text(text, encoding="utf-8")
            part.replace(path)
        finally:  # of an error or Ctrl-C nothing is left
            discard(part)


def _same(one: Path, other: Path) -> bool:
    try:
        return os.path.samefile(one, other)
    except (OSError, ValueError):
        return False
